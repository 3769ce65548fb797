//! What all problems of pairs that a catalogue makes from parameters have in common.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Bounds, Encoding, Neighbourhood};
use satisfice::{Error, SatisficingProblem, Space};

/// How to make a scene and a question about it from parameters; [`Prepared`] makes it a problem.
pub trait Recipe {
    /// [`Catalogued::NAME`].
    const NAME: &'static str;
    /// [`Catalogued::SUMMARY`].
    const SUMMARY: &'static str;
    /// [`Catalogued::SOURCE`].
    const SOURCE: &'static str;
    /// [`Catalogued::PARAMETERS`].
    const PARAMETERS: &'static [Parameter];

    /// The question.
    type Pairs: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>;

    /// The question about the scene of these parameters, which are within their ranges.
    ///
    /// # Errors
    /// [`crate::Error`] if values contradict each other.
    fn build(params: &Params) -> Result<Self::Pairs, crate::Error>;

    /// The exact number of hits.
    fn count(pairs: &Self::Pairs) -> u64;
}

/// A problem of pairs made by a [`Recipe`]. It keeps the parameters that it was made from.
#[derive(Debug, Clone)]
pub struct Prepared<R: Recipe> {
    pairs: R::Pairs,
    parameters: Vec<(String, String)>,
}

impl<R: Recipe> Prepared<R> {
    /// The problem itself, with its meshes.
    #[must_use]
    pub fn pairs(&self) -> &R::Pairs {
        &self.pairs
    }

    /// The problem itself, for moving its meshes.
    pub fn pairs_mut(&mut self) -> &mut R::Pairs {
        &mut self.pairs
    }
}

impl<R: Recipe> Catalogued for Prepared<R> {
    const NAME: &'static str = R::NAME;
    const SUMMARY: &'static str = R::SUMMARY;
    const SOURCE: &'static str = R::SOURCE;
    const PARAMETERS: &'static [Parameter] = R::PARAMETERS;

    fn from_params(params: &Params) -> Result<Self, Error> {
        let pairs = R::build(params).map_err(|error| match error {
            crate::Error::Parameter {
                parameter,
                value,
                allowed,
            } => Error::parameter(parameter, value, allowed),
            other => Error::parameter(R::NAME, other, "values that give finite coordinates"),
        })?;
        Ok(Self {
            pairs,
            parameters: params.texts(),
        })
    }

    fn reference_hits(&self) -> Option<u64> {
        Some(R::count(&self.pairs))
    }
}

impl<R: Recipe> SatisficingProblem for Prepared<R> {
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
    fn decode_into(&self, values: &[f64], solution: &mut (u32, u32)) {
        self.pairs.decode_into(values, solution);
    }
    #[inline]
    fn fitness(&self, solution: &(u32, u32)) -> f64 {
        self.pairs.fitness(solution)
    }
    fn fitness_all(&self, solutions: &[(u32, u32)], fitness: &mut [f64]) {
        self.pairs.fitness_all(solutions, fitness);
    }
    fn threshold(&self) -> f64 {
        self.pairs.threshold()
    }
    fn canonical(&self, hit: &(u32, u32)) -> Option<(u32, u32)> {
        self.pairs.canonical(hit)
    }
    fn description(&self) -> Description {
        Description {
            name: R::NAME.to_owned(),
            parameters: self.parameters.clone(),
        }
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, (u32, u32)>> {
        self.pairs.encoding()
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<(u32, u32)>> {
        self.pairs.neighbourhood()
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        self.pairs.bounds()
    }
}
