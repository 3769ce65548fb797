//! Shared by problems on a lattice of cells: the space, decoding, range minima, enumeration.

use satisfice::catalogue::Description;
use satisfice::{Axis, AxisKind, Error, SatisficingProblem, Space};
use satisfice::{Encoding, Neighbourhood};

/// Up to this many keys are ranked by comparing all pairs, without allocating.
const FEW_KEYS: usize = 64;

/// The lattice `[0, m_1) x ... x [0, m_D)`; a solution is the vector of its cell indices. Or the random keys of a
/// permutation of `0..D`: reals whose ranks are the solution.
#[derive(Debug, Clone)]
pub(crate) struct Lattice {
    space: Space<f64>,
    keys: bool,
    /// The number of changes of one variable before those of each variable, and the number of all. Empty with keys.
    changes_before: Vec<usize>,
}

impl Lattice {
    /// A lattice with these numbers of cells, all of them positive.
    pub(crate) fn new(cells: impl IntoIterator<Item = usize>) -> Result<Self, Error> {
        let mut changes_before = vec![0_usize];
        let axes = cells.into_iter().map(|m| {
            let before = changes_before[changes_before.len() - 1];
            changes_before.push(before.saturating_add(m.saturating_sub(1)));
            Axis::integer(0, m as i64 - 1)
        });
        Ok(Self {
            space: Space::new(axes)?,
            keys: false,
            changes_before,
        })
    }

    /// The random keys of the permutations of `0..n`: the solution at n reals in [0, 1] is the rank of each (Bean 1994,
    /// doi 10.1287/ijoc.6.2.154); equal keys rank by their place.
    pub(crate) fn permutations(n: usize) -> Result<Self, Error> {
        Ok(Self {
            space: Space::cube(n, 0.0, 1.0)?,
            keys: true,
            changes_before: Vec::new(),
        })
    }

    /// Whether solutions are permutations by random keys.
    pub(crate) fn has_keys(&self) -> bool {
        self.keys
    }

    pub(crate) fn space(&self) -> &Space<f64> {
        &self.space
    }

    /// Whether these are cells of this lattice, or ranks: solutions may come from outside, for example from a report.
    #[inline]
    pub(crate) fn holds(&self, cells: &[u32]) -> bool {
        let axes = self.space.axes();
        if cells.len() != axes.len() {
            return false;
        }
        if self.keys {
            return cells.iter().all(|&rank| (rank as usize) < axes.len());
        }
        (axes.iter().zip(cells)).all(|(axis, &cell)| f64::from(cell) <= axis.upper())
    }

    /// Cost: O(D), with keys O(D log D).
    #[inline]
    pub(crate) fn decode_into(&self, values: &[f64], cells: &mut Vec<u32>) {
        cells.clear();
        if self.keys {
            if values.len() > FEW_KEYS {
                let mut order: Vec<u32> = (0..values.len() as u32).collect();
                order.sort_unstable_by(|&i, &j| {
                    let [a, b] = [i, j].map(|place| values[place as usize] + 0.0); // -0.0 is 0.0
                    a.total_cmp(&b).then(i.cmp(&j))
                });
                cells.resize(values.len(), 0);
                for (rank, &place) in (0..).zip(&order) {
                    cells[place as usize] = rank;
                }
                return;
            }
            let rank = |(place, key): (usize, &f64)| {
                let before = values[..place].iter().filter(|other| *other <= key).count();
                let after = values[place + 1..].iter().filter(|other| *other < key).count();
                (before + after) as u32
            };
            cells.extend(values.iter().enumerate().map(rank));
        } else {
            cells.extend(values.iter().map(|&x| x as u32));
        }
    }

    pub(crate) fn encode(&self, cells: &[u32], values: &mut [f64]) -> bool {
        if !self.holds(cells) || values.len() != cells.len() {
            return false;
        }
        if self.keys {
            // Every rank is below D, see `holds`: D different ones are all of them.
            let mut seen = vec![false; cells.len()];
            if cells
                .iter()
                .any(|&rank| core::mem::replace(&mut seen[rank as usize], true))
            {
                return false;
            }
        }
        for (value, &cell) in values.iter_mut().zip(cells) {
            *value = if self.keys {
                (f64::from(cell) + 0.5) / cells.len() as f64
            } else {
                f64::from(cell)
            };
        }
        true
    }

    /// The place of exchange `index` of a permutation: `(i, j)` with i < j, in the order (0, 1), (0, 2), (1, 2), (0, 3) …
    fn exchange(index: usize) -> (usize, usize) {
        // The greatest j with j (j - 1) / 2 <= index; the root may be off by one.
        let mut j = f64::midpoint(1.0, (1.0 + 8.0 * index as f64).sqrt()) as usize;
        while j * (j - 1) / 2 > index {
            j -= 1;
        }
        while (j + 1) * j / 2 <= index {
            j += 1;
        }
        (index - j * (j - 1) / 2, j)
    }
}

impl Encoding<f64, Vec<u32>> for Lattice {
    fn encode(&self, cells: &Vec<u32>, values: &mut [f64]) -> bool {
        Self::encode(self, cells, values)
    }
}

/// Solutions that differ in one variable; for permutations, by one exchange.
impl Neighbourhood<Vec<u32>> for Lattice {
    fn count(&self, _: &Vec<u32>) -> usize {
        let n = self.space.dimension();
        if self.keys {
            n * n.saturating_sub(1) / 2
        } else {
            self.changes_before.last().copied().unwrap_or(0)
        }
    }

    fn neighbour(&self, of: &Vec<u32>, index: usize) -> Option<Vec<u32>> {
        let mut changed = Vec::with_capacity(of.len());
        self.neighbour_into(of, index, &mut changed).then_some(changed)
    }

    fn neighbour_into(&self, of: &Vec<u32>, index: usize, changed: &mut Vec<u32>) -> bool {
        if index >= self.count(of) || of.len() != self.space.dimension() {
            return false;
        }
        changed.clone_from(of);
        if self.keys {
            let (i, j) = Self::exchange(index);
            changed.swap(i, j);
        } else {
            let j = self.changes_before.partition_point(|&before| before <= index) - 1;
            let there = (index - self.changes_before[j]) as u32;
            changed[j] = there + u32::from(there >= of[j]);
        }
        true
    }
}

/// The methods of `SatisficingProblem` that are the same on every lattice, for a type with the fields `lattice`, `threshold`
/// and `description`.
macro_rules! lattice_methods {
    () => {
        type Scalar = f64;
        type Solution = Vec<u32>;

        fn space(&self) -> &satisfice::Space<f64> {
            self.lattice.space()
        }
        fn decode(&self, values: &[f64]) -> Vec<u32> {
            let mut cells = Vec::with_capacity(values.len());
            self.lattice.decode_into(values, &mut cells);
            cells
        }
        #[inline]
        fn decode_into(&self, values: &[f64], cells: &mut Vec<u32>) {
            self.lattice.decode_into(values, cells);
        }
        fn threshold(&self) -> f64 {
            self.threshold
        }
        fn encoding(&self) -> Option<&dyn satisfice::Encoding<f64, Vec<u32>>> {
            Some(&self.lattice)
        }
        fn description(&self) -> satisfice::catalogue::Description {
            self.description.clone()
        }
    };
}
pub(crate) use lattice_methods;

/// Name and resolved parameters.
pub(crate) fn description<const N: usize>(name: &str, parameters: [(&str, String); N]) -> Description {
    Description {
        name: name.to_owned(),
        parameters: parameters
            .into_iter()
            .map(|(key, value)| (key.to_owned(), value))
            .collect(),
    }
}

/// The centres of `m` equal cells of `[lower, upper]`.
pub(crate) fn centres(m: usize, lower: f64, upper: f64) -> Vec<f64> {
    (0..m)
        .map(|k| lower + (upper - lower) * (k as f64 + 0.5) / m as f64)
        .collect()
}

/// Size, cells and threshold of a published row, and its number of hits.
pub(crate) type Published = (usize, usize, f64, u64);

/// `cells` and `threshold` for a size, where 0 cells and a threshold below 0 mean the published ones.
pub(crate) fn as_published(
    rows: &[Published],
    (name, size): (&str, usize),
    cells: usize,
    threshold: f64,
) -> Result<(usize, f64), Error> {
    let row = rows.iter().find(|row| row.0 == size);
    if row.is_none() && (cells == 0 || threshold < 0.0) {
        let sizes: Vec<String> = rows.iter().map(|row| row.0.to_string()).collect();
        return Err(Error::parameter(
            name,
            size,
            format!(
                "published for {} only: set `cells` and `threshold` for another",
                sizes.join(", ")
            ),
        ));
    }
    Ok((
        if cells == 0 {
            row.map_or(1, |row| row.1)
        } else {
            cells
        },
        if threshold < 0.0 {
            row.map_or(0.0, |row| row.2)
        } else {
            threshold
        },
    ))
}

/// The published number of hits of exactly this row, else an enumeration where the lattice is small enough.
pub(crate) fn reference<P: SatisficingProblem<Scalar = f64>>(
    rows: &[Published],
    problem: &P,
    size: usize,
    cells: usize,
) -> Option<u64> {
    rows.iter()
        .find(|row| row.0 == size && row.1 == cells && row.2 == problem.threshold())
        .map(|row| row.3)
        .or_else(|| count_hits(problem, ENUMERABLE))
}

/// Lattices of at most this many points are enumerated for their reference count, in a few seconds.
pub const ENUMERABLE: f64 = 2e7;

/// The number of lattice points with F < delta, by visiting every one; `None` if the space has a continuous axis, a permutation or
/// more than `limit` points. Cost: one decoding and one fitness per point.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::{ENUMERABLE, Queens, count_hits};
/// assert_eq!(count_hits(&Queens::new(6)?, ENUMERABLE), Some(4));
/// # Ok::<(), satisfice::Error>(())
/// ```
pub fn count_hits<P: SatisficingProblem<Scalar = f64>>(problem: &P, limit: f64) -> Option<u64> {
    let space = problem.space();
    let axes = space.axes();
    let is_place = |axis: &Axis<f64>| axis.kind() == AxisKind::Place;
    if space.cardinality().is_none_or(|points| points > limit) || axes.iter().any(is_place) {
        return None;
    }
    let mut values: Vec<f64> = axes.iter().map(Axis::lower).collect();
    let mut solution = problem.decode(&values);
    let mut hits = 0;
    loop {
        hits += u64::from(problem.fitness(&solution) < problem.threshold());
        let Some(turned) = values.iter().zip(axes).rposition(|(x, axis)| x < &axis.upper()) else {
            return Some(hits);
        };
        values[turned] += 1.0;
        for (x, axis) in values.iter_mut().zip(axes).skip(turned + 1) {
            *x = axis.lower();
        }
        problem.decode_into(&values, &mut solution);
    }
}

/// Minima over ranges of a fixed table in constant time: minima over windows of every power of two.
#[derive(Debug, Clone)]
pub(crate) struct RangeMinimum {
    /// `levels[k][i]` is the minimum of `table[i .. i + 2^k]`.
    levels: Vec<Vec<f64>>,
}

impl RangeMinimum {
    pub(crate) fn new(table: Vec<f64>) -> Self {
        let mut levels = vec![table];
        loop {
            let half = 1 << (levels.len() - 1);
            let last = &levels[levels.len() - 1];
            if last.len() <= half {
                return Self { levels };
            }
            let next = last.iter().zip(&last[half..]).map(|(a, b)| a.min(*b)).collect();
            levels.push(next);
        }
    }

    /// The table.
    #[inline]
    pub(crate) fn table(&self) -> &[f64] {
        &self.levels[0]
    }

    /// The minimum over the indices `from..=to`, clipped to the table; infinite if none is left.
    pub(crate) fn minimum(&self, from: f64, to: f64) -> f64 {
        let last = self.table().len() - 1;
        let (from, to) = (from.ceil().max(0.0), to.floor().min(last as f64));
        if from.is_nan() || to.is_nan() || from > to {
            return f64::INFINITY;
        }
        let (from, to) = (from as usize, to as usize);
        let level = (to - from + 1).ilog2() as usize;
        self.levels[level][from].min(self.levels[level][to + 1 - (1 << level)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_minima_are_those_of_a_scan() {
        let mut rng = satisfice::SearchRng::new(1);
        for length in [1, 2, 3, 7, 8, 9, 33] {
            let table: Vec<f64> = (0..length).map(|_| rng.uniform()).collect();
            let minima = RangeMinimum::new(table.clone());
            for from in 0..length {
                for to in from..length {
                    let scan = table[from..=to].iter().copied().fold(f64::INFINITY, f64::min);
                    assert_eq!(minima.minimum(from as f64, to as f64), scan);
                }
            }
            assert_eq!(minima.minimum(1.0, 0.0), f64::INFINITY);
        }
    }

    #[test]
    fn many_keys_have_the_ranks_that_counting_gives() {
        let mut rng = satisfice::SearchRng::new(2);
        let n = 3 * FEW_KEYS;
        let lattice = Lattice::permutations(n).unwrap();
        // Some keys are equal, and zero comes with both signs.
        let keys: Vec<f64> = (0..n)
            .map(|i| {
                if i % 7 == 0 {
                    -0.0
                } else {
                    rng.below(100) as f64 / 100.0
                }
            })
            .collect();
        let mut ranks = Vec::new();
        lattice.decode_into(&keys, &mut ranks);
        for (i, key) in keys.iter().enumerate() {
            let earlier = |(j, other): &(usize, &f64)| *other < key || *other == key && *j < i;
            assert_eq!(ranks[i] as usize, keys.iter().enumerate().filter(earlier).count());
        }
    }

    #[test]
    fn keys_and_permutations() {
        let lattice = Lattice::permutations(4).unwrap();
        let mut ranks = Vec::new();
        lattice.decode_into(&[0.5, 0.1, 0.5, 0.2], &mut ranks);
        assert_eq!(ranks, [2, 0, 3, 1]);
        let (mut keys, mut back) = ([0.0; 4], Vec::new());
        assert!(lattice.encode(&ranks, &mut keys));
        lattice.decode_into(&keys, &mut back);
        assert_eq!(back, ranks);
        assert!(!lattice.encode(&[0, 0, 1, 2], &mut keys) && !lattice.encode(&[4, 0, 1, 2], &mut keys));
        let mut exchanged: Vec<_> = (0..lattice.count(&ranks))
            .map(|index| lattice.neighbour(&ranks, index).unwrap())
            .collect();
        assert_eq!(exchanged[..2], [vec![0, 2, 3, 1], vec![3, 0, 2, 1]]);
        exchanged.sort_unstable();
        exchanged.dedup();
        assert_eq!((exchanged.len(), lattice.neighbour(&ranks, 6)), (6, None));
        assert_eq!(Lattice::exchange(usize::MAX >> 20).1, 5_931_642);
    }

    #[test]
    fn what_is_not_published_has_to_be_given() {
        let rows: &[Published] = &[(2, 10, 0.5, 7)];
        assert_eq!(as_published(rows, ("dimension", 2), 0, -1.0), Ok((10, 0.5)));
        assert_eq!(as_published(rows, ("dimension", 2), 4, 0.0), Ok((4, 0.0)));
        assert_eq!(as_published(rows, ("dimension", 3), 4, 0.1), Ok((4, 0.1)));
        let error = as_published(rows, ("dimension", 3), 4, -1.0).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("dimension = 3 is not allowed: published for 2 only")
        );
    }
}
