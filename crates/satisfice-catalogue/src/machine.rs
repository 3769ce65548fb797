//! Facts about this machine: what a reader needs to judge times measured on it.

use std::fs;

/// Facts as `(name, value)`; what the system does not provide is left out.
#[must_use]
pub fn machine() -> Vec<(String, String)> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let field = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(name))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let cores = std::thread::available_parallelism()
        .ok()
        .map(|cores| cores.to_string());
    let load = read("/proc/loadavg")
        .split(' ')
        .take(3)
        .collect::<Vec<_>>()
        .join(", ");
    let facts = [
        ("processor", field(&read("/proc/cpuinfo"), "model name")),
        ("cores at hand", cores),
        ("memory", field(&read("/proc/meminfo"), "MemTotal")),
        (
            "system",
            Some(format!(
                "{} {}, {}",
                std::env::consts::OS,
                read("/proc/sys/kernel/osrelease").trim(),
                std::env::consts::ARCH
            )),
        ),
        (
            "load over 1, 5 and 15 minutes, when this was written",
            (!load.is_empty()).then_some(load),
        ),
        ("satisfice", Some(env!("CARGO_PKG_VERSION").to_owned())),
        (
            "build",
            Some(
                if cfg!(debug_assertions) {
                    "debug: times mean nothing"
                } else {
                    "release"
                }
                .to_owned(),
            ),
        ),
    ];
    facts
        .into_iter()
        .filter_map(|(what, value)| Some((what.to_owned(), value?)))
        .collect()
}
