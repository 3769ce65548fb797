//! A whole engine in its box. The model is told apart, because it may turn out to be of no use, and so are regions, because batches of
//! them grow.

use crate::engine::Engine;
use crate::engine::exact::RegionSearch;
use crate::engine::model::ModelledSearch;
use crate::scalar::Real;

/// The model, regions, or another engine.
pub(super) enum Member<S> {
    Model(Box<ModelledSearch<S>>),
    Regions(Box<RegionSearch<S>>),
    Other(Box<dyn Engine<S>>),
}

impl<S: Real> core::ops::Deref for Member<S> {
    type Target = dyn Engine<S>;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Model(model) => &**model,
            Self::Regions(regions) => &**regions,
            Self::Other(engine) => &**engine,
        }
    }
}

impl<S: Real> core::ops::DerefMut for Member<S> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Model(model) => &mut **model,
            Self::Regions(regions) => &mut **regions,
            Self::Other(engine) => &mut **engine,
        }
    }
}
