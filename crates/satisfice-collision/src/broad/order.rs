//! Pairs packed into one number each, and their order: by a, then by b.

/// A pair of serial numbers. Ordered by `a`, then by `b`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pair {
    /// Number in the first body; in the only body the lower number.
    pub a: u32,
    /// Number in the second body; in the only body the higher number.
    pub b: u32,
}

/// Keys up to which a pass may write anywhere: half a megabyte.
const IN_CACHE: usize = 1 << 16;

/// How pairs are packed: a above b, no bit wasted, so that sorting needs few passes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Packing {
    shift: u32,
    bits: u32,
}

impl Packing {
    /// For numbers below `a` and `b`.
    pub(crate) fn new(a: usize, b: usize) -> Self {
        let width = |n: usize| usize::BITS - n.saturating_sub(1).leading_zeros();
        Self {
            shift: width(b),
            bits: width(a) + width(b),
        }
    }

    #[inline(always)]
    pub(crate) fn pack(self, a: u32, b: u32) -> u64 {
        u64::from(a) << self.shift | u64::from(b)
    }

    #[inline(always)]
    pub(crate) fn unpack(self, key: u64) -> Pair {
        Pair {
            a: (key >> self.shift) as u32,
            b: (key & ((1 << self.shift) - 1)) as u32,
        }
    }

    /// Sorts what the tasks found and unpacks it into `out`.
    pub(crate) fn sort<'k>(
        self,
        found: impl Iterator<Item = &'k [u64]> + Clone,
        scratch: &mut [Vec<u64>; 2],
        out: &mut Vec<Pair>,
        threads: usize,
    ) {
        out.clear();
        let n = found.clone().map(<[u64]>::len).sum::<usize>();
        let [front, back] = scratch;
        front.resize(n, 0);
        if n <= IN_CACHE {
            let mut at = 0;
            for keys in found {
                front[at..at + keys.len()].copy_from_slice(keys);
                at += keys.len();
            }
            // the tables of the passes cost more than sorting so few
            if front.is_sorted() {
                // as a look-up of point after point finds them
            } else if n < 512 {
                front.sort_unstable();
            } else {
                back.resize(n, 0);
                radix::<13, { 1 << 13 }>(front, back, self.bits);
            }
            out.extend(front.iter().map(|&key| self.unpack(key)));
            return;
        }
        // one pass by the leading bits makes buckets that fit into the first-level cache and can be sorted apart
        let wanted = usize::BITS - (n / 1024).leading_zeros();
        let top = self.bits.min(wanted.clamp(1, 11));
        let low = self.bits - top;
        let mut ends = [0_usize; 2049];
        for keys in found.clone() {
            for &key in keys {
                ends[(key >> low) as usize + 1] += 1;
            }
        }
        for bucket in 0..2048 {
            ends[bucket + 1] += ends[bucket];
        }
        let mut at = ends;
        for keys in found {
            for &key in keys {
                let place = &mut at[(key >> low) as usize];
                front[*place] = key;
                *place += 1;
            }
        }
        back.resize(n, 0);
        out.resize(n, Pair { a: 0, b: 0 });
        let sort = |front: &mut [u64], back: &mut [u64], out: &mut [Pair]| {
            radix::<8, { 1 << 8 }>(front, back, low);
            for (pair, &key) in out.iter_mut().zip(front.iter()) {
                *pair = self.unpack(key);
            }
        };
        let (mut front, mut back, mut out) = (&mut front[..], &mut back[..], &mut out[..]);
        let buckets = ends
            .windows(2)
            .map(|w| w[1] - w[0])
            .filter(|&len| len > 0)
            .map(|len| {
                (
                    front.split_off_mut(..len).unwrap_or_default(),
                    back.split_off_mut(..len).unwrap_or_default(),
                    out.split_off_mut(..len).unwrap_or_default(),
                )
            });
        if threads < 2 || n < 1 << 16 {
            buckets.for_each(|(front, back, out)| sort(front, back, out));
        } else {
            use rayon::prelude::*;
            let mut buckets: Vec<_> = buckets.collect();
            buckets
                .par_iter_mut()
                .with_min_len(32)
                .for_each(|(front, back, out)| sort(front, back, out));
        }
    }
}

/// Sorts `keys` by their lowest `bits` bits, up to `WIDTH` bits a pass; the bits above are all equal. `TABLE` is 2^`WIDTH`.
fn radix<const WIDTH: u32, const TABLE: usize>(keys: &mut [u64], back: &mut [u64], bits: u32) {
    if keys.len() < 96 {
        keys.sort_unstable();
        return;
    }
    // a table much longer than the keys costs more than another pass
    let wanted = (usize::BITS - keys.len().leading_zeros()).min(WIDTH);
    let passes = bits.div_ceil(wanted).max(1);
    let width = bits.div_ceil(passes).max(1);
    let (mut from, mut to) = (keys, back);
    let mut table = [0_usize; TABLE];
    for pass in 0..passes {
        let digit = |key: u64| (key >> (pass * width)) as usize & ((1 << width) - 1);
        let at = &mut table[..1 << width];
        at.fill(0);
        for &key in from.iter() {
            at[digit(key)] += 1;
        }
        let mut sum = 0;
        for place in at.iter_mut() {
            sum += std::mem::replace(place, sum);
        }
        for &key in from.iter() {
            let place = &mut at[digit(key)];
            to[*place] = key;
            *place += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    if passes % 2 == 1 {
        to.copy_from_slice(from);
    }
}
