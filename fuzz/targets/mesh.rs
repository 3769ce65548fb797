//! The mesh readers on arbitrary bytes.
#![no_main]

#[path = "../../crates/satisfice-collision/tests/stress/mod.rs"]
mod stress;

libfuzzer_sys::fuzz_target!(|data: &[u8]| stress::fuzzing::mesh(data));
