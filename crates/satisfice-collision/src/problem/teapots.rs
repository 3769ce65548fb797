//! Experiment I of the paper: two teapots that collide.

use satisfice::catalogue::{Parameter, Params};

use super::{Prepared, Recipe, VertexPairs};
use crate::error::Error;
use crate::generate;
use crate::mesh::Mesh;
use crate::order::VertexOrder;
use crate::placement::Placement;
use crate::sampling;

/// Two Utah teapots, the second moved along the longest extent of the first: which vertices are closer than delta?
///
/// Lengths are in units of the teapot's longest extent, its size.
///
/// ```
/// use satisfice::catalogue::{Catalogued, Params};
/// use satisfice_collision::problem::Teapots;
/// let few = Params::with(Teapots::PARAMETERS, Teapots::NAME, [("segments", "4"), ("samples", "200")])?;
/// let teapots = Teapots::from_params(&few)?;
/// assert_eq!(teapots.reference_hits(), Some(teapots.pairs().reference_pairs().len() as u64));
/// # Ok::<(), satisfice::Error>(())
/// ```
pub type Teapots = Prepared<TwoTeapots>;

/// The recipe of [`Teapots`].
#[derive(Debug, Clone, Copy)]
pub struct TwoTeapots;

impl Recipe for TwoTeapots {
    const NAME: &'static str = "teapots";
    const SUMMARY: &'static str = "vertex pairs of two colliding Utah teapots that are closer than delta";
    const SOURCE: &'static str =
        "Experiment I of Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539; teapot: M. Newell 1975";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer(
            "segments",
            "segments on every edge of a teapot's 32 patches",
            13,
            1,
            200,
        ),
        Parameter::integer(
            "samples",
            "vertices sampled from each teapot, 0 for all",
            5000,
            0,
            2_000_000,
        ),
        Parameter::choice(
            "sampling",
            "how vertices are sampled",
            "uniform",
            &["uniform", "area"],
        ),
        Parameter::integer(
            "sample-seed",
            "seed of the samples (the run's seed leaves them alone)",
            SAMPLE_SEED,
            0,
            i64::MAX,
        ),
        Parameter::real(
            "offset",
            "shift of the second teapot along its longest extent, in sizes",
            0.45,
            -1e3,
            1e3,
        ),
        Parameter::real(
            "rotation",
            "turn of the second teapot about the vertical axis, in degrees",
            0.0,
            -360.0,
            360.0,
        ),
        Parameter::real("delta", "threshold of the distance, in sizes", 0.02, 1e-12, 1e3),
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
        let first = generate::teapot(params.count("segments"))?;
        let size = first.size();
        let mut offset = [0.0; 3];
        offset[first.bounds().longest_axis()] = params.real("offset") * size;
        let turn = params.real("rotation");
        let placement = if turn == 0.0 {
            Placement::IDENTITY
        } else {
            Placement::from_axis_angle([0.0, 0.0, 1.0], turn.to_radians())?
        };
        let second = placement.moved(offset)?.place(&first)?;

        let [seed, order_seed] =
            ["sample-seed", "order-seed"].map(|name| params.integer(name).unsigned_abs());
        let order = |stream: u64| -> Result<VertexOrder, Error> {
            Ok(params
                .text("order")
                .parse::<VertexOrder>()?
                .with_seed(stream_seed(order_seed, stream)))
        };
        let pairs = VertexPairs::between(&first, &second, params.real("delta") * size)?;
        let pairs = match params.count("samples") {
            0 => pairs,
            count => {
                let draw = |mesh: &Mesh, stream| {
                    sample(mesh, count, params.text("sampling"), stream_seed(seed, stream))
                };
                pairs.with_vertices(&draw(&first, 0)?, &draw(&second, 1)?)?
            }
        };
        Ok(pairs.with_orders(order(0)?, order(1)?))
    }

    fn count(pairs: &VertexPairs) -> u64 {
        pairs.reference_pairs().len() as u64
    }
}

/// The seed of the sample in the recorded results.
const SAMPLE_SEED: i64 = 161;

/// The first body uses the seed itself, the second one a distant seed.
fn stream_seed(seed: u64, stream: u64) -> u64 {
    seed ^ stream.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

fn sample(mesh: &Mesh, count: usize, how: &str, seed: u64) -> Result<Vec<u32>, Error> {
    let total = mesh.vertices().len() as u32;
    let count = u32::try_from(count).unwrap_or(u32::MAX);
    let chosen = if how == "area" {
        sampling::vertices_by_area(mesh, count, seed)
    } else {
        sampling::uniform_vertices(total, count, seed)
    };
    // The sample is the one parameter whose range depends on another.
    chosen.map_err(|error| match error {
        Error::Parameter {
            parameter: "sample size",
            value,
            allowed,
        } => Error::Parameter {
            parameter: "samples",
            value,
            allowed,
        },
        other => other,
    })
}
