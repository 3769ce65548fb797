//! A problem with its parameters set, behind one virtual call per run.

use std::path::PathBuf;

use satisfice::SatisficingProblem;
use satisfice::catalogue::{Catalogued, ParamKind, Parameter, Params};
use satisfice_collision::VertexPairs;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::control::RunControl;
use crate::error::Error;
use crate::exact::{self, Geometric};
use crate::report::RunReport;
use crate::run::run;
use crate::settings::Settings;
use crate::spec::RunSpec;
use crate::verify::{self, Mismatch};

/// A problem of the catalogue with its parameters set. It is built once and can run any number of times, from any thread.
pub trait Instance: Send + Sync {
    /// Name of the problem.
    fn name(&self) -> &'static str;
    /// All its parameters.
    fn parameters(&self) -> &Settings;
    /// The files that it was read from: those that its parameters of [any text](ParamKind::Text) name.
    fn files(&self) -> Vec<PathBuf>;
    /// Runs `spec` on it, whatever problem `spec` names. The reference count is left open:
    /// [`RunReport::set_reference`].
    ///
    /// # Errors
    /// [`Error::Search`] for an unknown engine, a parameter out of range or a budget that cannot be used;
    /// [`Error::Exact`] for an exact method where [`is_geometric`](Self::is_geometric) is false; [`Error::Checkpoint`] and
    /// [`Error::Differs`] for a checkpoint that does not fit.
    fn run(&self, spec: &RunSpec, control: RunControl<'_>) -> Result<RunReport, Error>;
    /// Whether the [exact methods](crate::exact) run on it.
    fn is_geometric(&self) -> bool;
    /// The number of all hits, where it is known. May take long: call it outside any clock.
    fn reference_hits(&self) -> Option<u64>;
    /// Evaluates every solution of a report again and checks its counts; returns what does not fit, in the order of the
    /// report. `reference` is [`Instance::reference_hits`].
    fn verify(&self, report: &RunReport, reference: Option<u64>) -> Vec<Mismatch>;
}

/// A problem of which a run knows the solutions only: searches are compiled once for each type of solutions, not for each problem.
type AnyOf<P> = dyn SatisficingProblem<
        Scalar = <P as SatisficingProblem>::Scalar,
        Solution = <P as SatisficingProblem>::Solution,
    >;

/// The instance of a problem type.
struct Built<P> {
    problem: P,
    parameters: Settings,
    pairs: Option<fn(&P) -> &VertexPairs>,
}

/// Builds the instance with these parameters.
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
        parameters: params.texts().into_iter().collect(),
        pairs,
    }))
}

impl<P> Instance for Built<P>
where
    P: Catalogued + Send + 'static,
    P::Solution: Serialize + DeserializeOwned,
{
    fn name(&self) -> &'static str {
        P::NAME
    }

    fn parameters(&self) -> &Settings {
        &self.parameters
    }

    fn files(&self) -> Vec<PathBuf> {
        let is_text = |row: &&Parameter| matches!(row.kind, ParamKind::Text { .. });
        let texts = P::PARAMETERS.iter().filter(is_text);
        let given = texts.filter_map(|row| self.parameters.get(row.name)?.as_str());
        given.map(PathBuf::from).filter(|path| path.is_file()).collect()
    }

    fn run(&self, spec: &RunSpec, control: RunControl<'_>) -> Result<RunReport, Error> {
        let spec = RunSpec {
            problem: P::NAME.to_owned(),
            problem_parameters: self.parameters.clone(),
            ..spec.clone()
        };
        if exact::find(&spec.engine).is_none() {
            return run::<AnyOf<P>>(&self.problem, spec, control);
        }
        let pairs = self.pairs.ok_or_else(|| Error::Exact {
            method: spec.engine.clone(),
            problem: P::NAME,
        })?;
        exact::run(pairs(&self.problem), spec.complete()?)
    }

    fn is_geometric(&self) -> bool {
        self.pairs.is_some()
    }

    fn reference_hits(&self) -> Option<u64> {
        self.problem.reference_hits()
    }

    fn verify(&self, report: &RunReport, reference: Option<u64>) -> Vec<Mismatch> {
        let mut mismatches = verify::accounting(report);
        mismatches.extend(verify::solutions::<AnyOf<P>>(&self.problem, report));
        mismatches.extend(verify::reference(report, reference));
        mismatches
    }
}
