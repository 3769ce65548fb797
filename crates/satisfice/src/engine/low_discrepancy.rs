//! Points that cover a space evenly, however many are drawn.

use core::f64::consts::TAU;

use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;

/// How far points are drawn [inwards](EvenPoints::draw_inwards): they are `1 / (1 - INWARDS)` times as dense in the middle of an axis and
/// `1 / (1 + INWARDS)` times at its ends.
const INWARDS: f64 = 0.3;

/// Points of the additive recurrence `x_j = frac(shift_j + index * phi^-j)` from a random shift on, `phi` being the root of
/// `phi^(d+1) = phi + 1` above 1.
///
/// Generalised golden ratios: Roberts 2018, The Unreasonable Effectiveness of Quasirandom Sequences.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct EvenPoints {
    /// The shift and the step of each coordinate; none before the first point.
    coordinates: Vec<(f64, f64)>,
    next: u64,
}

impl EvenPoints {
    /// The next point of the unit cube of so many dimensions.
    #[expect(clippy::cast_precision_loss, reason = "indices are below 2^53")]
    pub(super) fn next_point(
        &mut self,
        dimension: usize,
        rng: &mut SearchRng,
    ) -> impl Iterator<Item = f64> + use<'_> {
        if self.coordinates.len() != dimension {
            let phi = generalised_golden_ratio(dimension);
            let mut step = 1.0;
            self.coordinates.clear();
            self.coordinates.extend((0..dimension).map(|_| {
                step /= phi;
                (rng.uniform(), step)
            }));
        }
        let index = self.next as f64;
        self.next += 1;
        let coordinates = self.coordinates.iter();
        coordinates.map(move |(shift, step)| (shift + index * step).fract())
    }

    /// Writes the next position. On integer axes it is uniform.
    pub(super) fn draw<S: Real>(&mut self, space: &Space<S>, rng: &mut SearchRng, position: &mut [S]) {
        self.draw_by(|share| share, space, rng, position);
    }

    /// Writes the next position, denser in the middle of the axes than at their ends, except for integer and periodic axes: a region that
    /// lies inside the bounds covers the middle more often.
    pub(super) fn draw_inwards<S: Real>(
        &mut self,
        space: &Space<S>,
        rng: &mut SearchRng,
        position: &mut [S],
    ) {
        self.draw_by(
            |share| share + INWARDS / TAU * (TAU * share).sin(),
            space,
            rng,
            position,
        );
    }

    fn draw_by<S: Real>(
        &mut self,
        density: impl Fn(f64) -> f64,
        space: &Space<S>,
        rng: &mut SearchRng,
        position: &mut [S],
    ) {
        let axes = space.axes();
        let continuous = axes.iter().filter(|axis| !axis.is_integer()).count();
        let mut shares = self.next_point(continuous, rng);
        for (axis, x) in axes.iter().zip(position) {
            let share = if axis.is_integer() { None } else { shares.next() };
            *x = axis.at(match share {
                None => rng.uniform(),
                Some(share) if axis.is_periodic() => share,
                Some(share) => density(share),
            });
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of axes")]
fn generalised_golden_ratio(axes: usize) -> f64 {
    let mut phi = 2.0_f64;
    for _ in 0..40 {
        phi = (1.0 + phi).powf(1.0 / (axes as f64 + 1.0));
    }
    phi
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Axis;

    #[test]
    fn every_part_of_a_square_has_its_share() {
        let (mut points, mut rng) = (EvenPoints::default(), SearchRng::new(1));
        points.next_point(2, &mut rng).for_each(drop);
        (points.coordinates[0].0, points.coordinates[1].0, points.next) = (0.3, 0.8, 0);
        let mut counts = [0; 16];
        for _ in 0..160 {
            let x: Vec<f64> = points.next_point(2, &mut rng).collect();
            counts[(x[0] * 4.0) as usize * 4 + (x[1] * 4.0) as usize] += 1;
        }
        assert!(counts.iter().all(|count| (8..=12).contains(count)), "{counts:?}");
    }

    #[test]
    fn positions_are_even_on_continuous_axes_and_denser_inside() {
        let axes = [
            Axis::continuous(-1.0, 3.0),
            Axis::integer(0, 9),
            Axis::continuous(0.0, 1.0).periodic(),
        ];
        let space = Space::<f64>::new(axes).unwrap();
        let mut rng = SearchRng::new(2);
        let (mut even, mut inwards) = (EvenPoints::default(), EvenPoints::default());
        let (mut counts, mut position) = ([[0_i32; 4]; 4], [0.0; 3]);
        for _ in 0..4000 {
            even.draw(&space, &mut rng, &mut position);
            counts[0][(position[0] + 1.0) as usize] += 1;
            counts[1][(position[2] * 4.0) as usize] += 1;
            assert!((0.0..10.0).contains(&position[1]));
            inwards.draw_inwards(&space, &mut rng, &mut position);
            counts[2][((position[0] + 1.0) as usize).min(3)] += 1;
            counts[3][(position[2] * 4.0) as usize] += 1;
        }
        for quarters in [counts[0], counts[1], counts[3]] {
            assert!(
                quarters.iter().all(|count| (990..=1010).contains(count)),
                "{quarters:?}"
            );
        }
        let [first, second, third, last] = counts[2];
        // The share u of points up to a quarter of the axis: u + INWARDS / TAU * sin(TAU * u) = 1 / 4.
        assert!(
            (first - 817).abs() < 10 && (last - 817).abs() < 10,
            "{:?}",
            counts[2]
        );
        assert!(
            (second - 1183).abs() < 10 && (third - 1183).abs() < 10,
            "{:?}",
            counts[2]
        );
    }

    #[test]
    fn one_axis_has_the_golden_ratio() {
        approx::assert_relative_eq!(
            generalised_golden_ratio(1),
            1.618_033_988_749_895,
            max_relative = 1e-12
        );
    }
}
