//! A search saved as plain data.

use core::time::Duration;
use std::sync::Arc;

use super::Search;
use super::kept::KeptSearch;
use super::lanes::LanesProgress;
use super::running::Running;
use super::slice::Slice;
use super::tickets::SavedTickets;
use crate::accounting::Unlisted;
use crate::archive::packed::Packable;
use crate::archive::{Archive, packed};
use crate::best::Best;
use crate::budget::{Budget, StopReason};
use crate::catalogue::Description;
use crate::engine::WarmStart;
use crate::error::Error;
use crate::identity::Identity;
use crate::problem::{AnyProblem, SatisficingProblem};
use crate::report::{Counts, TracePoint};
use crate::scalar::Real;
use crate::space::{AxisKind, Boundary};
use crate::state::{Saved, State};

/// A search at one moment: [`Search::resume`] continues from it, with the same results but for the times.
///
/// It is taken between slices ([`Search::checkpoint`]), while a batch is out ([`Stepper::checkpoint`](super::Stepper)), or
/// while a slice runs ([`RunOptions::checkpoints`](super::RunOptions::checkpoints)). It can be written and
/// read with serde; numbers are kept bit by bit, and a checksum over all of it detects damage. With `serde_json` enable the
/// feature `float_roundtrip`: without it, some numbers are read back one bit off, and the checkpoint counts as damaged.
#[derive(Debug, Clone)]
pub struct Checkpoint<T> {
    /// What was saved.
    pub contents: Contents<T>,
}

/// What a [`Checkpoint`] holds.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(bound = "T: serde::Serialize + serde::de::DeserializeOwned + Identity")]
pub struct Contents<T> {
    /// The version of this crate; another version is refused, since its results may differ.
    pub version: String,
    /// `f32` or `f64`.
    pub scalar: String,
    /// The engine and its parameters.
    pub engine: Description,
    /// The problem of the slice that began last.
    pub problem: Option<Fingerprint>,
    /// The seed.
    pub seed: u64,
    /// The number of lanes.
    pub islands: usize,
    /// The rule of warm starts, if one was set.
    pub warm_start: Option<WarmStart>,
    /// The share of probes, if one was set.
    pub probes: Option<f64>,
    /// Points that the next slice evaluates first.
    pub starts: Vec<Vec<f64>>,
    /// How many slices have ended.
    pub slices: u64,
    /// Number of axes, once a slice has begun.
    pub dimension: Option<usize>,
    /// The hits of the slice that ended last.
    #[serde(with = "packed")]
    pub previous: Arc<Archive<T>>,
    /// The slice that has begun and not ended: the one that will be reported.
    pub unfinished: Option<Unfinished<T>>,
    /// Random numbers and engine of each lane; none if all are as new.
    pub(super) lanes: Vec<State>,
    /// Tickets that were out, if the slice had some.
    #[serde(default = "Option::default")]
    pub(super) tickets: Option<SavedTickets<T>>,
    /// The slices of several lanes, and how far they are.
    pub(super) exchange: Option<(Vec<Unfinished<T>>, LanesProgress)>,
}

/// A slice that has begun and not ended.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(bound = "T: serde::Serialize + serde::de::DeserializeOwned + Identity")]
pub struct Unfinished<T> {
    /// Its budget, without the cancellation.
    pub budget: Budget,
    /// Time so far.
    pub elapsed: Duration,
    /// Counts so far.
    pub counts: Counts,
    /// The trace so far.
    pub trace: Vec<TracePoint>,
    /// Why it has ended, if it has only to be reported. Never a cancellation: that is what is resumed from.
    pub stop: Option<StopReason>,
    /// The hits so far; of one lane of several, those since the last exchange.
    #[serde(with = "packed")]
    pub archive: Archive<T>,
    /// Of a lane that is sent by itself, the hits as of the last exchange.
    #[serde(with = "packed")]
    pub(super) listed: Arc<Archive<T>>,
    /// The least fitness so far, and where.
    pub best: Option<Best<T>>,
    /// The number of hits, to detect an incomplete list.
    pub(super) hits: u64,
    /// Hits that only probes have found, by index.
    pub(super) probe_only: Vec<u32>,
    /// What the other lanes do not know of this one.
    pub(super) unlisted: Option<Unlisted<T>>,
    pub(super) state: State,
}

/// What identifies a problem: its description, its space, its threshold and the number of components of F.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Fingerprint {
    /// Its name and parameters.
    pub description: Description,
    /// The bits of delta, and of each axis with its kind.
    threshold: u64,
    axes: Vec<(u64, u64, AxisKind, [bool; 2])>,
    boundary: Boundary,
    components: usize,
}

impl Fingerprint {
    pub(super) fn of<S: Real, T: Identity + Clone + Send + Sync>(problem: &AnyProblem<'_, S, T>) -> Self {
        let axes = problem.space().axes().iter();
        Self {
            description: problem.description(),
            threshold: problem.threshold().to_word(),
            boundary: problem.space().boundary(),
            components: problem
                .components()
                .map_or(0, crate::capability::Components::count),
            axes: axes
                .map(|axis| {
                    let (lower, upper) = (axis.lower().to_word(), axis.upper().to_word());
                    (
                        lower,
                        upper,
                        axis.kind(),
                        [axis.is_logarithmic(), axis.is_periodic()],
                    )
                })
                .collect(),
        }
    }

    /// # Errors
    /// [`Error::State`] if `now`, of scalars `S` as this one, is another problem.
    pub(super) fn check<S: Real>(&self, now: &Self) -> Result<(), Error> {
        if self.description != now.description {
            fits("problem", &named(&self.description), &named(&now.description))?;
        }
        let delta = |of: &Self| S::from_word(of.threshold).to_string();
        fits("threshold", &delta(self), &delta(now))?;
        let components = |of: &Self| of.components.to_string();
        fits("number of components", &components(self), &components(now))?;
        if self != now {
            return Err(Error::State("its problem has another space".to_owned()));
        }
        Ok(())
    }
}

/// # Errors
/// [`Error::State`] if what was saved is not what there is now.
pub(super) fn fits(what: &str, saved: &str, now: &str) -> Result<(), Error> {
    if saved == now {
        Ok(())
    } else {
        Err(Error::State(format!("its {what} is {saved}, not {now}")))
    }
}

/// A description on one line.
pub(super) fn named(description: &Description) -> String {
    let parameters: Vec<String> = description
        .parameters
        .iter()
        .map(|(name, text)| format!("{name}={text}"))
        .collect();
    format!("{} {{{}}}", description.name, parameters.join(", "))
}

impl<P: SatisficingProblem + ?Sized> Search<P> {
    /// The search as it is between two slices. Cost: a copy of the engines' state.
    ///
    /// ```
    /// use satisfice::{engine, from_fn, Budget, Search, Space};
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let budget = Budget::evaluations(5000);
    /// let mut search = Search::named("walk")?.seed(3);
    /// search.run(&problem, &budget)?;
    /// let saved = search.checkpoint();
    /// let mut resumed = Search::resume(saved, engine::Walk::default())?;
    /// let (one, two) = (search.run(&problem, &budget)?, resumed.run(&problem, &budget)?);
    /// assert!(one.hits().map(|hit| hit.evaluation).eq(two.hits().map(|hit| hit.evaluation)));
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint<P::Solution> {
        self.kept.save(self.kept.unfinished.as_ref())
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> KeptSearch<S, T> {
    /// The search and, if one runs, its slice.
    pub(super) fn save(&self, running: Option<&Running<S, T>>) -> Checkpoint<T> {
        let lanes = match running {
            Some(running) => running.lanes.iter().map(|lane| lane.lane.save()).collect(),
            None => self.lanes.iter().map(super::lane::Lane::save).collect(),
        };
        let exchange = running.and_then(|running| {
            let exchange = running.exchange.as_ref()?;
            let slices = running.lanes.iter().map(|lane| lane.slice.save_lane());
            Some((slices.collect(), exchange.progress.to_go_on()))
        });
        Checkpoint {
            contents: Contents {
                version: env!("CARGO_PKG_VERSION").to_owned(),
                scalar: S::NAME.to_owned(),
                engine: self.description(),
                problem: self.problem.clone(),
                seed: self.seed,
                islands: self.islands,
                warm_start: self.warm_start,
                probes: self.probes,
                starts: self
                    .starts
                    .iter()
                    .map(|at| at.iter().map(|x| x.f64()).collect())
                    .collect(),
                slices: self.slices,
                dimension: self.dimension,
                previous: Arc::clone(&self.previous),
                unfinished: running.map(|running| running.reported().save()),
                lanes,
                tickets: None,
                exchange,
            },
        }
    }
}

impl<S: Real> super::lane::Lane<S> {
    pub(super) fn save(&self) -> State {
        let mut state = State::default();
        self.rng.save(&mut state);
        self.engine.save(&mut state);
        state
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Slice<S, T> {
    /// One of several lanes, beside the slice that has the hits that all share.
    fn save_lane(&self) -> Unfinished<T> {
        Unfinished {
            listed: Arc::default(),
            ..self.save()
        }
    }

    pub(super) fn save(&self) -> Unfinished<T> {
        let mut state = State::default();
        self.last.save(&mut state);
        self.probes.save(&mut state);
        self.verified_before_pending().save(&mut state);
        self.to_verify.end.save(&mut state);
        self.pending().save(&mut state);
        self.starts.save(&mut state);
        self.sources.save(&mut state);
        self.next_row.save(&mut state);
        let ledger = &self.ledger;
        let is_lane = ledger.unlisted.is_some();
        let (hits, listed) = match ledger.archive.listed().filter(|_| is_lane) {
            Some(listed) => (ledger.archive.found(), Arc::clone(listed)),
            None => (ledger.archive.all(), Arc::default()),
        };
        Unfinished {
            budget: Budget {
                cancel: None,
                ..ledger.budget.clone()
            },
            elapsed: ledger.clock.elapsed(),
            counts: self.counts(),
            trace: ledger.trace.clone(),
            stop: ledger.stop.filter(|&stop| stop != StopReason::Cancelled),
            archive: hits.clone(),
            best: ledger.best.get().cloned(),
            hits: hits.len() as u64,
            probe_only: hits.probe_only_indices(),
            listed,
            unlisted: ledger.unlisted.clone(),
            state,
        }
    }
}

mod sealed {
    //! A checkpoint is written with a checksum over all of it, and refused if that does not fit.

    use postcard::ser_flavors::Flavor;
    use serde::de::DeserializeOwned;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};

    use super::{Checkpoint, Contents, Identity, Packable};
    use crate::checksum::Checksum;

    #[derive(Serialize)]
    struct Written<'a, T: Packable> {
        checksum: u64,
        contents: &'a Contents<T>,
    }

    #[derive(Deserialize)]
    #[serde(bound(deserialize = "T: Packable"))]
    struct Read<T> {
        checksum: u64,
        contents: Contents<T>,
    }

    /// The checksum of the bytes of a compact encoding.
    impl Flavor for Checksum {
        type Output = u64;
        fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
            self.push(byte);
            Ok(())
        }
        fn finalize(self) -> postcard::Result<u64> {
            Ok(self.value())
        }
    }

    fn checksum<T: Packable>(contents: &Contents<T>) -> postcard::Result<u64> {
        postcard::serialize_with_flavor(contents, Checksum::default())
    }

    impl<T: Serialize + DeserializeOwned + Identity> Serialize for Checkpoint<T> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let contents = &self.contents;
            let checksum = checksum(contents).map_err(ser::Error::custom)?;
            Written { checksum, contents }.serialize(serializer)
        }
    }

    impl<'de, T: Serialize + DeserializeOwned + Identity> Deserialize<'de> for Checkpoint<T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let Read {
                checksum: written,
                contents,
            } = Read::<T>::deserialize(deserializer)?;
            if checksum(&contents).map_err(de::Error::custom)? != written {
                return Err(de::Error::custom("the checkpoint is damaged"));
            }
            Ok(Self { contents })
        }
    }
}
