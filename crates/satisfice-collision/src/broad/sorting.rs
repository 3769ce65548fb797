//! What several tasks found, put into one order: dealt out to buckets that stay in the cache, each of which is sorted digit by
//! digit. Every buffer that is written to costs more than the passes do, so that there is one beside the result.

use super::pair::Pair;

/// So few are sorted by comparing.
const FEW: usize = 400;
/// Pairs of a bucket: with its copy it fills the first-level cache, or the second-level one where one bucket does.
const BUCKET: usize = 1 << 11;
const ONE_BUCKET: usize = 1 << 16;
/// Leading bits by which pairs are dealt out to buckets, at most: so many places are written to in turn.
const DEALT_BITS: u32 = 11;
/// Bits of a digit, at most: the counts of all digits stay in the first-level cache.
const DIGIT_BITS: u32 = 11;
/// Digits of a short key, at most.
const DIGITS: u32 = u32::BITS.div_ceil(DIGIT_BITS);

/// Sorts pairs. Keeps its memory from call to call.
#[derive(Debug, Default)]
pub(crate) struct Sorter {
    /// One for each task, if several threads deal.
    dealt: Vec<Dealt>,
    /// Where each bucket ends.
    ends: Vec<usize>,
    scratch: SortScratch,
}

/// What sorting a bucket needs room for: pairs, or short keys twice.
#[derive(Debug, Default)]
struct SortScratch {
    pairs: Vec<Pair>,
    keys: [Vec<u32>; 2],
}

/// The pairs of one task, those of a bucket side by side.
#[derive(Debug, Default)]
struct Dealt {
    pairs: Vec<Pair>,
    ends: Vec<usize>,
}

impl Sorter {
    /// Writes the pairs in order. Which task found which does not matter.
    pub(crate) fn sort<'p>(
        &mut self,
        found: impl Iterator<Item = &'p [Pair]> + Clone,
        out: &mut Vec<Pair>,
        threads: usize,
    ) {
        let n = found.clone().map(<[Pair]>::len).sum::<usize>();
        out.clear();
        // a look-up of point after point finds them in order
        let is_sorted = found.clone().flatten().is_sorted();
        if is_sorted || n <= ONE_BUCKET {
            for pairs in found {
                out.extend_from_slice(pairs);
            }
            if !is_sorted {
                sort(out, &mut self.scratch);
            }
            return;
        }
        let keys = Keys::of(found.clone()).dealt(n);
        out.resize(n, Pair { a: 0, b: 0 });
        if threads < 2 {
            deal(found, keys, &mut self.ends, out);
            for bucket in buckets(&self.ends, out) {
                sort(bucket, &mut self.scratch);
            }
            return;
        }
        use rayon::prelude::*;
        let found: Vec<_> = found.collect();
        self.dealt
            .resize_with(found.len().max(self.dealt.len()), Dealt::default);
        let dealt = &mut self.dealt[..found.len()];
        dealt.par_iter_mut().zip(found).for_each(|(dealt, found)| {
            dealt.pairs.resize(found.len(), Pair { a: 0, b: 0 });
            deal(std::iter::once(found), keys, &mut dealt.ends, &mut dealt.pairs);
        });
        self.ends.clear();
        self.ends
            .extend((0..keys.buckets()).map(|at| dealt.iter().map(|dealt| dealt.ends[at]).sum::<usize>()));
        let buckets: Vec<_> = buckets(&self.ends, out).collect();
        buckets.into_par_iter().enumerate().with_min_len(8).for_each_init(
            SortScratch::default,
            |scratch, (at, bucket)| {
                let mut rest = &mut *bucket;
                for dealt in &*dealt {
                    let from = &dealt.pairs[at.checked_sub(1).map_or(0, |at| dealt.ends[at])..dealt.ends[at]];
                    if let Some(to) = rest.split_off_mut(..from.len()) {
                        to.copy_from_slice(from);
                    }
                }
                sort(bucket, scratch);
            },
        );
    }
}

/// The buckets, empty ones too.
fn buckets<'a>(ends: &'a [usize], mut out: &'a mut [Pair]) -> impl Iterator<Item = &'a mut [Pair]> {
    let mut start = 0;
    ends.iter().map(move |&end| {
        let len = end - std::mem::replace(&mut start, end);
        out.split_off_mut(..len).unwrap_or_default()
    })
}

/// Pairs as numbers without wasted bits, counted from the least `a`.
#[derive(Debug, Clone, Copy)]
struct Keys {
    least: u32,
    /// Bits of the greatest `b`, and of the greatest key.
    width_b: u32,
    width: u32,
    greatest: u64,
    /// How far a key is shifted to number its bucket.
    shift: u32,
}

impl Keys {
    fn of<'p>(segments: impl Iterator<Item = &'p [Pair]>) -> Self {
        let (mut least, mut greatest, mut greatest_b) = (u32::MAX, 0, 0);
        for pairs in segments {
            for pair in pairs {
                least = least.min(pair.a);
                greatest = greatest.max(pair.a);
                greatest_b = greatest_b.max(pair.b);
            }
        }
        let width_b = u32::BITS - greatest_b.leading_zeros();
        let span = greatest.saturating_sub(least);
        let width = u32::BITS - span.leading_zeros() + width_b;
        let greatest = u64::from(span) << width_b | u64::from(greatest_b);
        Self {
            least,
            width_b,
            width,
            greatest,
            shift: width.min(u64::BITS - 1),
        }
    }

    /// For dealing out `n` pairs.
    fn dealt(self, n: usize) -> Self {
        let bits = (n / BUCKET).checked_ilog2().unwrap_or(0).min(DEALT_BITS);
        Self {
            shift: self.width.saturating_sub(bits),
            ..self
        }
    }

    fn buckets(self) -> usize {
        (self.greatest >> self.shift) as usize + 1
    }

    #[inline(always)]
    fn key(self, pair: Pair) -> u64 {
        u64::from(pair.a - self.least) << self.width_b | u64::from(pair.b)
    }

    /// The pair of a key that fits into 32 bits.
    #[inline(always)]
    fn pair(self, key: u32) -> Pair {
        let key = u64::from(key);
        Pair {
            a: self.least + (key >> self.width_b) as u32,
            b: (key & ((1 << self.width_b) - 1)) as u32,
        }
    }

    #[inline(always)]
    fn bucket(self, pair: Pair) -> usize {
        (self.key(pair) >> self.shift) as usize
    }
}

/// Writes the pairs bucket by bucket and where each of them ends.
fn deal<'p>(
    segments: impl Iterator<Item = &'p [Pair]> + Clone,
    keys: Keys,
    ends: &mut Vec<usize>,
    out: &mut [Pair],
) {
    ends.clear();
    ends.resize(keys.buckets(), 0);
    for pairs in segments.clone() {
        for &pair in pairs {
            ends[keys.bucket(pair)] += 1;
        }
    }
    starts(ends);
    for pairs in segments {
        for &pair in pairs {
            let at = &mut ends[keys.bucket(pair)];
            out[*at] = pair;
            *at += 1;
        }
    }
}

/// Where each starts, of how many there are of each.
#[inline(always)]
fn starts(counts: &mut [usize]) {
    let mut sum = 0;
    for count in counts {
        sum += std::mem::replace(count, sum);
    }
}

/// Sorts pairs in place.
fn sort(pairs: &mut [Pair], scratch: &mut SortScratch) {
    let n = pairs.len();
    let keys = Keys::of(std::iter::once(&*pairs));
    if n < FEW {
        sort_few(pairs, keys, &mut scratch.keys[0]);
        return;
    }
    // a table much longer than the pairs costs more than another pass
    let digit = (n.ilog2() + 1).min(DIGIT_BITS);
    if keys.width <= u32::BITS && keys.width.div_ceil(digit) <= DIGITS && u32::try_from(n).is_ok() {
        sort_short(pairs, keys, digit, &mut scratch.keys);
    } else {
        sort_long(pairs, keys, digit, &mut scratch.pairs);
    }
}

/// Sorts pairs by comparing, short keys if they have such.
fn sort_few(pairs: &mut [Pair], keys: Keys, short: &mut Vec<u32>) {
    if keys.width > u32::BITS {
        pairs.sort_unstable_by_key(|pair| u64::from(pair.a) << 32 | u64::from(pair.b));
        return;
    }
    short.clear();
    short.extend(pairs.iter().map(|&pair| keys.key(pair) as u32));
    short.sort_unstable();
    for (pair, &key) in pairs.iter_mut().zip(&*short) {
        *pair = keys.pair(key);
    }
}

/// Sorts pairs whose keys have so few digits that those of all are counted at once.
fn sort_short(pairs: &mut [Pair], keys: Keys, digit: u32, [one, two]: &mut [Vec<u32>; 2]) {
    let n = pairs.len();
    let passes = keys.width.div_ceil(digit).max(1);
    let width = keys.width.div_ceil(passes);
    let mask = (1 << width) - 1;
    for room in [&mut *one, &mut *two] {
        if room.len() < n {
            room.resize(n, 0);
        }
    }
    let (mut from, mut to) = (&mut one[..n], &mut two[..n]);
    let mut tables = [[0_u32; 1 << DIGIT_BITS]; DIGITS as usize];
    for (key, &pair) in from.iter_mut().zip(&*pairs) {
        *key = keys.key(pair) as u32;
        for (pass, table) in (0..passes).zip(&mut tables) {
            table[(*key >> (pass * width)) as usize & mask] += 1;
        }
    }
    for (pass, table) in (0..passes).zip(&mut tables) {
        let mut sum = 0;
        for count in &mut table[..=mask] {
            sum += std::mem::replace(count, sum);
        }
        let digit = |key: u32| (key >> (pass * width)) as usize & mask;
        if pass + 1 == passes {
            for &key in &*from {
                let at = &mut table[digit(key)];
                pairs[*at as usize] = keys.pair(key);
                *at += 1;
            }
        } else {
            for &key in &*from {
                let at = &mut table[digit(key)];
                to[*at as usize] = key;
                *at += 1;
            }
        }
        std::mem::swap(&mut from, &mut to);
    }
}

/// Sorts pairs digit by digit.
fn sort_long(pairs: &mut [Pair], keys: Keys, digit: u32, scratch: &mut Vec<Pair>) {
    let n = pairs.len();
    let passes = keys.width.div_ceil(digit);
    let width = keys.width.div_ceil(passes);
    let mut table = [0; 1 << DIGIT_BITS];
    let table = &mut table[..1 << width];
    if scratch.len() < n {
        scratch.resize(n, Pair { a: 0, b: 0 });
    }
    let (mut from, mut to) = (&mut *pairs, &mut scratch[..n]);
    for pass in 0..passes {
        let digit = |pair: Pair| (keys.key(pair) >> (pass * width)) as usize & ((1 << width) - 1);
        table.fill(0);
        for &pair in &*from {
            table[digit(pair)] += 1;
        }
        starts(table);
        for &pair in &*from {
            let at = &mut table[digit(pair)];
            to[*at] = pair;
            *at += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    if passes % 2 == 1 {
        to.copy_from_slice(from);
    }
}

#[cfg(test)]
mod tests {
    use super::{ONE_BUCKET, Pair, Sorter};

    /// Numbers that look random, below a limit.
    fn numbers(limit: u32, mut state: u64) -> impl Iterator<Item = u32> {
        std::iter::repeat_with(move || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            ((state >> 32) % u64::from(limit)) as u32
        })
    }

    #[test]
    fn pairs_are_sorted_on_any_number_of_threads() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let mut sorter = Sorter::default();
        let mut out = Vec::new();
        for n in [0, 1, 2, 399, 400, 5000, ONE_BUCKET, ONE_BUCKET + 1, 200_000] {
            // all numbers, few of them, neighbours of each other, and one that is far from the others
            for limits in [
                [u32::MAX, u32::MAX],
                [3, 1_000_000],
                [1_000_000, 3],
                [1, 1],
                [70_000, 70_000],
                // keys of 32 and of 33 bits: the longest short ones and the shortest long ones
                [1 << 16, 1 << 16],
                [1 << 17, 1 << 16],
            ] {
                let (mut a, mut b) = (numbers(limits[0], 1), numbers(limits[1], 2));
                let mut pair = |at: usize| Pair {
                    a: a.next().unwrap() / if limits[0] == 70_000 && at > 0 { 4096 } else { 1 },
                    b: b.next().unwrap(),
                };
                let found: Vec<Pair> = (0..n).map(&mut pair).collect();
                let mut sorted = found.clone();
                sorted.sort();
                for tasks in [1, 7] {
                    let parts = found.chunks(n.div_ceil(tasks).max(1));
                    for threads in [1, 3] {
                        pool.install(|| sorter.sort(parts.clone(), &mut out, threads));
                        assert!(
                            out == sorted,
                            "{n} below {limits:?}, {tasks} tasks, {threads} threads"
                        );
                    }
                }
            }
        }
    }
}
