//! On which side of a line or of a plane a point lies, decided exactly: a filter in `f64`, integers where it is not certain.

use dashu_int::IBig;

use super::Point;
use super::exact::{common_unit, cross, dot, integers, sub};
use super::first_point::Volume;
use super::vector;

/// The sign of `(a - d) . ((b - d) x (c - d))`: 1 if `d` is below the plane of a triangle whose corners run counter-clockwise when
/// seen from above, 0 if it lies in the plane. All coordinates are finite.
pub(crate) fn side_of_plane([a, b, c]: [Point; 3], d: Point) -> i32 {
    let volume = Volume::new(vector::sub(a, d), vector::sub(b, d), vector::sub(c, d));
    match volume.sign() {
        0 => exactly(&[a, b, c, d]),
        sign => sign,
    }
}

/// The same in the plane of two axes, k and the next one: 1 if `c` lies to the left of the way from `a` to `b`.
pub(crate) fn side_of_line(a: Point, b: Point, c: Point, k: usize) -> i32 {
    let l = (k + 1) % 3;
    let [a, b, c] = [a, b, c].map(|p| [p[k], p[l], 0.0]);
    let volume = Volume::new(vector::sub(a, c), vector::sub(b, c), [0.0, 0.0, 1.0]);
    match volume.sign() {
        // The plane through a, b and a point above c, seen from c.
        0 => exactly(&[a, b, [c[0], c[1], 1.0], c]),
        sign => sign,
    }
}

#[cold]
fn exactly(points: &[Point; 4]) -> i32 {
    let unit = common_unit(points.iter().flatten().copied());
    let points = integers(points, unit);
    let [a, b, c] = [0, 1, 2].map(|k| sub(&points[k], &points[3]));
    let volume = dot(&a, &cross(&b, &c));
    i32::from(volume > IBig::ZERO) - i32::from(volume < IBig::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_unit_in_the_last_place_decides() {
        let floor = |z: f64| [[0.1, 0.2, z], [0.7, 0.3, z], [0.4, 0.9, z]];
        for z in [0.0, 0.3, 1e-300, 1e15, -7.0] {
            assert_eq!(side_of_plane(floor(z), [0.4, 0.4, z]), 0);
            assert_eq!(side_of_plane(floor(z), [0.4, 0.4, z.next_down()]), 1);
            assert_eq!(side_of_plane(floor(z), [0.4, 0.4, z.next_up()]), -1);
            assert_eq!(side_of_plane(floor(z), [3.4, -5.4, z.next_up()]), -1);
        }
        for k in 0..3 {
            let at = |x: f64, y: f64| {
                let mut point = [9.0; 3];
                (point[k], point[(k + 1) % 3]) = (x, y);
                point
            };
            let third = 1.0 / 3.0;
            assert_eq!(side_of_line(at(0.0, 0.0), at(3.0, 1.0), at(1.5, 0.5), k), 0);
            assert_eq!(
                side_of_line(at(0.0, 0.0), at(1.0, third), at(0.5, 0.5 * third), k),
                0
            );
            assert_eq!(
                side_of_line(at(0.0, 0.0), at(3.0, 1.0), at(1.5, 0.5_f64.next_up()), k),
                1
            );
            assert_eq!(
                side_of_line(at(0.0, 0.0), at(3.0, 1.0), at(1.5, 0.5_f64.next_down()), k),
                -1
            );
        }
    }
}
