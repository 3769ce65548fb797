//! Self-collision: a cloth laid in pleats, whose layers touch here and there.

use satisfice::{Catalogued, Description, Error, Parameter, Region, SatisficingProblem, Space, Values};

use super::FeaturePairs;
use crate::generate;

const KINDS: [&str; 6] = [
    "triangle-triangle",
    "vertex-vertex",
    "vertex-edge",
    "vertex-triangle",
    "edge-edge",
    "edge-triangle",
];

/// A cloth 3 long and 1 wide, laid in pleats ([`generate::pleats`]): which of its features are closer than delta, those that share
/// a vertex (of vertices: an edge) left out?
///
/// ```
/// use satisfice::{Catalogued, Values};
/// use satisfice_collision::problem::Pleats;
/// let few = Values::with(Pleats::PARAMETERS, Pleats::NAME, [("columns", "31"), ("rows", "9")])?;
/// let pleats = Pleats::from_values(&few)?;
/// assert_eq!(pleats.reference_hits(), Some(pleats.pairs().reference_pairs().len() as u64));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Pleats {
    pairs: FeaturePairs,
    parameters: Vec<(String, String)>,
}

impl Pleats {
    /// The problem itself, with its mesh.
    #[must_use]
    pub fn pairs(&self) -> &FeaturePairs {
        &self.pairs
    }

    fn build(values: &Values) -> Result<FeaturePairs, crate::Error> {
        let [columns, rows, layers] = ["columns", "rows", "layers"].map(|name| values.count(name));
        let cloth = generate::pleats(columns, rows, layers, values.real("gap"), values.real("phase"))?;
        let kind = values.text("pairs").parse()?;
        let ring_width = usize::from(kind == crate::distance::PairKind::VertexVertex);
        FeaturePairs::within(kind, &cloth, values.real("delta"), ring_width)
    }
}

impl Catalogued for Pleats {
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

    fn from_values(values: &Values) -> Result<Self, Error> {
        let pairs = Self::build(values).map_err(|error| match error {
            crate::Error::Parameter {
                parameter,
                value,
                allowed,
            } => Error::parameter(parameter, value, allowed),
            other => Error::parameter("pleats", other, "values that give finite coordinates"),
        })?;
        Ok(Self {
            pairs,
            parameters: values.texts(),
        })
    }

    fn reference_hits(&self) -> Option<u64> {
        Some(self.pairs.exact_pairs().len() as u64)
    }
}

impl SatisficingProblem for Pleats {
    type Scalar = f64;
    type Solution = (u32, u32);

    fn space(&self) -> &Space<f64> {
        self.pairs.space()
    }
    #[inline]
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        self.pairs.decode(values)
    }
    #[inline]
    fn fitness(&self, solution: &(u32, u32)) -> f64 {
        self.pairs.fitness(solution)
    }
    fn threshold(&self) -> f64 {
        self.pairs.threshold()
    }
    fn encode(&self, solution: &(u32, u32), values: &mut [f64]) -> bool {
        self.pairs.encode(solution, values)
    }
    fn neighbours(&self, of: &(u32, u32), visit: &mut dyn FnMut((u32, u32))) -> bool {
        self.pairs.neighbours(of, visit)
    }
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        self.pairs.lower_bound(region)
    }
    fn canonical(&self, hit: (u32, u32)) -> (u32, u32) {
        self.pairs.canonical(hit)
    }
    fn description(&self) -> Description {
        Description {
            name: Self::NAME.to_owned(),
            parameters: self.parameters.clone(),
        }
    }
}
