//! Points in length scales, stored by rows and by blocks.

use super::kernel::Feature;
use super::lanes::{LANES, Lanes};

/// Points by their features.
#[derive(Debug, Clone, Default)]
pub(super) struct Points {
    pub(super) features: Vec<Feature>,
    axes: usize,
    rows: Vec<f64>,
    /// Lanes of each feature for each block of [`LANES`] points; lanes behind the last point hold what was there before.
    blocks: Vec<Lanes>,
    len: usize,
}

impl Points {
    pub(super) fn clear(&mut self, features: Vec<Feature>) {
        *self = Self {
            axes: features.len(),
            features,
            ..Self::default()
        };
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn push(&mut self, point: impl Iterator<Item = f64>) {
        let (block, lane) = (self.len / LANES, self.len % LANES);
        self.blocks.resize((block + 1) * self.axes, [0.0; LANES]);
        for (lanes, x) in self.blocks[block * self.axes..].iter_mut().zip(point) {
            self.rows.push(x);
            lanes[lane] = x;
        }
        self.len += 1;
    }

    pub(super) fn truncate(&mut self, len: usize) {
        self.len = len;
        self.rows.truncate(len * self.axes);
        self.blocks.truncate(len.div_ceil(LANES) * self.axes);
    }

    /// Point `i`.
    #[inline]
    pub(super) fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.axes..(i + 1) * self.axes]
    }

    /// Number of blocks, the last one included.
    pub(super) fn blocks(&self) -> usize {
        self.len.div_ceil(LANES)
    }

    /// Block `b`, one [`Lanes`] for each feature.
    #[inline]
    pub(super) fn block(&self, b: usize) -> &[Lanes] {
        &self.blocks[b * self.axes..(b + 1) * self.axes]
    }

    /// How many points block `b` has.
    pub(super) fn count(&self, b: usize) -> usize {
        LANES.min(self.len - b * LANES)
    }
}
