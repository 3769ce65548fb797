//! The command `satisfice`.
fn main() {}
