//! Self-collision: a pleated cloth whose layers nearly touch in places.

use satisfice::catalogue::{Parameter, Params};

use super::{FeaturePairs, Prepared, Recipe};
use crate::error::Error;
use crate::generate;

const KINDS: [&str; 6] = [
    "triangle-triangle",
    "vertex-vertex",
    "vertex-edge",
    "vertex-triangle",
    "edge-edge",
    "edge-triangle",
];

/// A pleated cloth of length 3 and width 1 ([`generate::pleats`]): which of its features are closer than delta, except those
/// that share a vertex (vertices: an edge)?
///
/// ```
/// use satisfice::catalogue::{Catalogued, Params};
/// use satisfice_collision::problem::Pleats;
/// let few = Params::with(Pleats::PARAMETERS, Pleats::NAME, [("columns", "31"), ("rows", "9")])?;
/// let pleats = Pleats::from_params(&few)?;
/// assert_eq!(pleats.reference_hits(), Some(pleats.pairs().reference_pairs().len() as u64));
/// # Ok::<(), satisfice::Error>(())
/// ```
pub type Pleats = Prepared<PleatedCloth>;

/// The recipe of [`Pleats`].
#[derive(Debug, Clone, Copy)]
pub struct PleatedCloth;

impl Recipe for PleatedCloth {
    const NAME: &'static str = "pleats";
    const SUMMARY: &'static str = "self-collision: features of a pleated cloth that are closer than delta";
    const SOURCE: &'static str = "this project; after the cloths of Guy, Debunne 2004, INRIA RR-5136";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer(
            "columns",
            "vertices along the cloth, which is 3 long",
            91,
            2,
            4000,
        ),
        Parameter::integer("rows", "vertices across the cloth, which is 1 wide", 31, 2, 4000),
        Parameter::integer("layers", "layers that lie upon each other", 4, 1, 100),
        Parameter::real("gap", "mean distance of two layers", 0.05, 1e-6, 1.0),
        Parameter::real(
            "phase",
            "where the waves in the cloth are, in turns",
            0.0,
            -1e3,
            1e3,
        ),
        Parameter::choice("pairs", "which features make pairs", KINDS[0], &KINDS),
        Parameter::real("delta", "threshold of the distance", 0.01, 1e-12, 1e3),
    ];

    type Pairs = FeaturePairs;

    fn build(params: &Params) -> Result<FeaturePairs, Error> {
        let [columns, rows, layers] = ["columns", "rows", "layers"].map(|name| params.count(name));
        let cloth = generate::pleats(columns, rows, layers, params.real("gap"), params.real("phase"))?;
        let kind = params.text("pairs").parse()?;
        let ring_width = usize::from(kind == crate::distance::PairKind::VertexVertex);
        FeaturePairs::within(kind, &cloth, params.real("delta"), ring_width)
    }

    fn count(pairs: &FeaturePairs) -> u64 {
        pairs.exact_pairs().len() as u64
    }
}
