//! Two triangles far apart, by eight candidates for a separating axis, one per lane.
//!
//! For any v with |v| <= 1 + 1e-5, `(min v.a - max v.b) / |v|` is a lower bound of the distance, however v was found. Each
//! triangle contributes its four `directions`. Rounding: coordinates wrong by e, dot products of numbers up to H wrong by less
//! than 6u sqrt(3) H, both twice in a gap; `Filter::apart` allows for that.

use super::directions::Directions;
use super::relative::Relative;

/// Whether two triangles of one frame are proved further than `apart` from each other.
#[inline(always)]
fn separated(a: &[[f32; 3]; 3], of_a: &Directions, b: &[[f32; 3]; 3], of_b: &Directions, apart: f32) -> bool {
    let v: [[f32; 8]; 3] =
        std::array::from_fn(|k| std::array::from_fn(|l| if l < 4 { of_a[k][l] } else { of_b[k][l - 4] }));
    let dot = |p: &[f32; 3]| -> [f32; 8] {
        std::array::from_fn(|l| v[0][l] * p[0] + v[1][l] * p[1] + v[2][l] * p[2])
    };
    let low = |x: [f32; 8], y: [f32; 8]| -> [f32; 8] {
        std::array::from_fn(|l| if x[l] < y[l] { x[l] } else { y[l] })
    };
    let high = |x: [f32; 8], y: [f32; 8]| -> [f32; 8] {
        std::array::from_fn(|l| if x[l] > y[l] { x[l] } else { y[l] })
    };
    let (a0, a1, a2) = (dot(&a[0]), dot(&a[1]), dot(&a[2]));
    let (b0, b1, b2) = (dot(&b[0]), dot(&b[1]), dot(&b[2]));
    let (low_a, high_a) = (low(low(a0, a1), a2), high(high(a0, a1), a2));
    let (low_b, high_b) = (low(low(b0, b1), b2), high(high(b0, b1), b2));
    let mut any = false;
    for l in 0..8 {
        any |= (low_a[l] - high_b[l] > apart) | (low_b[l] - high_a[l] > apart);
    }
    any
}

/// The triangles of a tree as this filter wants them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangles<'a> {
    pub(crate) corners: &'a [[u32; 3]],
    pub(crate) placed: &'a [[f32; 3]],
    pub(crate) directions: &'a [Directions],
}

impl Triangles<'_> {
    #[inline(always)]
    fn at(&self, t: u32) -> ([[f32; 3]; 3], &Directions) {
        (
            self.corners[t as usize].map(|v| self.placed[v as usize]),
            &self.directions[t as usize],
        )
    }

    /// Whether triangle `i` of this tree, brought into the frame of `other`, is proved too far from its triangle `j`.
    #[inline(always)]
    pub(crate) fn apart(&self, i: u32, other: &Self, j: u32, relative: &Relative, apart: f32) -> bool {
        let ((a, of_a), (b, of_b)) = (self.at(i), other.at(j));
        let a = a.map(|p| relative.point(p));
        if relative.is_turned() {
            separated(&a, &relative.directions(of_a), &b, of_b, apart)
        } else {
            separated(&a, of_a, &b, of_b, apart)
        }
    }
}
