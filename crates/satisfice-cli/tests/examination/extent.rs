//! The extent of the examination: a short form for every test run, the full one on demand.

/// Whether the full examination was asked for.
pub(crate) fn is_full() -> bool {
    std::env::var("SATISFICE_EXAMINE").is_ok_and(|extent| extent == "full")
}

/// `short` cases, or `full` ones in the full examination.
pub(crate) fn cases(short: u64, full: u64) -> u64 {
    if is_full() { full } else { short }
}

/// Reports a figure of the examination.
pub(crate) fn figure(what: &str, value: impl core::fmt::Display) {
    println!("| {what} | {value} |");
}
