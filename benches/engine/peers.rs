//! argmin's particle swarm and ours, on a cheap continuous problem in two variables.

use argmin::core::{CostFunction, Executor};
use argmin::solver::particleswarm::ParticleSwarm;
use rand_xoshiro_07::Xoshiro256PlusPlus;
use rand_xoshiro_07::rand_core::SeedableRng;
use satisfice::{Budget, Search, Space, engine, from_fn};

/// Himmelblau's function, on [-6, 6]^2: the cheap problem in two continuous variables.
fn himmelblau(x: &[f64]) -> f64 {
    let (a, b) = (x[0] * x[0] + x[1] - 11.0, x[0] + x[1] * x[1] - 7.0);
    a * a + b * b
}

struct Himmelblau;

impl CostFunction for Himmelblau {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        Ok(himmelblau(x))
    }
}

const PARTICLES: usize = 40;
const SWEEPS: usize = 500;
/// What a run evaluates.
pub(crate) const EVALUATIONS: usize = PARTICLES * (SWEEPS + 1);

/// argmin's swarm, set up as its documentation does, with a generator as fast as ours. It counts nothing and keeps the best
/// point only.
pub(crate) fn argmin_swarm() -> f64 {
    let rng = Xoshiro256PlusPlus::seed_from_u64(7);
    let solver = ParticleSwarm::new((vec![-6.0, -6.0], vec![6.0, 6.0]), PARTICLES).with_rng_generator(rng);
    let result = Executor::new(Himmelblau, solver)
        .configure(|state| state.max_iters(SWEEPS as u64))
        .run()
        .unwrap();
    result.state.get_best_cost()
}

/// Constriction PSO with as many particles and evaluations, one at a time or a sweep at once.
pub(crate) fn our_swarm(batch: &str) -> usize {
    let problem = from_fn(Space::cube(2, -6.0, 6.0).unwrap(), 1e-2, himmelblau).separation(0.5);
    let particles = PARTICLES.to_string();
    let settings = [("particles", particles.as_str()), ("batch", batch)];
    let engine = engine::find("pso").unwrap().configure(settings).unwrap();
    let budget = Budget::evaluations(EVALUATIONS as u64);
    let report = Search::with(engine).seed(7).run(&problem, &budget).unwrap();
    report.hit_count()
}
