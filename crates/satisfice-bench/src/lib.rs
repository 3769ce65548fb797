//! satisfice-bench
