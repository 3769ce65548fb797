//! satisfice-problems
