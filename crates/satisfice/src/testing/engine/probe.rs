//! Engines round the engine under test: one looks at its proposals, one saves and restores it all the time.

use std::sync::{Arc, Mutex};

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::{Ask, ConfiguredEngine, Engine, Origin, WarmStart};
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Reader, State};

/// What was found out, shared with the suite.
#[derive(Debug, Clone, Default)]
pub(super) struct Findings(Arc<Mutex<Option<String>>>);

impl Findings {
    /// The first thing found.
    pub(super) fn first(&self) -> Option<String> {
        self.0.lock().ok().and_then(|first| first.clone())
    }

    fn add(&self, what: impl FnOnce() -> String) {
        if let Ok(mut first) = self.0.lock() {
            first.get_or_insert_with(what);
        }
    }
}

/// Looks at every proposal.
pub(super) struct Probe<S> {
    inner: Box<dyn Engine<S>>,
    findings: Findings,
}

impl<S: Real> Probe<S> {
    /// The engine with its proposals checked.
    pub(super) fn around(engine: &ConfiguredEngine<S>) -> (ConfiguredEngine<S>, Findings) {
        let findings = Findings::default();
        let (engine, shared) = (engine.clone(), findings.clone());
        let name = engine.name().to_owned();
        let probe = ConfiguredEngine::custom(&name, move || Self {
            inner: engine.build_unchecked(),
            findings: shared.clone(),
        });
        (probe, findings)
    }
}

impl<S: Real> Engine<S> for Probe<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.inner.begin(context);
    }
    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        let ask = self.inner.ask(context, rng, out);
        for position in out.points() {
            // A batch fills what is missing with NaN.
            if position.iter().any(|x| x.is_nan()) {
                self.findings.add(|| format!("{position:?} was proposed"));
            }
        }
        ask
    }
    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        self.inner.tell(context, batch, outcomes, origin);
    }
    fn deletes(&self) -> bool {
        self.inner.deletes()
    }
    fn probes(&self) -> f64 {
        self.inner.probes()
    }
    fn warm_start(&self) -> WarmStart {
        self.inner.warm_start()
    }
    fn save(&self, state: &mut State) {
        self.inner.save(state);
    }
    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.inner.restore(from)
    }
}

/// Every so many tells, the engine is saved, and another that is restored from it continues.
pub(super) struct Restored<S> {
    inner: Box<dyn Engine<S>>,
    spare: Vec<Box<dyn Engine<S>>>,
    every: usize,
    tells: usize,
    findings: Findings,
}

/// Engines are changed this often in one run.
const SPARE: usize = 60;

impl<S: Real> Restored<S> {
    /// The engine, replaced by a restored one after every so many tells.
    pub(super) fn around(engine: &ConfiguredEngine<S>, every: usize) -> (ConfiguredEngine<S>, Findings) {
        let findings = Findings::default();
        let (engine, shared) = (engine.clone(), findings.clone());
        let name = engine.name().to_owned();
        let restored = ConfiguredEngine::custom(&name, move || Self {
            inner: engine.build_unchecked(),
            spare: (0..SPARE).map(|_| engine.build_unchecked()).collect(),
            every,
            tells: 0,
            findings: shared.clone(),
        });
        (restored, findings)
    }

    fn change(&mut self) {
        let Some(mut next) = self.spare.pop() else {
            return;
        };
        let mut state = State::default();
        self.inner.save(&mut state);
        // A state that is cut short is refused; what the attempt leaves behind is overwritten below.
        if let Some(shorter) = state.0.len().checked_sub(1) {
            for length in [0, shorter / 2, shorter] {
                let cut = State(state.0[..length].to_vec());
                let mut reader = Reader::new(&cut);
                if next.restore(&mut reader).and_then(|()| reader.finish()).is_ok() {
                    self.findings
                        .add(|| format!("{length} of {} bytes were enough", state.0.len()));
                }
            }
        }
        let mut reader = Reader::new(&state);
        match next.restore(&mut reader).and_then(|()| reader.finish()) {
            Ok(()) => self.inner = next,
            Err(error) => self.findings.add(|| error.to_string()),
        }
    }
}

impl<S: Real> Engine<S> for Restored<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.inner.begin(context);
    }
    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.inner.ask(context, rng, out)
    }
    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        self.inner.tell(context, batch, outcomes, origin);
        self.tells += 1;
        if self.tells.is_multiple_of(self.every) {
            self.change();
        }
    }
    fn deletes(&self) -> bool {
        self.inner.deletes()
    }
    fn probes(&self) -> f64 {
        self.inner.probes()
    }
    fn warm_start(&self) -> WarmStart {
        self.inner.warm_start()
    }
    fn save(&self, state: &mut State) {
        self.inner.save(state);
    }
    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.inner.restore(from)
    }
}
