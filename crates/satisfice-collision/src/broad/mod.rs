//! Broad phases: which pairs of features can be closer than a threshold.
