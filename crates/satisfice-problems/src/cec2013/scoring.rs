//! The suite's score of a run, and a score that points crowded around one optimum cannot inflate.

use super::problem::Cec2013;

/// The score of a set of submitted points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Score {
    /// Optima found by the suite's rule: sorted by value, a point is a seed if it is farther than the niche radius from every
    /// better seed; seeds within the accuracy of the peak count, at most as many as there are optima.
    pub by_height: usize,
    /// Optima found by place: those with a submitted point within the accuracy of the peak that is nearer to them than to any
    /// other optimum, and not farther than the niche radius.
    pub by_place: usize,
    /// Known optima.
    pub known: usize,
    /// Points submitted.
    pub submitted: usize,
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

impl Cec2013 {
    /// Scores submitted points at an accuracy, one of 1e-1 ... 1e-5 in the suite. At 1e-1 the suite's rule counts points
    /// around one optimum as several on problems 4, 11 and 14 to 20: report 1e-4 and 1e-5, by place.
    ///
    /// Points with a wrong number of coordinates or a coordinate that is not finite count as submitted but never as found.
    /// Cost: O(n log n) and O(n m) for n points near the peak and m seeds.
    #[must_use]
    pub fn score(&self, submitted: &[Vec<f64>], accuracy: f64) -> Score {
        let optima = self.optima();
        let value = |x: &Vec<f64>| self.height(x);
        let mut points: Vec<(f64, &Vec<f64>)> = submitted.iter().map(|x| (value(x), x)).collect();
        points.retain(|(height, _)| height.is_finite());
        points.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut seeds: Vec<&Vec<f64>> = Vec::new();
        let mut found = vec![false; optima.len()];
        for (height, x) in points {
            // Points are sorted: after the first that is too low, none counts.
            if (height - self.peak()).abs() > accuracy {
                if height < self.peak() {
                    break;
                }
                continue;
            }
            let places = optima
                .iter()
                .enumerate()
                .map(|(k, place)| (distance(place, x), k));
            if let Some((away, nearest)) = places.min_by(|a, b| a.0.total_cmp(&b.0))
                && away <= self.radius()
            {
                found[nearest] = true;
            }
            if seeds.iter().all(|seed| distance(seed, x) > self.radius()) {
                seeds.push(x);
            }
        }
        Score {
            by_height: seeds.len().min(optima.len()),
            by_place: found.iter().filter(|found| **found).count(),
            known: optima.len(),
            submitted: submitted.len(),
        }
    }
}

/// The peak ratio of several runs, by place: optima found over optima known. NaN for no run.
#[must_use]
pub fn peak_ratio(runs: &[Score]) -> f64 {
    let found: usize = runs.iter().map(|run| run.by_place).sum();
    let known: usize = runs.iter().map(|run| run.known).sum();
    found as f64 / known as f64
}
