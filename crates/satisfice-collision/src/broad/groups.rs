//! The pairs of two bodies in order, without sorting them: all of one point are found together, so that it is enough to know
//! where they start.

use std::sync::atomic::{AtomicU64, Ordering};

use super::clip::Part;
use super::pair::Pair;

/// Bits for a place in a task's pairs, for how many pairs start there, and, above them, for the number of the task.
const PLACE_BITS: u32 = 40;
const COUNT_BITS: u32 = 12;
/// A count of this may be of more.
const MANY: u64 = (1 << COUNT_BITS) - 1;
/// Tasks at most.
pub(crate) const TASKS: usize = 1 << (u64::BITS - PLACE_BITS - COUNT_BITS);
/// Points from which threads share the work.
const SHARED: usize = 1 << 14;

/// Where the pairs of each point of the first body start. Points are known by their rank among those that were kept.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    /// The serial number of each rank.
    ids: Vec<u32>,
    /// Place, count and task of the pairs; 0 for none. Atomic, because tasks write to it in any order, but each of them of
    /// points of its own.
    starts: Vec<AtomicU64>,
    chunks: Vec<Vec<Pair>>,
}

impl Groups {
    /// Gives every point its rank for a number.
    pub(crate) fn rank(&mut self, parts: &mut [Part]) {
        self.ids.clear();
        for point in parts.iter_mut().flat_map(|part| &mut part.points) {
            let rank = self.ids.len() as u32;
            self.ids.push(std::mem::replace(&mut point.id, rank));
        }
        self.starts.clear();
        self.starts.resize_with(self.ids.len(), AtomicU64::default);
    }

    /// The serial number of a rank.
    pub(crate) fn id(&self, rank: u32) -> u32 {
        self.ids[rank as usize]
    }

    /// The pairs of this rank are those of a task from `place` on.
    #[inline(always)]
    pub(crate) fn found(&self, rank: u32, task: usize, place: usize, count: usize) {
        let group = ((task as u64) << COUNT_BITS | MANY.min(count as u64)) << PLACE_BITS | place as u64;
        // whoever reads it has joined the threads
        self.starts[rank as usize].store(group, Ordering::Relaxed);
    }

    /// Writes the pairs that so many tasks found, a rank and a serial number, in order.
    pub(crate) fn gather<'p>(
        &mut self,
        tasks: usize,
        found: impl Fn(usize) -> &'p [Pair] + Sync,
        out: &mut Vec<Pair>,
        threads: usize,
    ) {
        out.clear();
        out.reserve((0..tasks).map(|task| found(task).len()).sum());
        let Self { ids, starts, chunks } = self;
        let gather = |ids: &[u32], starts: &[AtomicU64], out: &mut Vec<Pair>| {
            for (&a, start) in ids.iter().zip(starts) {
                let group = start.load(Ordering::Relaxed);
                let count = group >> PLACE_BITS & MANY;
                if count > 0 {
                    let task = found((group >> (PLACE_BITS + COUNT_BITS)) as usize);
                    let place = (group & ((1 << PLACE_BITS) - 1)) as usize;
                    append(&task[place..], count, a, out);
                }
            }
        };
        if threads < 2 || ids.len() < SHARED {
            gather(ids, starts, out);
            return;
        }
        use rayon::prelude::*;
        let count = threads * 8;
        chunks.resize_with(count, Vec::new);
        let ranks = ids.len().div_ceil(count);
        chunks
            .par_iter_mut()
            .zip(ids.par_chunks(ranks).zip(starts.par_chunks(ranks)))
            .for_each(|(chunk, (ids, starts))| {
                chunk.clear();
                gather(ids, starts, chunk);
            });
        // chunks beyond the last rank are left over from before
        for chunk in &chunks[..ids.len().div_ceil(ranks)] {
            out.extend_from_slice(chunk);
        }
    }
}

/// Appends the first `count` pairs, in order, with a serial number.
#[inline(always)]
fn append(found: &[Pair], count: u64, a: u32, out: &mut Vec<Pair>) {
    let pair = |b| Pair { a, b };
    match (count, found) {
        (1, [x, ..]) => out.push(pair(x.b)),
        (2, [x, y, ..]) => out.extend([pair(x.b.min(y.b)), pair(x.b.max(y.b))]),
        (3, [x, y, z, ..]) => {
            let (low, high) = (x.b.min(y.b), x.b.max(y.b));
            let middle = high.min(z.b);
            out.extend([pair(low.min(middle)), pair(low.max(middle)), pair(high.max(z.b))]);
        }
        _ => {
            let start = out.len();
            let known = count as usize;
            out.extend(found[..known].iter().map(|found| pair(found.b)));
            if count == MANY {
                let rest = found.iter().take_while(|pair| pair.a == found[0].a).skip(known);
                out.extend(rest.map(|found| pair(found.b)));
            }
            out[start..].sort_unstable_by_key(|pair| pair.b);
        }
    }
}
