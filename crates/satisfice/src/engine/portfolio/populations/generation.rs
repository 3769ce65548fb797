//! A generation of MA-ES against the published equations (Beyer, Sendhoff 2017, Fig. 3 and Eqs. 21 to 24), written out once more.

#![expect(clippy::needless_range_loop, reason = "indices, as in the equations")]

use crate::testing::BareContext;
use crate::{Axis, SearchRng, Space};

use super::Population;

type Matrix = [[f64; 3]; 3];
const WIDTHS: [f64; 3] = [200.0, 2.0, 8.0];

fn fitness(x: &[f64]) -> f64 {
    let turned = [x[0] / 200.0 + x[1] / 2.0, x[1] / 2.0 - x[2] / 8.0, x[2] / 8.0];
    turned[0].powi(2) + 30.0 * turned[1].powi(2) + 900.0 * turned[2].powi(2)
}

/// s, M, y and sigma after a generation of these draws z, best first; y in units of the axes.
struct Strategy {
    path: [f64; 3],
    matrix: Matrix,
    mean: [f64; 3],
    sigma: f64,
}

impl Strategy {
    fn generation(&mut self, members: usize, best_first: &[[f64; 3]]) {
        let n = 3.0_f64;
        let mu = members / 2;
        let raw: Vec<f64> = (1..=mu)
            .map(|m| (mu as f64 + 0.5).ln() - (m as f64).ln())
            .collect();
        let w: Vec<f64> = raw.iter().map(|x| x / raw.iter().sum::<f64>()).collect();
        let mu_eff = 1.0 / w.iter().map(|w| w * w).sum::<f64>();
        let cs = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let c1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let cw = (1.0 - c1).min(2.0 * (mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0).powi(2) + mu_eff));
        let damping = 1.0 + cs + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0);
        // E |N(0, I)| in three dimensions, by the published series.
        let chi = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

        let mut mean_z = [0.0; 3];
        let mut mean_zz = [[0.0; 3]; 3];
        for (w, z) in w.iter().zip(best_first) {
            for i in 0..3 {
                mean_z[i] += w * z[i];
                for j in 0..3 {
                    mean_zz[i][j] += w * z[i] * z[j];
                }
            }
        }
        let old = self.matrix;
        for i in 0..3 {
            let step: f64 = (0..3).map(|j| old[i][j] * mean_z[j]).sum();
            self.mean[i] += self.sigma * step;
            self.path[i] = (1.0 - cs) * self.path[i] + (mu_eff * cs * (2.0 - cs)).sqrt() * mean_z[i];
        }
        // M := M (I + c1/2 (s s^T - I) + cw/2 (<z z^T> - I))
        let identity = |i: usize, j: usize| f64::from(u8::from(i == j));
        for i in 0..3 {
            for j in 0..3 {
                self.matrix[i][j] = (0..3)
                    .map(|k| {
                        let rank_one = self.path[k] * self.path[j] - identity(k, j);
                        let rank_mu = mean_zz[k][j] - identity(k, j);
                        old[i][k] * (identity(k, j) + c1 / 2.0 * rank_one + cw / 2.0 * rank_mu)
                    })
                    .sum();
            }
        }
        let length = self.path.iter().map(|s| s * s).sum::<f64>().sqrt();
        self.sigma *= (cs / damping * (length / chi - 1.0)).exp();
    }
}

#[test]
fn a_generation_is_the_published_one() {
    let axes = WIDTHS.map(|width| Axis::continuous(-width / 2.0, width / 2.0));
    let context = &BareContext::new(Space::<f64>::new(axes).unwrap());
    let mut rng = SearchRng::new(9);
    let mut population = Population::<f64>::default();
    population.start(3, context, &mut rng);
    population.mean.copy_from_slice(&[10.0, -0.3, 0.7]);
    population.sigma = 0.02;
    let members = population.fitness.len();
    assert_eq!(members, 3 * 7, "three times 4 + floor(3 ln 3)");
    let mut strategy = Strategy {
        path: [0.0; 3],
        matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mean: [10.0 / 200.0, -0.3 / 2.0, 0.7 / 8.0],
        sigma: 0.02,
    };
    for _ in 0..12 {
        let mut drawn = Vec::new();
        let mut twin = rng.clone();
        for member in 0..members {
            let mut x = [0.0; 3];
            population.propose(context, &mut rng, &mut x);
            let z = [0; 3].map(|_| twin.normal());
            for i in 0..3 {
                let step: f64 = (0..3).map(|j| strategy.matrix[i][j] * z[j]).sum();
                let expected = WIDTHS[i] * (strategy.mean[i] + strategy.sigma * step);
                approx::assert_relative_eq!(x[i], expected, max_relative = 1e-8, epsilon = 1e-10);
            }
            population.fitness[member] = fitness(&x);
            drawn.push((fitness(&x), z));
        }
        population.adapt(context);
        drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best_first: Vec<_> = drawn.into_iter().map(|(_, z)| z).collect();
        strategy.generation(members, &best_first);
        approx::assert_relative_eq!(population.sigma, strategy.sigma, max_relative = 1e-9);
        for i in 0..3 {
            let mean = WIDTHS[i] * strategy.mean[i];
            approx::assert_relative_eq!(population.mean[i], mean, max_relative = 1e-9, epsilon = 1e-12);
            approx::assert_relative_eq!(population.path[i], strategy.path[i], epsilon = 1e-9);
            for j in 0..3 {
                let (found, expected) = (population.matrix[3 * i + j], strategy.matrix[i][j]);
                approx::assert_relative_eq!(found, expected, epsilon = 1e-9);
            }
        }
    }
}
