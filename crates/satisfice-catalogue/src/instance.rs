//! A problem with its parameters set, behind one virtual call a run.

use satisfice::catalogue::{Catalogued, Params};
use satisfice_collision::VertexPairs;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Error;
use crate::exact::{self, Geometric};
use crate::record::Record;
use crate::resume::{Keeping, Saved};
use crate::run::{Progress, Request, search, search_keeping};
use crate::settings::Settings;
use crate::verify::{self, Mismatch};

/// A problem of the catalogue with its parameters set. Built once, run as often as wanted, from any thread.
pub trait Instance: Send + Sync {
    /// Name of the problem.
    fn name(&self) -> &'static str;
    /// All its parameters.
    fn parameters(&self) -> &Settings;
    /// Runs an engine on it; as [`search`], which see. The reference count is left open.
    ///
    /// # Errors
    /// As [`search`].
    fn run(&self, request: &Request, watch: &mut dyn FnMut(&Progress)) -> Result<Record, Error>;
    /// The same while checkpoints are kept, or from one on.
    ///
    /// # Errors
    /// As [`search`], and [`Error::Checkpoint`] and [`Error::Other`] for a checkpoint that does not fit.
    fn run_keeping(
        &self,
        request: &Request,
        watch: &mut dyn FnMut(&Progress),
        keeping: Keeping<'_>,
    ) -> Result<Record, Error>;
    /// Whether [`Instance::exact`] works.
    fn is_geometric(&self) -> bool {
        false
    }
    /// Runs one of [`crate::exact::METHODS`] on it, for problems of vertex pairs.
    ///
    /// # Errors
    /// [`Error::Exact`] for a problem that is none.
    fn exact(&self, request: &Request) -> Result<Record, Error> {
        Err(Error::Exact {
            method: request.engine.clone(),
            problem: self.name(),
        })
    }
    /// How many distinct hits there are, where that is known. May take long: call it outside any clock.
    fn reference_hits(&self) -> Option<u64>;
    /// Evaluates every solution of a record anew and checks its books; what does not fit, in the order of the record.
    /// `reference` is [`Instance::reference_hits`].
    fn verify(&self, record: &Record, reference: Option<u64>) -> Vec<Mismatch>;
}

/// The instance of a problem type.
struct Built<P> {
    problem: P,
    parameters: Settings,
    pairs: Option<fn(&P) -> &VertexPairs>,
}

/// Builds the instance with these values.
pub(crate) fn build<P>(params: &Params) -> Result<Box<dyn Instance>, Error>
where
    P: Catalogued + Send + 'static,
    P::Solution: Serialize + DeserializeOwned,
{
    build_with::<P>(params, None)
}

/// The same for a problem of vertex pairs.
pub(crate) fn build_geometric<P: Geometric + Send + 'static>(
    params: &Params,
) -> Result<Box<dyn Instance>, Error> {
    build_with::<P>(params, Some(P::vertex_pairs))
}

fn build_with<P>(params: &Params, pairs: Option<fn(&P) -> &VertexPairs>) -> Result<Box<dyn Instance>, Error>
where
    P: Catalogued + Send + 'static,
    P::Solution: Serialize + DeserializeOwned,
{
    Ok(Box::new(Built {
        problem: P::from_params(params)?,
        parameters: Settings::typed(&params.texts(), P::PARAMETERS),
        pairs,
    }))
}

impl<P> Instance for Built<P>
where
    P: Catalogued + Send,
    P::Solution: Serialize + DeserializeOwned,
{
    fn name(&self) -> &'static str {
        P::NAME
    }

    fn parameters(&self) -> &Settings {
        &self.parameters
    }

    fn run(&self, request: &Request, watch: &mut dyn FnMut(&Progress)) -> Result<Record, Error> {
        Ok(Record {
            problem: P::NAME.to_owned(),
            problem_parameters: self.parameters.clone(),
            ..search(&self.problem, request, watch)?
        })
    }

    fn run_keeping(
        &self,
        request: &Request,
        watch: &mut dyn FnMut(&Progress),
        keeping: Keeping<'_>,
    ) -> Result<Record, Error> {
        let asked = Saved::new(P::NAME, &self.parameters, request);
        Ok(Record {
            problem: P::NAME.to_owned(),
            problem_parameters: self.parameters.clone(),
            ..search_keeping(&self.problem, request, watch, asked, keeping)?
        })
    }

    fn is_geometric(&self) -> bool {
        self.pairs.is_some()
    }

    fn exact(&self, request: &Request) -> Result<Record, Error> {
        let Some(pairs) = self.pairs else {
            return Err(Error::Exact {
                method: request.engine.clone(),
                problem: self.name(),
            });
        };
        Ok(Record {
            problem: P::NAME.to_owned(),
            problem_parameters: self.parameters.clone(),
            ..exact::run(pairs(&self.problem), request)?
        })
    }

    fn reference_hits(&self) -> Option<u64> {
        self.problem.reference_hits()
    }

    fn verify(&self, record: &Record, reference: Option<u64>) -> Vec<Mismatch> {
        let mut mismatches = verify::books(record);
        mismatches.extend(verify::solutions(&self.problem, record));
        mismatches.extend(verify::reference(record, reference));
        mismatches
    }
}
