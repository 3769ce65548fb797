//! Points that no region inside the bounds slips through.

use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;

/// A grid may have so many times the planned evaluations: a part of it misses less than as many points anywhere. And so many points where
/// their number is not planned.
const MOST_OF_PLANNED: u64 = 4;
const MOST: u64 = 1 << 16;
/// Up to here numbers of points are exact.
const LAST: u64 = 1 << 53;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The points of one grid after the other, each once. Level k has the shares 1/(k+1), ..., k/(k+1) of each continuous axis, on a periodic
/// axis k shares all around: k^d points, of which every box inside the bounds contains one whose sides are above 1/(k+1).
///
/// Of uniform points such a box may have to wait for (k+1)^d and more, because they also look where no region inside the bounds has its
/// middle.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct InnerGrid {
    /// The level, and the number of its points; 0 before the first.
    level: u64,
    points: u64,
    /// How many of them were drawn, where these began, and how far apart they are, in the order of the grid.
    drawn: u64,
    start: u64,
    stride: u64,
    /// How far the shares are turned on periodic axes.
    turn: f64,
}

impl InnerGrid {
    /// Writes the next position; on integer axes it is uniform. `false` where no axis is continuous, and where the next grid has too many points
    /// for a search with so many planned evaluations, if that is known.
    pub(super) fn draw<S: Real>(
        &mut self,
        space: &Space<S>,
        planned: Option<u64>,
        rng: &mut SearchRng,
        position: &mut [S],
    ) -> bool {
        let count = space.axes().iter().filter(|axis| !axis.is_integer()).count();
        let most = planned.map_or(MOST, |planned| planned.saturating_mul(MOST_OF_PLANNED).min(LAST));
        loop {
            if self.drawn == self.points && !self.begin(count, most, rng) {
                return false;
            }
            if self.draw_next(space, rng, position) {
                return true;
            }
        }
    }

    /// Whether restored parts fit each other.
    pub(super) fn is_sound(&self) -> bool {
        self.level <= LAST
            && self.points <= LAST
            && self.drawn <= self.points
            && (self.points == 0 || self.level > 0 && self.start < self.points)
    }

    /// Begins the next grid on so many axes.
    fn begin(&mut self, axes: usize, most: u64, rng: &mut SearchRng) -> bool {
        let points = u32::try_from(axes).ok().filter(|&axes| axes > 0);
        let points = points.and_then(|axes| (self.level + 1).checked_pow(axes));
        let Some(points) = points.filter(|&points| points <= most) else {
            return false;
        };
        self.level += 1;
        (self.points, self.drawn) = (points, 0);
        self.start = (rng.uniform() * points as f64) as u64 % points;
        self.turn = rng.uniform();
        // All points come once, because the stride has no divisor in common with their number, and evenly, because it is golden.
        self.stride = (points as f64 * GOLDEN) as u64 / self.level * self.level + 1;
        true
    }

    /// Writes the next point of the grid; `false` if that is a point of a coarser one.
    fn draw_next<S: Real>(&mut self, space: &Space<S>, rng: &mut SearchRng, position: &mut [S]) -> bool {
        let distance = u128::from(self.drawn) * u128::from(self.stride) + u128::from(self.start);
        let mut index = (distance % u128::from(self.points)) as u64;
        self.drawn += 1;
        let parts = self.level + 1;
        let mut divisor = parts;
        for (axis, x) in space.axes().iter().zip(position) {
            let share = if axis.is_integer() {
                divisor = 1;
                rng.uniform()
            } else {
                let place = index % self.level;
                index /= self.level;
                if axis.is_periodic() {
                    divisor = 1;
                    (place as f64 + self.turn) / self.level as f64
                } else {
                    divisor = greatest_common_divisor(divisor, place + 1);
                    (place + 1) as f64 / parts as f64
                }
            };
            *x = axis.at(share);
        }
        divisor == 1
    }
}

fn greatest_common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::Axis;

    fn points(space: &Space<f64>, planned: Option<u64>) -> Vec<Vec<f64>> {
        let (mut grid, mut rng) = (InnerGrid::default(), SearchRng::new(5));
        let mut position = vec![0.0; space.dimension()];
        core::iter::from_fn(|| {
            grid.draw(space, planned, &mut rng, &mut position)
                .then(|| position.clone())
        })
        .collect()
    }

    /// Grids of 1, 8, 27 and 64 points; of the last two the middle and the points at 1/2 on all axes are known by then.
    #[test]
    fn every_point_comes_once_and_no_box_inside_is_missed() {
        let space = Space::cube(3, 0.0, 1.0).unwrap();
        let points = points(&space, Some(16));
        let bits = |x: &Vec<f64>| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(
            points.iter().map(bits).collect::<BTreeSet<_>>().len(),
            points.len()
        );
        assert_eq!(points.len(), 1 + 8 + 26 + 64);
        let mut rng = SearchRng::new(6);
        for (side, known) in [(0.501, 1), (0.334, 9), (0.251, 35), (0.201, 99)] {
            for _ in 0..1000 {
                let corner: Vec<f64> = (0..3).map(|_| (1.0 - side) * rng.uniform()).collect();
                let holds = |x: &Vec<f64>| x.iter().zip(&corner).all(|(x, c)| (*c..=c + side).contains(x));
                assert!(points[..known].iter().any(holds), "{side} {corner:?}");
            }
        }
    }

    #[test]
    fn periodic_axes_have_points_all_around_and_integer_axes_any() {
        let axes = [
            Axis::continuous(0.0, 1.0).periodic(),
            Axis::integer(0, 4),
            Axis::continuous(2.0, 8.0),
        ];
        let space = Space::new(axes).unwrap();
        let points = points(&space, Some(9));
        assert_eq!(points.len(), 1 + 4 + 9 + 16 + 25 + 36);
        let around: Vec<f64> = points[14..30].iter().map(|x| x[0]).collect();
        for arc in 0..100 {
            let start = f64::from(arc) / 100.0;
            assert!(
                around.iter().any(|x| (x - start).rem_euclid(1.0) <= 0.251),
                "{start}"
            );
        }
        let values: BTreeSet<u64> = points
            .iter()
            .map(|x| space.axes()[1].value(x[1]).to_bits())
            .collect();
        assert_eq!(values.len(), 5);
        assert!(points[5..14].iter().all(|x| [3.5, 5.0, 6.5].contains(&x[2])));
    }

    #[test]
    fn a_state_that_cannot_be_is_told() {
        let (mut grid, mut rng) = (InnerGrid::default(), SearchRng::new(1));
        assert!(grid.is_sound());
        let space = Space::<f64>::cube(2, 0.0, 1.0).unwrap();
        let mut position = [0.0; 2];
        (0..3).for_each(|_| assert!(grid.draw(&space, None, &mut rng, &mut position)));
        assert!(grid.is_sound());
        let others = [
            InnerGrid {
                level: 0,
                ..grid.clone()
            },
            InnerGrid {
                level: u64::MAX,
                ..grid.clone()
            },
            InnerGrid {
                points: 1,
                ..grid.clone()
            },
            InnerGrid {
                start: 4,
                ..grid.clone()
            },
        ];
        assert!(others.iter().all(|grid| !grid.is_sound()));
    }

    #[test]
    fn a_grid_is_left_out_that_is_much_larger_than_the_search() {
        let cube = |axes| Space::cube(axes, 0.0, 1.0).unwrap();
        assert_eq!(points(&cube(6), Some(15)).len(), 1);
        assert_eq!(points(&cube(6), Some(16)).len(), 65);
        assert_eq!(points(&cube(100), Some(u64::MAX)).len(), 1);
        assert_eq!(points(&cube(16), None).len(), 1 + (1 << 16));
        assert!(points(&Space::lattice(2, 9).unwrap(), Some(100)).is_empty());
    }
}
