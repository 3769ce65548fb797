//! The stages of a slice.

/// At which stage a slice is, between two batches or within one.
#[derive(Debug, Clone)]
pub(super) enum Stage<S> {
    /// The next batch is to be proposed.
    Propose,
    /// A batch is proposed, to be evaluated and settled.
    Settle(BatchSource),
    /// A batch was handed out; its fitness is to be told.
    Asked(BatchSource),
    /// A batch was out when the slice was saved: it is to be proposed again.
    Repeat(Pending<S>),
}

/// Where a batch comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum BatchSource {
    /// The engine.
    Engine,
    /// The hits of the slice before.
    WarmStart,
    /// The user.
    Starts,
    /// The uniform probes.
    Probes,
}

/// A batch that is proposed and not settled.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Pending<S> {
    pub(super) from: BatchSource,
    /// The points, one after the other.
    pub(super) positions: Vec<S>,
    /// The fitness of what has to be evaluated, as far as it is computed.
    pub(super) computed: Vec<Option<S>>,
}
