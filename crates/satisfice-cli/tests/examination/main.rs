//! The standing examination of the command: mutated input files, signals, full disks, damaged checkpoints, equal reports.
//!
//! `cargo test -p satisfice-cli --test examination` runs a short form.
//! `SATISFICE_EXAMINE=full cargo test --release -p satisfice-cli --test examination` runs 10,000 mutations of each kind of file and 100
//! signals of each kind, and writes its figures to `docs/results/reliability.md`.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test")]

mod damage;
mod equality;
mod extent;
mod files;
mod mutation;
mod outputs;
mod process;
mod signals;
