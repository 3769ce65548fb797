//! The cloth as a satisficing problem: one frame of its fall.

use satisfice::{Catalogued, Description, Error, Parameter, Region, SatisficingProblem, Space, Values};
use satisfice_collision::{VertexOrder, VertexPairs};

use crate::simulation::{Settings, Simulation};

/// Which particles of a falling cloth are closer than delta to each other, or to vertices of the sphere?
///
/// The cloth has fallen for `frame` sixtieths of a second by [`Simulation`], with all its contacts. delta is in spacings of
/// the cloth at rest. Particles that an edge of the mesh joins are no pair.
#[derive(Debug, Clone)]
pub struct Cloth {
    pairs: VertexPairs,
    parameters: Vec<(String, String)>,
}

impl Cloth {
    /// The problem itself, with its meshes.
    #[must_use]
    pub fn pairs(&self) -> &VertexPairs {
        &self.pairs
    }

    fn build(values: &Values) -> Result<VertexPairs, satisfice_collision::Error> {
        let columns = u32::try_from(values.count("columns")).unwrap_or(u32::MAX);
        let settings = Settings {
            columns,
            ..Settings::default()
        };
        let mut cloth = Simulation::new(&settings)?;
        for _ in 0..values.count("frame") {
            cloth.frame()?;
        }
        let delta = values.real("delta") * settings.spacing();
        let pairs = if values.text("pairs") == "sphere" {
            VertexPairs::between(&cloth.mesh()?, cloth.sphere(), delta)?
        } else {
            VertexPairs::within(&cloth.mesh()?, delta, 1)?
        };
        let order = values
            .text("order")
            .parse::<VertexOrder>()?
            .with_seed(values.integer("order-seed").unsigned_abs());
        Ok(pairs.with_orders(order, order))
    }
}

impl Catalogued for Cloth {
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
            "vertex order: which serial number a vertex gets",
            "hilbert",
            &VertexOrder::NAMES,
        ),
        Parameter::integer("order-seed", "seed of the random order", 1, 0, i64::MAX),
    ];

    fn from_values(values: &Values) -> Result<Self, Error> {
        let pairs = Self::build(values)
            .map_err(|error| Error::parameter("cloth", error, "values that give finite coordinates"))?;
        Ok(Self {
            pairs,
            parameters: values.texts(),
        })
    }

    fn reference_hits(&self) -> Option<u64> {
        Some(self.pairs.reference_pairs().len() as u64)
    }
}

impl SatisficingProblem for Cloth {
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
