//! Composition functions CF1 to CF4.

use super::basic::{Weierstrass, expanded_griewank_rosenbrock, griewank, rastrigin, sphere};

/// The largest dimension of the suite, so that evaluation needs no allocation.
pub(super) const DIMENSION: usize = 20;
/// Height to which every basic function is scaled at the corner (5, ..., 5).
const HEIGHT: f64 = 2000.0;

/// A basic function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Basic {
    Sphere,
    Griewank,
    Rastrigin,
    Weierstrass,
    ExpandedGriewankRosenbrock,
}

/// One row of a recipe: function, width sigma, stretch lambda.
type Ingredient = (Basic, f64, f64);

const CF1: &[Ingredient] = &[
    (Basic::Griewank, 1.0, 1.0),
    (Basic::Griewank, 1.0, 1.0),
    (Basic::Weierstrass, 1.0, 8.0),
    (Basic::Weierstrass, 1.0, 8.0),
    (Basic::Sphere, 1.0, 1.0 / 5.0),
    (Basic::Sphere, 1.0, 1.0 / 5.0),
];
const CF2: &[Ingredient] = &[
    (Basic::Rastrigin, 1.0, 1.0),
    (Basic::Rastrigin, 1.0, 1.0),
    (Basic::Weierstrass, 1.0, 10.0),
    (Basic::Weierstrass, 1.0, 10.0),
    (Basic::Griewank, 1.0, 1.0 / 10.0),
    (Basic::Griewank, 1.0, 1.0 / 10.0),
    (Basic::Sphere, 1.0, 1.0 / 7.0),
    (Basic::Sphere, 1.0, 1.0 / 7.0),
];
const CF3: &[Ingredient] = &[
    (Basic::ExpandedGriewankRosenbrock, 1.0, 1.0 / 4.0),
    (Basic::ExpandedGriewankRosenbrock, 1.0, 1.0 / 10.0),
    (Basic::Weierstrass, 2.0, 2.0),
    (Basic::Weierstrass, 2.0, 1.0),
    (Basic::Griewank, 2.0, 2.0),
    (Basic::Griewank, 2.0, 5.0),
];
const CF4: &[Ingredient] = &[
    (Basic::Rastrigin, 1.0, 4.0),
    (Basic::Rastrigin, 1.0, 1.0),
    (Basic::ExpandedGriewankRosenbrock, 1.0, 4.0),
    (Basic::ExpandedGriewankRosenbrock, 1.0, 1.0),
    (Basic::Weierstrass, 1.0, 1.0 / 10.0),
    (Basic::Weierstrass, 2.0, 1.0 / 5.0),
    (Basic::Griewank, 2.0, 1.0 / 10.0),
    (Basic::Griewank, 2.0, 1.0 / 40.0),
];

/// The recipe of CF`number`, and whether it is rotated.
pub(super) fn recipe(number: usize) -> (&'static [Ingredient], bool) {
    match number {
        1 => (CF1, false),
        2 => (CF2, false),
        3 => (CF3, true),
        _ => (CF4, true),
    }
}

/// CF(x) = -sum_i w_i 2000 f_i(((x - o_i) / lambda_i) M_i) / |f_i(((5, ..., 5) / lambda_i) M_i)|.
#[derive(Debug, Clone)]
pub(super) struct Composition {
    parts: Vec<Part>,
    weierstrass: Weierstrass,
}

#[derive(Debug, Clone)]
struct Part {
    basic: Basic,
    lambda: f64,
    /// 1 / (2 D sigma^2).
    sharpness: f64,
    shift: Vec<f64>,
    /// Row by row; none for the identity.
    rotation: Option<Vec<Vec<f64>>>,
    /// 2000 / |f_max|.
    scale: f64,
}

impl Composition {
    /// One shift and, where the recipe is rotated, one rotation for each ingredient, of one dimension.
    pub(super) fn new(recipe: &[Ingredient], shifts: Vec<Vec<f64>>, rotations: Vec<Vec<Vec<f64>>>) -> Self {
        let weierstrass = Weierstrass::new();
        let mut rotations = rotations.into_iter();
        let parts = recipe.iter().zip(shifts).map(|(&(basic, sigma, lambda), shift)| {
            let dimension = shift.len();
            let mut part = Part {
                basic,
                lambda,
                sharpness: 1.0 / (2.0 * dimension as f64 * sigma * sigma),
                shift: vec![0.0; dimension],
                rotation: rotations.next(),
                scale: 1.0,
            };
            part.scale = HEIGHT / part.value(&vec![5.0; dimension], &weierstrass).abs();
            part.shift = shift;
            part
        });
        Self {
            parts: parts.collect(),
            weierstrass,
        }
    }

    /// The places of the global optima, of height 0.
    pub(super) fn optima(&self) -> Vec<Vec<f64>> {
        self.parts.iter().map(|part| part.shift.clone()).collect()
    }

    pub(super) fn value(&self, x: &[f64]) -> f64 {
        const PARTS: usize = 8;
        let mut weights = [0.0; PARTS];
        for (weight, part) in weights.iter_mut().zip(&self.parts) {
            let square: f64 = x.iter().zip(&part.shift).map(|(x, o)| (x - o) * (x - o)).sum();
            *weight = (-square * part.sharpness).exp();
        }
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let damping = 1.0 - largest.powi(10);
        for weight in &mut weights {
            if *weight < largest {
                *weight *= damping;
            }
        }
        let sum: f64 = weights.iter().sum();
        let mut value = 0.0;
        for (weight, part) in weights.iter().zip(&self.parts) {
            let share = if sum == 0.0 {
                1.0 / self.parts.len() as f64
            } else {
                weight / sum
            };
            // Parts without weight are not evaluated: far from its shift, a part has none.
            if share > 0.0 {
                value += share * part.scale * part.value(x, &self.weierstrass);
            }
        }
        -value
    }
}

impl Part {
    fn value(&self, x: &[f64], weierstrass: &Weierstrass) -> f64 {
        let n = self.shift.len();
        let mut moved = [0.0; DIMENSION];
        for ((moved, x), shift) in moved.iter_mut().zip(x).zip(&self.shift) {
            *moved = (x - shift) / self.lambda;
        }
        let mut turned = [0.0; DIMENSION];
        let z = match &self.rotation {
            None => &moved[..n],
            Some(rows) => {
                for (row, x) in rows.iter().zip(moved) {
                    for (turned, entry) in turned.iter_mut().zip(row) {
                        *turned += x * entry;
                    }
                }
                &turned[..n]
            }
        };
        match self.basic {
            Basic::Sphere => sphere(z),
            Basic::Griewank => griewank(z),
            Basic::Rastrigin => rastrigin(z),
            Basic::Weierstrass => weierstrass.value(z),
            Basic::ExpandedGriewankRosenbrock => expanded_griewank_rosenbrock(z),
        }
    }
}
