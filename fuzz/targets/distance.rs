//! Decisions and distances of arbitrary bit patterns against rational arithmetic.
#![no_main]

#[path = "../../crates/satisfice-collision/tests/stress/mod.rs"]
mod stress;

libfuzzer_sys::fuzz_target!(|data: &[u8]| stress::fuzzing::distance(data));
