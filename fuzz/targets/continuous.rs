//! Decisions about moving pairs: every way of asking agrees, and so do touching, hitting and the time of impact.
#![no_main]

#[path = "../../crates/satisfice-collision/tests/motions/mod.rs"]
mod motions;
#[path = "../../crates/satisfice-collision/tests/stress/mod.rs"]
mod stress;

libfuzzer_sys::fuzz_target!(|data: &[u8]| motions::fuzzing::check(data));
