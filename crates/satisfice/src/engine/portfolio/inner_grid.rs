//! Finer and finer grids, for step functions: points that no box inside the bounds slips through.

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
    /// 0 before the first grid.
    level: u64,
    /// How many of its points were drawn, and where these began in the order of the grid.
    drawn: u64,
    start: u64,
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
        let Some(axes) = u32::try_from(count).ok().filter(|&axes| axes > 0) else {
            return false;
        };
        let most = planned.map_or(MOST, |planned| planned.saturating_mul(MOST_OF_PLANNED).min(LAST));
        loop {
            let points = self.level.checked_pow(axes).filter(|&points| points <= LAST);
            let points = points.unwrap_or(0);
            if self.drawn >= points {
                if !self.begin(axes, most, rng) {
                    return false;
                }
            } else if self.draw_next(points, space, rng, position) {
                return true;
            }
        }
    }

    /// Begins the next grid on so many axes.
    fn begin(&mut self, axes: u32, most: u64, rng: &mut SearchRng) -> bool {
        let level = self.level.saturating_add(1);
        let points = level.checked_pow(axes).filter(|&points| points <= most);
        let Some(points) = points else {
            return false;
        };
        (self.level, self.drawn) = (level, 0);
        self.start = (rng.uniform() * points as f64) as u64 % points;
        self.turn = rng.uniform();
        true
    }

    /// Writes the next of so many points of the grid; `false` if that is a point of a coarser one.
    fn draw_next<S: Real>(
        &mut self,
        points: u64,
        space: &Space<S>,
        rng: &mut SearchRng,
        position: &mut [S],
    ) -> bool {
        // All points come once, because the stride has no divisor in common with their number, and evenly, because it is golden.
        let stride = (points as f64 * GOLDEN) as u64 / self.level * self.level + 1;
        let distance = u128::from(self.drawn) * u128::from(stride) + u128::from(self.start);
        let mut index = (distance % u128::from(points)) as u64;
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

    /// What a damaged checkpoint may hold: it goes on, or says that there is no more.
    #[test]
    fn no_state_breaks_it() {
        let space = Space::<f64>::cube(1, 0.0, 1.0).unwrap();
        let (mut rng, mut position) = (SearchRng::new(1), [0.0]);
        for level in [0, 3, LAST, u64::MAX] {
            for drawn in [0, 8, u64::MAX] {
                let mut grid = InnerGrid {
                    level,
                    drawn,
                    start: u64::MAX,
                    turn: 0.5,
                };
                let draws = grid.draw(&space, None, &mut rng, &mut position);
                assert_eq!(draws, level <= 3 || level == LAST && drawn < u64::MAX);
                assert!(position.iter().all(|x| (0.0..=1.0).contains(x)));
            }
        }
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
