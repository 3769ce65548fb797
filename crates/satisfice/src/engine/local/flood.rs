//! Exhaustion: from every hit its neighbours, breadth first.

use core::cmp::Reverse;
use core::hash::BuildHasher;
use core::ops::Range;
use std::collections::BinaryHeap;

use foldhash::fast::FixedState;
use hashbrown::HashTable;

use crate::batch::{Batch, Outcome};
use crate::context::{Context, points_at_once};
use crate::error::Error;
use crate::scalar::{Real, ordered};
use crate::space::Space;
use crate::state::{Part, Reader, Saved, State, read_rows, write_rows};

/// Of positions; fixed, so that a run is the same on every machine.
const KEYS: FixedState = FixedState::with_seed(0xf100_d000_0000_0001);

/// Doublings of the first step in the search for the nearest point that is not deleted.
const DOUBLINGS: u32 = 8;
/// Halvings afterwards: the step found is at most an eighth too long.
const HALVINGS: usize = 3;

/// Rows that are kept until twice as many have gone.
const KEPT: usize = 1024;

/// Which hit is next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Order {
    /// The earliest: breadth first.
    First,
    /// The one of least F, which is deepest within its region: most of its neighbours are hits.
    Best,
}

/// The hits whose neighbours are still to be proposed.
///
/// Neighbours are the problem's own, or else the next lattice points; on continuous axes, in both directions of each axis, the
/// nearest point that is not deleted, found by looking into C and thus without an evaluation. No point is proposed twice
/// in one flood.
#[derive(Debug)]
pub(in crate::engine) struct Flood<S> {
    first_step: S,
    order: Order,
    /// The hits that wait, the next one on top: the ordered bits of its fitness where the best are first, and its row of `positions`.
    queue: BinaryHeap<Reverse<(u64, usize)>>,
    /// Of the hits since the queue was empty, flat, with so many coordinates each.
    positions: Vec<S>,
    dimension: usize,
    /// Keys of the points proposed in this flood; two points under one key, 2^-64 likely, would cost one of them its turn.
    seen: HashTable<u64>,
    /// The hit whose neighbours are proposed, and the index of the next one; steps along axes follow the neighbours.
    centre: Vec<S>,
    next: usize,
    /// For each axis, after how many doublings of the first step the last point was found that was not deleted.
    doublings: Vec<u32>,
}

impl<S: Real> Flood<S> {
    /// `first_step`: where the search for the nearest undeleted point begins, as a share of each continuous axis.
    pub(in crate::engine) fn new(first_step: f64, order: Order) -> Self {
        Self {
            first_step: S::of(first_step),
            order,
            queue: BinaryHeap::new(),
            positions: Vec::new(),
            dimension: 0,
            seen: HashTable::new(),
            centre: Vec::new(),
            next: 0,
            doublings: Vec::new(),
        }
    }

    pub(in crate::engine) fn clear(&mut self) {
        self.queue.clear();
        self.positions.clear();
        self.seen.clear();
        self.centre.clear();
    }

    /// Puts new hits into the queue.
    pub(in crate::engine) fn add_hits(
        &mut self,
        space: &Space<S>,
        batch: &Batch<S>,
        outcomes: &[Outcome<S>],
    ) {
        for (position, outcome) in batch.points().zip(outcomes) {
            if let Outcome::Hit(fitness) = *outcome {
                let key = match self.order {
                    Order::First => 0,
                    Order::Best => ordered(fitness.f64()),
                };
                let start = self.positions.len();
                self.dimension = position.len();
                self.queue.push(Reverse((key, start / self.dimension.max(1))));
                self.positions.extend_from_slice(position);
                space.centre(&mut self.positions[start..]);
            }
        }
    }

    /// Frees the rows that no longer wait, once they are more than those that do.
    fn forget_old(&mut self, dimension: usize) {
        if self.positions.len() < 2 * dimension * (self.queue.len() + KEPT) {
            return;
        }
        let mut waiting: Vec<(u64, usize)> = self.queue.drain().map(|Reverse(entry)| entry).collect();
        waiting.sort_unstable_by_key(|&(_, row)| row);
        // Rows move to the front, in their order.
        for (to, (_, row)) in waiting.iter_mut().enumerate() {
            self.positions
                .copy_within(*row * dimension..(*row + 1) * dimension, to * dimension);
            *row = to;
        }
        self.positions.truncate(waiting.len() * dimension);
        self.queue = waiting.into_iter().map(Reverse).collect();
    }

    /// Proposes neighbours of the next hit that has any left, none once time is out; `false` when all is flooded.
    pub(in crate::engine) fn ask(&mut self, context: &dyn Context<S>, out: &mut Batch<S>) -> bool {
        while out.is_empty() {
            if !self.look_on(context, out) {
                return false;
            }
            if context.is_out_of_time() {
                break;
            }
        }
        true
    }

    /// Proposes those of the next few neighbours of one hit that are new, which may be none; `false` when all is flooded. Each look costs time
    /// even where it proposes nothing.
    pub(in crate::engine) fn look_on(&mut self, context: &dyn Context<S>, out: &mut Batch<S>) -> bool {
        let dimension = out.dimension();
        if self.centre.len() != dimension && !self.next_centre(dimension) {
            return false;
        }
        if context.is_out_of_time() {
            return true;
        }
        let seen = &mut self.seen;
        let mut propose = |position: &[S]| {
            if is_new(seen, position) {
                out.push(position);
            }
        };
        let count = context.neighbour_count(&self.centre);
        let end = (count + dimension).min(self.next.saturating_add(points_at_once(dimension)));
        let neighbours = self.next..end.min(count);
        if !neighbours.is_empty() {
            context.neighbours(&self.centre, neighbours, &mut |_, position| {
                if !context.is_deleted(position) {
                    propose(position);
                }
            });
        }
        let axes = self.next.max(count) - count..end.max(count) - count;
        self.doublings.resize(dimension, 0);
        let left = frontier(
            context,
            &mut self.centre,
            axes,
            self.first_step,
            &mut self.doublings,
            &mut propose,
        );
        self.next = end - left;
        if self.next == count + dimension {
            self.centre.clear();
        }
        true
    }

    /// Takes the next hit from the queue; `false` when there is none.
    fn next_centre(&mut self, dimension: usize) -> bool {
        self.centre.clear();
        self.next = 0;
        while let Some(Reverse((_, row))) = self.queue.pop() {
            let place = row.saturating_mul(dimension);
            // A restored row may be of another space.
            if let Some(position) = self.positions.get(place..place.saturating_add(dimension)) {
                self.centre.extend_from_slice(position);
                self.forget_old(dimension);
                return true;
            }
        }
        self.clear();
        false
    }
}

impl<S: Real> Part for Flood<S> {
    fn save(&self, state: &mut State) {
        let mut queue: Vec<(u64, usize)> = self.queue.iter().map(|&Reverse(entry)| entry).collect();
        queue.sort_unstable();
        Saved::save(&queue, state);
        write_rows(state, &self.positions, self.dimension);
        Saved::save(&self.dimension, state);
        Saved::save(&self.centre, state);
        Saved::save(&self.next, state);
        Saved::save(&self.doublings, state);
        let mut seen: Vec<u64> = self.seen.iter().copied().collect();
        seen.sort_unstable();
        Saved::save(&seen, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.queue = from
            .read::<Vec<(u64, usize)>>()?
            .into_iter()
            .map(Reverse)
            .collect();
        self.positions = read_rows(from)?;
        self.dimension = from.read()?;
        self.centre = from.read()?;
        self.next = from.read()?;
        self.doublings = from.read()?;
        self.seen.clear();
        for key in from.read::<Vec<u64>>()? {
            self.seen.insert_unique(key, key, |&key| key);
        }
        Ok(())
    }
}

/// Whether a point has not been seen; it has been then.
fn is_new<S: Real>(seen: &mut HashTable<u64>, position: &[S]) -> bool {
    let key = position.iter().fold(0_u64, |key, x| {
        KEYS.hash_one([key, (*x + S::zero()).to_word()]) // -0.0 and 0.0 are one place
    });
    match seen.entry(key, |&other| other == key, |&other| other) {
        hashbrown::hash_table::Entry::Occupied(_) => false,
        hashbrown::hash_table::Entry::Vacant(vacant) => {
            vacant.insert(key);
            true
        }
    }
}

/// Visits, in both directions of some continuous axes, the nearest point to `centre` that is not deleted. The search begins with the step
/// at which the last one of the axis ended: hits are about as far apart as they were there. Returns how many axes are left when time runs out.
fn frontier<S: Real>(
    context: &dyn Context<S>,
    centre: &mut [S],
    axes: Range<usize>,
    first_step: S,
    doublings: &mut [u32],
    visit: &mut dyn FnMut(&[S]),
) -> usize {
    let two = S::of(2.0);
    for j in axes.clone() {
        if context.is_out_of_time() {
            return axes.end - j;
        }
        let axis = &context.space().axes()[j];
        if axis.is_integer() || axis.width() == S::zero() {
            continue;
        }
        let here = centre[j];
        for first in [-first_step * axis.width(), first_step * axis.width()] {
            let step = |doublings: u32| first * S::of(f64::from(1_u32 << doublings));
            // `None` outside.
            let mut is_open = |step: S| {
                centre[j] = here + step;
                context
                    .space()
                    .contains(centre)
                    .then(|| !context.is_deleted(centre))
            };
            let mut last = doublings[j].min(DOUBLINGS);
            let mut found = is_open(step(last));
            while found.is_none() && last > 0 {
                last -= 1;
                found = is_open(step(last));
            }
            if found == Some(false) {
                while found == Some(false) && last < DOUBLINGS {
                    last += 1;
                    found = is_open(step(last));
                }
            } else {
                while found == Some(true) && last > 0 && is_open(step(last - 1)) == Some(true) {
                    last -= 1;
                }
            }
            if found != Some(true) {
                continue;
            }
            doublings[j] = last;
            let mut outer = step(last);
            let mut inner = if last > 0 { step(last - 1) } else { S::zero() };
            for _ in 0..HALVINGS {
                let middle = (inner + outer) / two;
                if is_open(middle) == Some(false) {
                    inner = middle;
                } else {
                    outer = middle;
                }
            }
            centre[j] = here + outer;
            visit(centre);
        }
        centre[j] = here;
    }
    0
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;

    use super::*;
    use crate::space::Region;
    use crate::testing::BareContext;

    /// Everything whose squared distance from the middle is less than a number is deleted, and time is out after some looks into C.
    struct Timed {
        bare: BareContext<f64>,
        looks: Cell<usize>,
        most: usize,
        squared: f64,
    }

    impl Context<f64> for Timed {
        fn space(&self) -> &Space<f64> {
            self.bare.space()
        }
        fn threshold(&self) -> f64 {
            self.bare.threshold()
        }
        fn elapsed_share(&self) -> f64 {
            0.0
        }
        fn evaluations(&self) -> u64 {
            0
        }
        fn hits(&self) -> usize {
            1
        }
        fn is_deleted(&self, position: &[f64]) -> bool {
            self.looks.set(self.looks.get() + 1);
            position.iter().map(|x| x * x).sum::<f64>() < self.squared
        }
        fn is_out_of_time(&self) -> bool {
            self.looks.get() >= self.most
        }
        fn neighbour_count(&self, of: &[f64]) -> usize {
            self.bare.neighbour_count(of)
        }
        fn neighbours(&self, _: &[f64], _: Range<usize>, _: &mut dyn FnMut(usize, &[f64])) {}
        fn offers_neighbours(&self) -> bool {
            false
        }
        fn lower_bound(&self, _: &Region<f64>) -> Option<f64> {
            None
        }
        fn previous_hits(&self) -> usize {
            0
        }
        fn previous_hit(&self, _: usize, _: &mut [f64]) -> bool {
            false
        }
    }

    #[test]
    fn the_steps_along_many_axes_end_with_the_time_and_go_on_from_there() {
        let axes = 1000;
        let proposals = |most: usize| {
            let context = Timed {
                bare: BareContext::new(Space::cube(axes, -1.0, 1.0).unwrap()),
                looks: Cell::new(0),
                most,
                squared: 0.01,
            };
            let (mut flood, mut batch) = (Flood::new(1e-3, Order::First), Batch::new(axes));
            batch.push(&vec![0.0; axes]);
            flood.add_hits(context.space(), &batch, &[Outcome::Hit(0.0)]);
            let (mut all, mut asks) = (Vec::new(), 0);
            loop {
                batch.clear();
                context.looks.set(0);
                asks += 1;
                if !flood.ask(&context, &mut batch) {
                    return (all, asks);
                }
                // One axis: fewer than thirty looks.
                assert!(
                    context.looks.get() < most.saturating_add(30),
                    "{}",
                    context.looks.get()
                );
                all.extend(batch.points().map(<[f64]>::to_vec));
            }
        };
        let (all, asks) = proposals(usize::MAX);
        assert_eq!(all.len(), 2 * axes);
        let (same, more) = proposals(100);
        assert!(all == same && more > 10 * asks, "{more} asks in place of {asks}");
    }

    /// Two hits without a neighbour that is new: each takes a look, and a whole flood goes over both.
    #[test]
    fn a_look_ends_with_its_hit_even_if_it_proposes_nothing() {
        let context = Timed {
            bare: BareContext::new(Space::cube(2, -1.0, 1.0).unwrap()),
            looks: Cell::new(0),
            most: usize::MAX,
            squared: f64::INFINITY,
        };
        let (mut hits, mut batch) = (Batch::new(2), Batch::new(2));
        hits.push(&[0.0, 0.0]);
        hits.push(&[0.5, 0.0]);
        let mut flood = Flood::new(1e-3, Order::First);
        let outcomes = [Outcome::Hit(0.0); 2];
        flood.add_hits(context.space(), &hits, &outcomes);
        assert_eq!(
            [(); 3].map(|()| flood.look_on(&context, &mut batch)),
            [true, true, false]
        );
        flood.add_hits(context.space(), &hits, &outcomes);
        assert!(!flood.ask(&context, &mut batch) && batch.is_empty());
    }
}
