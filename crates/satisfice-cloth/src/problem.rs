//! The cloth as a satisficing problem: one frame of its fall.

use satisfice::catalogue::{Parameter, Params};
use satisfice_collision::problem::{Prepared, Recipe};
use satisfice_collision::{Error, VertexOrder, VertexPairs};

use crate::settings::Settings;
use crate::simulation::Simulation;

/// Which particles of a falling cloth are closer than delta to each other, or to vertices of the sphere?
///
/// The cloth has fallen for `frame` sixtieths of a second by [`Simulation`], with all its contacts. delta is in spacings of
/// the cloth at rest. Particles joined by an edge of the mesh are not a pair.
pub type Cloth = Prepared<FallenCloth>;

/// The parameters of [`Cloth`].
#[derive(Debug, Clone, Copy)]
pub struct FallenCloth;

impl Recipe for FallenCloth {
    const NAME: &'static str = "cloth";
    const SUMMARY: &'static str =
        "vertex pairs closer than delta of a cloth that falls on a sphere, with itself or the sphere";
    const SOURCE: &'static str = "Experiment II of Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539; simulated after Macklin et al. 2019, doi 10.1145/3309486.3340247";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("columns", "particles on each side of the cloth", 128, 4, 1024),
        Parameter::integer(
            "frame",
            "sixtieths of a second that it has fallen",
            40,
            0,
            100_000,
        ),
        Parameter::choice(
            "pairs",
            "the cloth with itself, or with the sphere",
            "self",
            &["self", "sphere"],
        ),
        Parameter::real(
            "delta",
            "threshold of the distance, in spacings of the cloth",
            0.95,
            1e-9,
            1e6,
        ),
        Parameter::choice(
            "order",
            "vertex order: which index a vertex gets",
            "hilbert",
            &VertexOrder::NAMES,
        ),
        Parameter::integer("order-seed", "seed of the random order", 1, 0, i64::MAX),
    ];

    type Pairs = VertexPairs;

    fn build(params: &Params) -> Result<VertexPairs, Error> {
        let columns = u32::try_from(params.count("columns")).unwrap_or(u32::MAX);
        let settings = Settings {
            columns,
            ..Settings::default()
        };
        let mut cloth = Simulation::new(&settings)?;
        for _ in 0..params.count("frame") {
            cloth.frame()?;
        }
        let delta = params.real("delta") * settings.spacing();
        let pairs = if params.text("pairs") == "sphere" {
            VertexPairs::between(&cloth.mesh()?, cloth.sphere(), delta)?
        } else {
            VertexPairs::within(&cloth.mesh()?, delta, 1)?
        };
        let order = params
            .text("order")
            .parse::<VertexOrder>()?
            .with_seed(params.integer("order-seed").unsigned_abs());
        Ok(pairs.with_orders(order, order))
    }

    fn count(pairs: &VertexPairs) -> u64 {
        pairs.reference_pairs().len() as u64
    }
}
