//! Periodic points of Hénon's map: isolated roots of a coupled map, or of a steep one by shooting.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Components, Encoding, Error, Located, Region, SatisficingProblem, SearchRng, Space};

use crate::lattice::description;

/// Longest period: all 2^n roots are kept.
const LONGEST: usize = 12;
/// Share by which the box exceeds the largest root can be.
const MARGIN: f64 = 1.05;
/// A root is approached until it no longer moves; it halves its error at least 2^-60 times before.
const STEPS: usize = 2_000;
const UNKNOWNS: &[&str] = &["orbit", "start"];

/// All points of period n of Hénon's map, whose parameter may differ from step to step:
///
/// x_(k+1) = a_k - x_k^2 - b x_(k-1), x_(k+n) = x_k.
///
/// With `unknowns = orbit` the n values of a cycle are the unknowns, and F is the norm of the n residuals: a coupled system
/// with isolated roots. With `unknowns = start` they are x_0 and x_1, and F is the distance by which the orbit misses its start
/// after n steps (shooting): the same roots in two dimensions, of a function whose slope grows like 5^n. A hit is F < delta, and it
/// becomes the root with the same signs.
///
/// **There are 2^n roots**, one for each sequence of signs. With c = 1 + |b| all roots lie in [-R, R]^n,
/// R = (c + sqrt(c^2 + 4 max a)) / 2, and x_k = s_k sqrt(a_k - x_(k+1) - b x_(k-1)) maps that box into itself for all signs s;
/// where min a - c R > c^2 / 4 it contracts distances in the maximum norm, so that it has one fixed point. [`PeriodicPoints::new`]
/// refuses other parameters.
///
/// Source: Hénon 1976, doi 10.1007/BF01608556; the horseshoe of Devaney, Nitecki 1979, doi 10.1007/BF01221362; roots from sequences of
/// signs as in Biham, Wenzel 1989, doi 10.1103/PhysRevLett.63.819.
///
/// ```
/// use satisfice::{Budget, Search};
/// use satisfice_problems::PeriodicPoints;
/// let cycles = PeriodicPoints::new(3, false, (6.0, 0.3), 0.5, 0.1, 1)?;
/// let report = Search::new().run(&cycles, &Budget::evaluations(20_000))?;
/// assert_eq!((report.hit_count(), cycles.roots().count()), (8, 8));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct PeriodicPoints {
    space: Space<f64>,
    threshold: f64,
    description: Description,
    /// a_k.
    forcing: Vec<f64>,
    b: f64,
    shoots: bool,
    /// The cycles, n values each; number i has a positive x_k where bit k of i is set.
    cycles: Vec<f64>,
    separation: f64,
}

impl PeriodicPoints {
    /// Period `period`, `shoots` for two unknowns, parameters `(a, b)`, of which a_k is uniform in `[a, a + spread]` by
    /// `instance`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a period of 0 or above 12, a number that is not finite, a threshold that is not positive, and parameters
    /// for which the number of roots is not known.
    pub fn new(
        period: usize,
        shoots: bool,
        (a, b): (f64, f64),
        spread: f64,
        threshold: f64,
        instance: u64,
    ) -> Result<Self, Error> {
        if !(1..=LONGEST).contains(&period) {
            let allowed = format!("a whole number from 1 to {LONGEST}");
            return Err(Error::parameter("period", period, allowed));
        }
        if !(threshold > 0.0 && threshold.is_finite()) {
            return Err(Error::parameter(
                "threshold",
                threshold,
                "a finite number above 0",
            ));
        }
        if !(spread >= 0.0 && spread.is_finite()) {
            return Err(Error::parameter("spread", spread, "a finite number from 0 on"));
        }
        let mut rng = SearchRng::new(instance);
        let forcing: Vec<f64> = (0..period).map(|_| a + spread * rng.uniform()).collect();
        let coupling = 1.0 + b.abs();
        let largest = f64::midpoint(
            coupling,
            (coupling * coupling + 4.0 * (a + spread).max(0.0)).sqrt(),
        );
        let contracts = a - coupling * largest > coupling * coupling / 4.0;
        if !contracts || !largest.is_finite() {
            let allowed = format!(
                "large enough beside b and the spread to know the roots, such as {}",
                4.0 * coupling * coupling + spread
            );
            return Err(Error::parameter("a", a, allowed));
        }
        let side = MARGIN * largest;
        let mut problem = Self {
            space: Space::cube(if shoots { 2 } else { period }, -side, side)?,
            threshold,
            description: description(
                Self::NAME,
                [
                    ("period", period.to_string()),
                    ("unknowns", UNKNOWNS[usize::from(shoots)].to_owned()),
                    ("a", a.to_string()),
                    ("b", b.to_string()),
                    ("spread", spread.to_string()),
                    ("threshold", threshold.to_string()),
                    ("instance", instance.to_string()),
                ],
            ),
            forcing,
            b,
            shoots,
            cycles: Vec::new(),
            separation: 0.0,
        };
        problem.cycles = (0..1 << period)
            .flat_map(|signs| problem.cycle(signs, largest))
            .collect();
        problem.separation = problem.least_distance() / 2.0;
        Ok(problem)
    }

    /// The roots, as points of the space.
    pub fn roots(&self) -> impl ExactSizeIterator<Item = Vec<f64>> {
        self.cycles
            .chunks_exact(self.forcing.len())
            .map(|cycle| self.unknowns(cycle))
    }

    /// The unknowns of a cycle.
    fn unknowns(&self, cycle: &[f64]) -> Vec<f64> {
        if self.shoots {
            vec![cycle[0], cycle[1 % cycle.len()]]
        } else {
            cycle.to_vec()
        }
    }

    /// The fixed point for these signs, by bits.
    fn cycle(&self, signs: usize, largest: f64) -> Vec<f64> {
        let n = self.forcing.len();
        let mut x: Vec<f64> = vec![0.0; n];
        let mut before = x.clone();
        for _ in 0..STEPS {
            before.copy_from_slice(&x);
            for k in 0..n {
                let square = self.forcing[k] - before[(k + 1) % n] - self.b * before[(k + n - 1) % n];
                let root = square.max(0.0).sqrt().min(largest);
                x[k] = if signs >> k & 1 == 1 { root } else { -root };
            }
            if x == before {
                break;
            }
        }
        x
    }

    /// The least distance of two roots; that of the box's corners where there is one root only.
    fn least_distance(&self) -> f64 {
        let roots: Vec<Vec<f64>> = self.roots().collect();
        let mut least = self.space.axes()[0].width();
        // Sorted by the first unknown, only a few others are near enough to matter.
        let mut order: Vec<&Vec<f64>> = roots.iter().collect();
        order.sort_by(|p, q| p[0].total_cmp(&q[0]));
        for (i, p) in order.iter().enumerate() {
            for q in &order[i + 1..] {
                if q[0] - p[0] >= least {
                    break;
                }
                let square: f64 = p.iter().zip(*q).map(|(p, q)| (p - q).powi(2)).sum();
                least = square.sqrt().min(least);
            }
        }
        least
    }

    /// The norm of the residuals of a cycle.
    fn residual(&self, x: &[f64]) -> f64 {
        let residual = |k| self.residual_at(x, k);
        (0..x.len()).map(residual).map(|e| e * e).sum::<f64>().sqrt()
    }

    fn residual_at(&self, x: &[f64], k: usize) -> f64 {
        let n = x.len();
        x[(k + 1) % n] + self.b * x[(k + n - 1) % n] + x[k] * x[k] - self.forcing[k]
    }

    /// Visits x_0, x_1 … x_(n+1) of the orbit that starts with x_0 and x_1.
    fn shoot(&self, start: &[f64], mut visit: impl FnMut(f64)) -> [f64; 2] {
        let (mut last, mut now) = (start[0], start[1]);
        let n = self.forcing.len();
        visit(last);
        for k in 1..=n {
            visit(now);
            let next = self.forcing[k % n] - now * now - self.b * last;
            (last, now) = (now, next);
        }
        [last, now]
    }

    /// Number of the root with the signs of a point.
    fn root_of(&self, point: &[f64]) -> usize {
        let (mut signs, mut bit) = (0, 0);
        let mut add = |x: f64| {
            if bit < self.forcing.len() {
                signs |= usize::from(x > 0.0) << bit;
                bit += 1;
            }
        };
        if self.shoots {
            self.shoot(point, &mut add);
        } else {
            point.iter().copied().for_each(&mut add);
        }
        signs
    }
}

/// The residuals, by the threshold.
impl Components<f64, Located<f64>> for PeriodicPoints {
    fn count(&self) -> usize {
        self.space.dimension()
    }

    fn write(&self, solution: &Located<f64>, components: &mut [f64]) {
        let x = &solution.coordinates;
        if x.len() != self.space.dimension() {
            return components.fill(f64::NAN);
        }
        if self.shoots {
            let [last, now] = self.shoot(x, |_| {});
            components.copy_from_slice(&[last - x[0], now - x[1]]);
        } else {
            for (k, component) in components.iter_mut().enumerate() {
                *component = self.residual_at(x, k);
            }
        }
        components
            .iter_mut()
            .for_each(|component| *component /= self.threshold);
    }
}

impl SatisficingProblem for PeriodicPoints {
    type Scalar = f64;
    type Solution = Located<f64>;

    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, self.separation)
    }
    fn decode_into(&self, values: &[f64], solution: &mut Located<f64>) {
        solution.set(values, &self.separation.into());
    }
    fn fitness(&self, solution: &Located<f64>) -> f64 {
        let x = &solution.coordinates;
        if x.len() != self.space.dimension() {
            f64::NAN
        } else if self.shoots {
            let [last, now] = self.shoot(x, |_| {});
            (last - x[0]).hypot(now - x[1])
        } else {
            self.residual(x)
        }
    }
    fn components(&self) -> Option<&dyn Components<f64, Located<f64>>> {
        Some(self)
    }
    fn threshold(&self) -> f64 {
        self.threshold
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Located<f64>>> {
        Some(self)
    }
    fn canonical(&self, hit: &Located<f64>) -> Option<Located<f64>> {
        let root = self.root_of(&hit.coordinates);
        let n = self.forcing.len();
        let root = self.decode(&self.unknowns(&self.cycles[root * n..(root + 1) * n]));
        (self.fitness(&root) < self.threshold).then_some(root)
    }
    fn description(&self) -> Description {
        self.description.clone()
    }
}

impl Encoding<f64, Located<f64>> for PeriodicPoints {
    fn encode(&self, solution: &Located<f64>, values: &mut [f64]) -> bool {
        let fits = solution.coordinates.len() == values.len() && self.space.contains(&solution.coordinates);
        if fits {
            values.copy_from_slice(&solution.coordinates);
        }
        fits
    }
    fn covers(&self, hit: &Located<f64>, region: &Region<f64>) -> bool {
        hit.covers(region)
    }
}

impl Catalogued for PeriodicPoints {
    const NAME: &'static str = "periodic-points";
    const SUMMARY: &'static str =
        "all cycles of Hénon's map: isolated roots of a coupled system, or of a steep one by shooting";
    const SOURCE: &'static str = "Hénon 1976, doi 10.1007/BF01608556; 2^period roots by a contraction";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("period", "period n: 2^n roots", 6, 1, LONGEST as i64),
        Parameter::choice(
            "unknowns",
            "the whole orbit, n unknowns; or its start, 2 unknowns, by shooting",
            "orbit",
            UNKNOWNS,
        ),
        Parameter::real("a", "the map's parameter", 6.0, 0.0, 1e6),
        Parameter::real("b", "the map's contraction of areas", 0.3, -1.0, 1.0),
        Parameter::real("spread", "by how much a differs from step to step", 0.0, 0.0, 1e6),
        Parameter::real("threshold", "level of F, delta", 0.01, 1e-6, 10.0),
        Parameter::integer("instance", "which values of a", 0, 0, i64::MAX),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.count("period"),
            params.text("unknowns") == "start",
            (params.real("a"), params.real("b")),
            params.real("spread"),
            params.real("threshold"),
            params.count("instance") as u64,
        )
    }

    fn reference_hits(&self) -> Option<u64> {
        Some(self.roots().len() as u64)
    }
}
