//! Where most of some points are, whatever a few of them do: a centre and a half width from quantiles of a sample.

use crate::Aabb;

/// Points looked at. They are evenly spread over the numbers, so that the answer depends on nothing else.
const SAMPLE: usize = 31;
/// The half width is this many times the first quartile of the distances from the centre.
const WIDE: f64 = 64.0;
/// Something is far away from here on, in the same unit: a coordinate has lost so much of its precision that boxes suffer.
const FAR: f64 = 1024.0;

/// A cube that holds most of some points while others are far outside.
pub(crate) struct Core {
    pub(crate) centre: [f64; 3],
    pub(crate) half: f64,
}

impl Core {
    /// Of `count` points inside `bounds`; `None` if none of them is far away. Cost: constant.
    pub(crate) fn find(count: usize, at: impl Fn(usize) -> [f64; 3], bounds: &Aabb) -> Option<Self> {
        let taken = count.min(SAMPLE);
        if taken < 4 {
            return None;
        }
        let mut points = [[0.0; 3]; SAMPLE];
        for (sample, point) in points[..taken].iter_mut().enumerate() {
            *point = at((sample as u64 * count as u64 / taken as u64) as usize);
        }
        let points = &points[..taken];
        let quantile = |of: &dyn Fn(&[f64; 3]) -> f64, rank: usize| {
            let mut values = [0.0; SAMPLE];
            for (value, point) in values.iter_mut().zip(points) {
                *value = of(point);
            }
            *values[..taken].select_nth_unstable_by(rank, f64::total_cmp).1
        };
        let centre = [0, 1, 2].map(|k| quantile(&|point| point[k], taken / 2));
        let away = |point: &[f64; 3]| (0..3).fold(0.0_f64, |most, k| most.max((point[k] - centre[k]).abs()));
        // where many points are at one place, the nearest of the others
        let nearest = points.iter().map(away).filter(|&away| away > 0.0);
        let quartile = match quantile(&away, taken / 4) {
            0.0 => nearest.fold(f64::INFINITY, f64::min),
            quartile => quartile,
        };
        let farthest = away(&bounds.min).max(away(&bounds.max));
        (farthest > FAR * quartile).then_some(Self {
            centre,
            half: WIDE * quartile,
        })
    }
}
