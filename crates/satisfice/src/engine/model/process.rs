//! Gaussian process: scales, points, values, and what they predict.

use super::kernel::covariances;
use super::lanes::{LANES, Lanes, on_wide_vectors};
use super::likelihood::Fit;
use super::scales::Scales;
use pulp::NullaryFnOnce;

/// Least variance of a prediction, as a share of the process's.
const LEAST_VARIANCE: f64 = 1e-9;

/// A Gaussian process that is extended by a point at a time.
#[derive(Debug, Clone)]
pub(super) struct Process {
    pub(super) scales: Scales,
    fit: Fit,
    /// How many points have values of their own: those after them are believed to have the predicted ones.
    told: usize,
    /// `L⁻¹ (y - mean)` for each output.
    solved: Vec<Vec<f64>>,
}

/// A block of candidates and what the points say of them.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// In units of the axes.
    pub(super) units: Vec<Lanes>,
    scaled: Vec<Lanes>,
    /// `L⁻¹ k` for each candidate, as far as it is known.
    solved: Vec<Lanes>,
    /// What the points add to the mean of each output.
    mean: Vec<Lanes>,
    /// What the points take from the variance, as a share of it.
    explained: Lanes,
    /// The same of the points that are believed.
    believed: Lanes,
}

impl Block {
    pub(super) fn new(units: Vec<Lanes>) -> Self {
        Self {
            scaled: Vec::new(),
            units,
            solved: Vec::new(),
            mean: Vec::new(),
            explained: [0.0; LANES],
            believed: [0.0; LANES],
        }
    }

    /// Forgets the predictions.
    pub(super) fn reset(&mut self) {
        self.solved.clear();
        self.mean.clear();
        self.explained = [0.0; LANES];
        self.believed = [0.0; LANES];
    }
}

impl Process {
    /// The process through these points, with the likeliest mean and variance.
    pub(super) fn new(scales: Scales, inputs: &[&[f64]], values: &[Vec<f64>]) -> Self {
        let mut fit = Fit::default();
        fit.factor(&scales, inputs);
        let solved = fit.moments(values);
        Self {
            scales,
            fit,
            told: inputs.len(),
            solved,
        }
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.solved[0].len()
    }

    /// Adds a point that is believed to have the values that are predicted for it (Ginsbourger, Le Riche, Carraro 2010). Until it is
    /// [forgotten](Self::truncate) no other kind is added.
    pub(super) fn believe(&mut self, input: &[f64]) {
        let unknown = vec![f64::NAN; self.outputs()];
        let told = self.told;
        self.push(input, &unknown);
        self.told = told;
    }

    /// Adds a point, and returns by how much each output was predicted wrongly. Cost: n² / 2.
    pub(super) fn push(&mut self, input: &[f64], values: &[f64]) -> Vec<f64> {
        let fit = &mut self.fit;
        fit.points.push(self.scales.scaled_point(input).into_iter());
        let new = fit.points.len() - 1;
        let row = fit.points.row(new);
        let mut all: Vec<f64> = Vec::with_capacity(new + LANES);
        for b in 0..fit.points.blocks() {
            all.extend(covariances(&fit.points.features, row, fit.points.block(b)));
        }
        all.truncate(new);
        fit.factor.push(all.into_iter(), 1.0 + self.scales.noise());
        let row = fit.factor.row(new);
        let mut errors = Vec::with_capacity(values.len());
        for (k, solved) in self.solved.iter_mut().enumerate() {
            let known = row
                .iter()
                .zip(&*solved)
                .fold(values[k] - fit.mean[k], |sum, (l, z)| sum - l * z);
            let known = if values[k].is_nan() { 0.0 } else { known };
            solved.push(known * fit.factor.inverse_pivot(new));
            errors.push(known);
        }
        self.told = new + 1;
        errors
    }

    /// Brings a block back to what the first `len` points say.
    pub(super) fn rewind(&self, block: &mut Block, len: usize) {
        if block.solved.len() > len {
            block.solved.truncate(len);
            block.mean.clear();
            block.explained = [0.0; LANES];
            block.believed = [0.0; LANES];
            self.accumulate(block, 0);
        }
    }

    /// Forgets all points but the first `len`.
    pub(super) fn truncate(&mut self, len: usize) {
        self.fit.points.truncate(len);
        self.fit.factor.truncate(len);
        self.solved.iter_mut().for_each(|solved| solved.truncate(len));
        self.told = self.told.min(len);
    }

    /// Brings what is known of a block up to date. Cost for each candidate and new point: n.
    pub(super) fn update(&self, block: &mut Block) {
        on_wide_vectors(Update(self, block));
    }

    #[inline(always)]
    fn follow(&self, block: &mut Block) {
        let known = block.solved.len();
        if known == 0 {
            block.scaled = self.scales.scaled(&block.units);
        }
        let points = &self.fit.points;
        block.solved.reserve(self.len() - known);
        for i in known..self.len() {
            let row = covariances(&points.features, points.row(i), &block.scaled);
            block.solved.push(row);
        }
        self.fit.factor.solve(&mut block.solved, known);
        self.accumulate(block, known);
    }

    #[inline(always)]
    fn accumulate(&self, block: &mut Block, from: usize) {
        block.mean.resize(self.solved.len(), [0.0; LANES]);
        for (mean, known) in block.mean.iter_mut().zip(&self.solved) {
            for (solved, z) in block.solved[from..].iter().zip(&known[from..]) {
                for (mean, solved) in mean.iter_mut().zip(solved) {
                    *mean += solved * z;
                }
            }
        }
        for (i, solved) in block.solved.iter().enumerate().skip(from) {
            let sum = if i < self.told {
                &mut block.explained
            } else {
                &mut block.believed
            };
            for (sum, solved) in sum.iter_mut().zip(solved) {
                *sum += solved * solved;
            }
        }
    }

    /// The share of a block's variances that the points leave which are believed; `None` if there are none.
    pub(super) fn left(&self, block: &Block) -> Option<Lanes> {
        (self.told < self.len()).then(|| {
            let share = |lane: usize| {
                let before = (1.0 - block.explained[lane]).max(LEAST_VARIANCE);
                ((before - block.believed[lane]) / before).clamp(0.0, 1.0)
            };
            core::array::from_fn(share)
        })
    }

    /// The mean of the squares of these errors, each by the variance of its output.
    pub(super) fn share_of_variance(&self, errors: &[f64]) -> f64 {
        let shares = errors.iter().zip(&self.fit.variance);
        let sum: f64 = shares.map(|(error, variance)| error * error / variance).sum();
        #[expect(clippy::cast_precision_loss, reason = "a number of outputs")]
        let count = self.outputs() as f64;
        sum / count
    }

    /// Number of outputs.
    pub(super) fn outputs(&self) -> usize {
        self.solved.len()
    }

    /// Means and variances of a block that is up to date, of one output.
    #[inline]
    pub(super) fn predictions(&self, block: &Block, output: usize) -> (Lanes, Lanes) {
        let (mut means, mut variances) = (block.mean[output], block.explained);
        for (mean, variance) in means.iter_mut().zip(&mut variances) {
            *mean += self.fit.mean[output];
            *variance = (1.0 - *variance).max(LEAST_VARIANCE) * self.fit.variance[output];
        }
        (means, variances)
    }
}

/// [`Process::update`] on wide vectors.
struct Update<'a>(&'a Process, &'a mut Block);

impl NullaryFnOnce for Update<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.follow(self.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::units::Shape;

    fn point(i: usize) -> [f64; 2] {
        [(i as f64 * 0.754_877).fract(), (i as f64 * 0.569_840).fract()]
    }

    fn value(x: &[f64]) -> f64 {
        (3.0 * x[0]).sin() + x[1] * x[1]
    }

    fn process(n: usize) -> Process {
        let inputs: Vec<_> = (0..n).map(point).collect();
        let values = [inputs.iter().map(|x| value(x)).collect()];
        let inputs: Vec<&[f64]> = inputs.iter().map(|x| &x[..]).collect();
        Process::new(Scales::new(vec![Shape::Line; 2]), &inputs, &values)
    }

    fn block(first: usize) -> Block {
        let lane = |j: usize| core::array::from_fn(|lane| point(first + lane)[j]);
        Block::new(vec![lane(0), lane(1)])
    }

    #[test]
    fn known_points_are_predicted_for_certain_and_others_nearly() {
        let process = process(60);
        for (first, tolerance) in [(5, 1e-3), (500, 0.02)] {
            let mut block = block(first);
            process.update(&mut block);
            let (means, variances) = process.predictions(&block, 0);
            for lane in 0..LANES {
                let truth = value(&point(first + lane));
                assert!((means[lane] - truth).abs() < tolerance, "{first} {lane}");
                assert!((means[lane] - truth).abs() < 6.0 * variances[lane].sqrt() + 1e-3);
            }
        }
    }

    /// Mean and variance at one point of a process through these, on axes of these shapes with length 0.5.
    fn predict(shapes: Vec<Shape>, known: &[(&[f64], f64)], at: &[f64]) -> (f64, f64) {
        let mut scales = Scales::new(shapes);
        let axes = scales.axes();
        scales.logs[..axes].fill(0.5_f64.ln());
        let (inputs, values): (Vec<&[f64]>, Vec<f64>) = known.iter().copied().unzip();
        let process = Process::new(scales, &inputs, &[values]);
        let mut block = Block::new(at.iter().map(|&x| [x; LANES]).collect());
        process.update(&mut block);
        let (means, variances) = process.predictions(&block, 0);
        (means[0], variances[0])
    }

    #[test]
    fn the_ends_of_a_circle_are_one_point_and_its_far_side_is_far() {
        let known: [(&[f64], f64); 3] = [(&[0.02], -1.0), (&[0.3], 1.0), (&[0.6], 1.0)];
        let (line, circle) = (vec![Shape::Line], vec![Shape::Circle]);
        let [on_line, on_circle] = [line, circle.clone()].map(|shapes| predict(shapes, &known, &[0.99]));
        assert!(on_circle.0 < -0.8 && on_line.0 > 0.0, "{on_circle:?} {on_line:?}");
        assert!(on_circle.1 < 0.1 * on_line.1);
        // A turn of everything changes nothing.
        let turned: Vec<([f64; 1], f64)> = known.iter().map(|(x, y)| ([(x[0] + 0.45).fract()], *y)).collect();
        let turned: Vec<(&[f64], f64)> = turned.iter().map(|(x, y)| (&x[..], *y)).collect();
        let again = predict(circle, &turned, &[0.44]);
        approx::assert_relative_eq!(again.0, on_circle.0, max_relative = 1e-6);
    }

    #[test]
    fn categories_have_no_order() {
        // The middle of five categories is not between its neighbours, and no other category is nearer than another.
        let known: [(&[f64], f64); 4] = [(&[0.1], 0.3), (&[0.3], 1.0), (&[0.7], -1.0), (&[0.9], 0.4)];
        let category = |known: &[(&[f64], f64)], at: f64| predict(vec![Shape::Category], known, &[at]);
        let unknown = category(&known, 0.5);
        let exchanged: [(&[f64], f64); 4] = [(&[0.9], 0.3), (&[0.5], 1.0), (&[0.1], -1.0), (&[0.7], 0.4)];
        let (mean, variance) = category(&exchanged, 0.3);
        approx::assert_relative_eq!(mean, unknown.0, max_relative = 1e-9);
        approx::assert_relative_eq!(variance, unknown.1, max_relative = 1e-9);
        assert!((category(&known, 0.7).0 + 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_block_that_follows_has_the_bits_of_one_computed_at_once() {
        let (mut growing, mut follows) = (process(20), block(300));
        for i in 20..45 {
            growing.push(&point(i), &[value(&point(i))]);
            growing.update(&mut follows);
        }
        let mut at_once = block(300);
        growing.update(&mut at_once);
        assert_eq!(growing.predictions(&follows, 0), growing.predictions(&at_once, 0));
    }

    #[test]
    fn a_point_that_is_taken_back_leaves_no_trace() {
        let (mut one, two) = (process(33), process(33));
        one.push(&point(99), &[7.0]);
        one.truncate(33);
        let (mut a, mut b) = (block(300), block(300));
        one.update(&mut a);
        two.update(&mut b);
        assert_eq!(one.predictions(&a, 0), two.predictions(&b, 0));
    }

    /// A point that is told far from the others is predicted as its value, nearly for certain, and nothing becomes less certain.
    #[test]
    fn a_point_that_is_told_makes_its_neighbourhood_certain() {
        let (mut told, before) = (process(40), process(40));
        let far = [5.0, -5.0];
        told.push(&far, &[0.0]);
        let at = Block::new(far.map(|x| [x; LANES]).to_vec());
        for (mut a, mut b, is_far) in [(at.clone(), at, true), (block(700), block(700), false)] {
            told.update(&mut a);
            before.update(&mut b);
            let ((means, after), (_, before)) = (told.predictions(&a, 0), before.predictions(&b, 0));
            assert!((0..LANES).all(|lane| after[lane] <= before[lane] * (1.0 + 1e-9)));
            assert!(
                !is_far || (means[0].abs() < 0.02 && after[0] < 0.02 * before[0]),
                "{means:?} {after:?}"
            );
        }
    }

    /// A point that is believed leaves as much of the variances as one that is told.
    #[test]
    fn a_point_that_is_believed_says_how_much_its_value_will_tell() {
        let (mut believes, mut is_told) = (process(20), process(20));
        let (mut a, mut b) = (block(300), block(300));
        believes.update(&mut a);
        assert!(believes.left(&a).is_none());
        let (_, before) = believes.predictions(&a, 0);
        believes.believe(&point(301));
        believes.update(&mut a);
        is_told.push(&point(301), &[0.3]);
        is_told.update(&mut b);
        let left = believes.left(&a).unwrap();
        let (_, after) = is_told.predictions(&b, 0);
        for lane in 0..LANES {
            approx::assert_relative_eq!(left[lane] * before[lane], after[lane], max_relative = 1e-6);
        }
        believes.truncate(20);
        believes.rewind(&mut a, 20);
        assert!(believes.left(&a).is_none());
        assert_eq!(believes.predictions(&a, 0).1, before);
    }

    /// Each output is predicted as it would be alone, and a point that is believed moves no prediction.
    #[test]
    fn outputs_share_scales_and_nothing_else() {
        let inputs: Vec<_> = (0..30).map(point).collect();
        let outputs = [
            inputs.iter().map(|x| value(x)).collect::<Vec<_>>(),
            inputs.iter().map(|x| 3.0 - x[0] * x[1]).collect(),
        ];
        let inputs: Vec<&[f64]> = inputs.iter().map(|x| &x[..]).collect();
        let scales = Scales::new(vec![Shape::Line; 2]);
        let mut both = Process::new(scales.clone(), &inputs, &outputs);
        both.push(
            &point(77),
            &[value(&point(77)), 3.0 - point(77)[0] * point(77)[1]],
        );
        let mut block_of_both = block(300);
        both.update(&mut block_of_both);
        for (k, output) in outputs.iter().enumerate() {
            let mut alone = Process::new(scales.clone(), &inputs, core::slice::from_ref(output));
            let next = [value(&point(77)), 3.0 - point(77)[0] * point(77)[1]];
            alone.push(&point(77), &next[k..=k]);
            let mut block = block(300);
            alone.update(&mut block);
            assert_eq!(both.predictions(&block_of_both, k), alone.predictions(&block, 0));
        }
        let before = both.predictions(&block_of_both, 1);
        both.believe(&point(302));
        both.update(&mut block_of_both);
        let after = both.predictions(&block_of_both, 1);
        for lane in 0..LANES {
            approx::assert_relative_eq!(before.0[lane], after.0[lane], max_relative = 1e-12);
        }
        assert_eq!(before.1, after.1);
        assert!(both.left(&block_of_both).unwrap()[2] < 0.01);
    }

    /// Solves `A x = b` by Gaussian elimination with pivots.
    #[expect(clippy::needless_range_loop, reason = "indices, as in the textbook")]
    fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
        let n = b.len();
        for k in 0..n {
            let pivot = (k..n)
                .max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))
                .unwrap();
            a.swap(k, pivot);
            b.swap(k, pivot);
            for i in k + 1..n {
                let factor = a[i][k] / a[k][k];
                for j in k..n {
                    a[i][j] -= factor * a[k][j];
                }
                b[i] -= factor * b[k];
            }
        }
        for k in (0..n).rev() {
            b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
        }
        b
    }

    /// Rasmussen, Williams 2006, Eqs. 2.25 and 2.26 with the likeliest constant mean `1' K^-1 y / 1' K^-1 1` and variance
    /// `(y - m)' K^-1 (y - m) / n`, by elimination and without a factor.
    #[test]
    fn predictions_are_the_published_ones() {
        let mut scales = Scales::new(vec![Shape::Line; 2]);
        scales.logs = vec![-1.0, -0.2, -6.0];
        let known: Vec<_> = (0..23).map(point).collect();
        let y: Vec<f64> = known.iter().map(|x| value(x)).collect();
        let inputs: Vec<&[f64]> = known.iter().map(|x| &x[..]).collect();
        let process = Process::new(scales, &inputs, core::slice::from_ref(&y));
        let mut block = block(300);
        process.update(&mut block);
        let (means, variances) = process.predictions(&block, 0);

        let covariance = |p: &[f64; 2], q: &[f64; 2]| {
            let (dx, dy) = ((p[0] - q[0]) / (-1.0_f64).exp(), (p[1] - q[1]) / (-0.2_f64).exp());
            let s = (5.0 * (dx * dx + dy * dy)).sqrt();
            (1.0 + s + s * s / 3.0) * (-s).exp()
        };
        let noise = |i: usize, j: usize| if i == j { (-6.0_f64).exp() } else { 0.0 };
        let matrix: Vec<Vec<f64>> = (0..23)
            .map(|i| {
                (0..23)
                    .map(|j| covariance(&known[i], &known[j]) + noise(i, j))
                    .collect()
            })
            .collect();
        let sum = |values: &[f64]| values.iter().sum::<f64>();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let ones = solve(matrix.clone(), vec![1.0; 23]);
        let mean = dot(&ones, &y) / sum(&ones);
        let centred: Vec<f64> = y.iter().map(|y| y - mean).collect();
        let weights = solve(matrix.clone(), centred.clone());
        let variance = dot(&centred, &weights) / 23.0;
        for lane in 0..LANES {
            let k: Vec<f64> = known.iter().map(|x| covariance(x, &point(300 + lane))).collect();
            let expected = mean + dot(&k, &weights);
            approx::assert_relative_eq!(means[lane], expected, max_relative = 1e-9);
            let expected = variance * (1.0 - dot(&k, &solve(matrix.clone(), k.clone())));
            approx::assert_relative_eq!(variances[lane], expected, max_relative = 1e-7);
        }
    }
}
