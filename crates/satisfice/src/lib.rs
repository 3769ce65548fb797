//! satisfice
