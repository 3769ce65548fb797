//! Queries with exact answers and frames of cloth, from a folder that the user names.

use std::path::{Path, PathBuf};

use satisfice_collision::{Mesh, io};

use crate::families::Query;

/// The folder, if it is named.
pub(crate) fn folder() -> Option<PathBuf> {
    std::env::var_os("SATISFICE_DATA").map(PathBuf::from)
}

/// Both frames of a step.
pub(crate) fn step(from: &str, to: &str) -> Option<(Mesh, Vec<[f64; 3]>)> {
    let folder = folder()?;
    let from = io::read(folder.join(from)).ok()?;
    let to = io::read(folder.join(to)).ok()?;
    Some((from, to.vertices().to_vec()))
}

/// Sets of queries by name, each with whether it touches.
pub(crate) fn sets() -> Vec<(String, Vec<(Query, bool)>)> {
    let Some(folder) = folder() else {
        return Vec::new();
    };
    let mut sets: Vec<(String, Vec<(Query, bool)>)> = Vec::new();
    for name in [
        "erleben-cube-cliff-edges",
        "erleben-sliding-wedge",
        "erleben-spikes",
        "unit-tests",
    ] {
        for (kind, is_edges) in [("edge-edge", true), ("vertex-face", false)] {
            let path = folder
                .join("ccd/queries")
                .join(name)
                .join(kind)
                .join("data_0_0.csv");
            let rows = rows(&path);
            let queries = rows.chunks_exact(8).map(|rows| {
                let truth = rows[0].get(6).is_some_and(|truth| *truth == 1.0);
                (query(rows, is_edges), truth)
            });
            sets.push((format!("{name}, {kind}"), queries.collect()));
        }
    }
    for (short, kind, is_edges) in [("ee", "edge-edge", true), ("vf", "vertex-face", false)] {
        let folder = folder.join("ccd/cloth-funnel");
        let rows = rows(&folder.join(format!("227{short}.csv")));
        let truth =
            std::fs::read_to_string(folder.join(format!("227{short}_mma_bool.json"))).unwrap_or_default();
        let truth = truth
            .split(|c: char| !c.is_ascii_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(|word| word == "true" || word == "1");
        let queries = rows.chunks_exact(8).map(|rows| query(rows, is_edges));
        sets.push((format!("cloth-funnel 227, {kind}"), queries.zip(truth).collect()));
    }
    sets.retain(|(_, queries)| !queries.is_empty());
    sets
}

fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let numbers = |line: &str| {
        line.split(',')
            .filter_map(|number| number.trim().parse().ok())
            .collect()
    };
    text.lines().map(numbers).collect()
}

/// Eight rows, four at each end: numerators and denominators of three coordinates, which are doubles.
fn query(rows: &[Vec<f64>], is_edges: bool) -> Query {
    let point = |row: &Vec<f64>| std::array::from_fn(|k| row[2 * k] / row[2 * k + 1]);
    Query {
        is_edges,
        from: std::array::from_fn(|k| point(&rows[k])),
        to: std::array::from_fn(|k| point(&rows[4 + k])),
    }
}
