//! A pleated cloth: layers that lie on each other and nearly touch in places.

use std::f64::consts::{PI, TAU};

use super::{checked_count, checked_length, checked_vertices, cloth};
use crate::error::Error;
use crate::mesh::Mesh;

/// The height of the waves in gaps: the distance of two layers is between 0.1 and 1.9 gaps.
const HEIGHT: f64 = 0.45;
/// The number of waves along the cloth and across it.
const WAVES: [f64; 2] = [7.3, 2.0];

/// A cloth of length 3 and width 1 with `columns` x `rows` vertices, folded into `layers` layers with a distance of `gap`,
/// which half circles join. Waves run through it, so that neighbouring layers are as close as a tenth of the gap in some
/// places. `phase`, in turns, moves the waves: from 0 to 1 once around. Calls that differ in `phase` alone give frames of one
/// deforming body.
///
/// # Errors
/// [`Error::Parameter`] unless `gap` and `phase` are finite, `gap` positive and so small that the half circles
/// do not need the whole length, all counts large enough (2 vertices, 1 layer), and the vertices at most 2^24.
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
