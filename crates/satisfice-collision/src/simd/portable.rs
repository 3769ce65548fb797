//! The unit of every machine: plain arrays, which the compiler vectorises as far as the build target allows.

use super::{Eight, Floats, Lanes};

/// Plain arrays.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

/// Plain arrays of `N` numbers.
#[derive(Clone, Copy)]
pub(crate) struct Plain<T, const N: usize>(std::marker::PhantomData<T>);

macro_rules! floats {
    ($real:ty, $lanes:literal) => {
        impl Floats for Plain<$real, $lanes> {
            type Scalar = $real;
            type Array = [$real; $lanes];
            type Number = [$real; $lanes];
            type Mask = u32;

            #[inline(always)]
            fn load(self, x: &Self::Array) -> Self::Number {
                *x
            }
            #[inline(always)]
            fn store(self, x: Self::Number) -> Self::Array {
                x
            }
            #[inline(always)]
            fn splat(self, x: $real) -> Self::Number {
                [x; $lanes]
            }
            #[inline(always)]
            fn add(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] + y[k])
            }
            #[inline(always)]
            fn sub(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] - y[k])
            }
            #[inline(always)]
            fn mul(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] * y[k])
            }
            #[inline(always)]
            fn div(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| x[k] / y[k])
            }
            #[inline(always)]
            fn mul_add(self, x: Self::Number, y: Self::Number, z: Self::Number) -> Self::Number {
                // `f64::mul_add` is a library call on machines without the instruction.
                std::array::from_fn(|k| x[k] * y[k] + z[k])
            }
            #[inline(always)]
            fn min(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| if x[k] < y[k] { x[k] } else { y[k] })
            }
            #[inline(always)]
            fn max(self, x: Self::Number, y: Self::Number) -> Self::Number {
                std::array::from_fn(|k| if x[k] > y[k] { x[k] } else { y[k] })
            }
            #[inline(always)]
            fn abs(self, x: Self::Number) -> Self::Number {
                x.map(<$real>::abs)
            }
            #[inline(always)]
            fn if_equal(
                self,
                x: Self::Number,
                y: Self::Number,
                then: Self::Number,
                other: Self::Number,
            ) -> Self::Number {
                std::array::from_fn(|k| if x[k] == y[k] { then[k] } else { other[k] })
            }
            #[inline(always)]
            fn select(self, mask: u32, then: Self::Number, other: Self::Number) -> Self::Number {
                std::array::from_fn(|k| {
                    if mask >> k & 1 == 1 {
                        then[k]
                    } else {
                        other[k]
                    }
                })
            }
            #[inline(always)]
            fn less(self, x: Self::Number, y: Self::Number) -> u32 {
                (0..$lanes).fold(0, |bits, k| bits | u32::from(x[k] < y[k]) << k)
            }
            #[inline(always)]
            fn at_most(self, x: Self::Number, y: Self::Number) -> u32 {
                (0..$lanes).fold(0, |bits, k| bits | u32::from(x[k] <= y[k]) << k)
            }
            #[inline(always)]
            fn both(self, x: u32, y: u32) -> u32 {
                x & y
            }
            #[inline(always)]
            fn bits(self, mask: u32) -> u32 {
                mask
            }
        }
    };
}

floats!(f32, 8);
floats!(f64, 4);

impl Lanes for Portable {
    type Single = Plain<f32, 8>;
    type Double = Plain<f64, 4>;

    #[inline(always)]
    fn single(self) -> Self::Single {
        Plain(std::marker::PhantomData)
    }

    #[inline(always)]
    fn double(self) -> Self::Double {
        Plain(std::marker::PhantomData)
    }

    #[inline(always)]
    fn rows(self, masks: [u32; 8]) -> u64 {
        (0..8).fold(0, |bits, i| bits | (u64::from(masks[i]) << (8 * i)))
    }

    #[inline(always)]
    fn columns(self, rows: &[[f32; 4]; 8]) -> [Eight; 3] {
        std::array::from_fn(|k| rows.map(|row| row[k]))
    }

    #[inline(always)]
    fn compact(self, from: &Eight, mask: u32, to: &mut Eight) {
        compact(from, mask, to);
    }

    #[inline(always)]
    fn compact_ids(self, from: &[u32; 8], mask: u32, to: &mut [u32; 8]) {
        compact(from, mask, to);
    }

    #[inline(always)]
    fn equal_ids(self, ids: &[u32; 8], id: u32) -> u32 {
        (0..8).fold(0, |bits, k| bits | u32::from(ids[k] == id) << k)
    }

    #[inline(always)]
    fn place(self, point: &[f64; 4], origin: &[f64; 4], scale: f64, axes: [u32; 4]) -> [f32; 4] {
        axes.map(|axis| {
            let axis = axis as usize & 3;
            ((point[axis] - origin[axis]) * scale) as f32
        })
    }

    #[inline(always)]
    fn widen(self, [min, max]: &mut [[f32; 4]; 2], point: [f32; 4]) {
        for k in 0..4 {
            min[k] = if point[k] < min[k] { point[k] } else { min[k] };
            max[k] = if point[k] > max[k] { point[k] } else { max[k] };
        }
    }
}

#[inline(always)]
fn compact<T: Copy>(from: &[T; 8], mut mask: u32, to: &mut [T; 8]) {
    let mut at = 0;
    while mask != 0 {
        to[at] = from[mask.trailing_zeros() as usize & 7];
        at += 1;
        mask &= mask - 1;
    }
}
