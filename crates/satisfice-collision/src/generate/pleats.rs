//! A cloth laid in pleats: layers that lie upon each other and touch here and there.

use std::f64::consts::{PI, TAU};

use super::{checked_count, checked_length, checked_vertices, cloth};
use crate::error::Error;
use crate::mesh::Mesh;

/// The waves' height in gaps: two layers may come as near as 0.1 gaps, and as far apart as 1.9.
const HEIGHT: f64 = 0.45;
/// Waves along the cloth's whole length, and across it.
const WAVES: [f64; 2] = [7.3, 2.0];

/// A cloth 3 long and 1 wide, of `columns` x `rows` vertices, laid in `layers` layers a `gap` apart, joined by half
/// circles. Waves run through it, so that neighbouring layers come as near as a tenth of the gap in some places; `phase`, in
/// turns, moves the waves, from 0 to 1 once around. The same numbers but for `phase` give frames of one deforming body.
///
/// # Errors
/// [`Error::Parameter`] unless `gap` and `phase` are finite, `gap` above 0 and such that the turns do not use up the cloth, all
/// counts are large enough (2 vertices, 1 layer), and the vertices at most 2^24.
pub fn pleats(columns: usize, rows: usize, layers: usize, gap: f64, phase: f64) -> Result<Mesh, Error> {
    const LENGTH: f64 = 3.0;
    checked_length("gap", gap)?;
    checked_count("columns", columns, 2, "at least 2 vertices")?;
    checked_count("rows", rows, 2, "at least 2 vertices")?;
    checked_count("layers", layers, 1, "at least 1 layer")?;
    checked_vertices(columns, rows, 0)?;
    if !phase.is_finite() {
        return Err(Error::parameter("phase", phase, "a finite number of turns"));
    }
    let turn = PI * gap / 2.0;
    let straight = (LENGTH - (layers - 1) as f64 * turn) / layers as f64;
    if straight <= 0.0 {
        return Err(Error::parameter(
            "gap",
            gap,
            "so small that the turns leave some of the cloth's length, 3, flat",
        ));
    }
    let flat = cloth(LENGTH, 1.0, columns, rows)?;
    let place = |[x, y, _]: [f64; 3]| {
        let along = x + LENGTH / 2.0;
        let layer = (along / (straight + turn)).floor().min((layers - 1) as f64);
        let rest = along - layer * (straight + turn);
        let sign = if layer % 2.0 == 0.0 { 1.0 } else { -1.0 };
        let angle = ((rest - straight) / (gap / 2.0)).max(0.0);
        let reach = rest.min(straight) - straight / 2.0 + gap / 2.0 * angle.sin();
        let level = layer * gap + gap / 2.0 * (1.0 - angle.cos());
        let wave = (TAU * (WAVES[0] * along / LENGTH + WAVES[1] * y + phase)).sin();
        [sign * reach, y, level + HEIGHT * gap * wave]
    };
    flat.with_vertices(flat.vertices().iter().map(|&vertex| place(vertex)).collect())
}
