//! Everything that was evaluated.

use core::hash::BuildHasher;
use foldhash::fast::FixedState;
use hashbrown::HashSet;

/// The seed of the keys; fixed, so that a run is the same on every machine.
const KEYS: FixedState = FixedState::with_seed(0x6d6f_6465_6c00);

/// What became of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PointKind {
    /// A new hit.
    Hit,
    /// No hit, or without F.
    Miss,
    /// Evaluated and found to be the same as a hit.
    Duplicate,
}

/// Points in units, with F; in the order in which they were told.
#[derive(Debug, Clone, Default)]
pub(super) struct Record {
    axes: usize,
    units: Vec<f64>,
    /// NaN if there is no finite F.
    pub(super) values: Vec<f64>,
    /// Components of F, as many for each point.
    components: Vec<f64>,
    /// Indices of hits.
    pub(super) hits: Vec<usize>,
    /// Indices of points that turned out to be the same as a hit.
    pub(super) duplicates: Vec<usize>,
    /// Coordinates of both, side by side: every candidate is compared with all of them.
    answers: Vec<f64>,
    /// Keys of all points.
    seen: HashSet<u64, FixedState>,
}

impl Record {
    pub(super) fn clear(&mut self, axes: usize) {
        *self = Self {
            axes,
            ..Self::default()
        };
    }

    pub(super) fn len(&self) -> usize {
        self.values.len()
    }

    /// Number of different points that were told.
    pub(super) fn distinct(&self) -> usize {
        self.seen.len()
    }

    #[inline]
    pub(super) fn point(&self, i: usize) -> &[f64] {
        &self.units[i * self.axes..(i + 1) * self.axes]
    }

    /// The points that are hits or the same as one, in any order.
    pub(super) fn answers(&self) -> impl Iterator<Item = &[f64]> {
        self.answers.chunks_exact(self.axes.max(1))
    }

    /// Whether this very point was told.
    pub(super) fn has(&self, units: &[f64]) -> bool {
        self.seen.contains(&key(units))
    }

    /// Notes a point with its F, NaN if that is missing.
    pub(super) fn add(&mut self, units: &[f64], value: f64, kind: PointKind) {
        self.seen.insert(key(units));
        match kind {
            PointKind::Hit => self.hits.push(self.len()),
            PointKind::Duplicate => self.duplicates.push(self.len()),
            PointKind::Miss => {}
        }
        if kind != PointKind::Miss {
            self.answers.extend_from_slice(units);
        }
        self.units.extend_from_slice(units);
        self.values.push(value);
    }

    /// Notes the components of F at the point that was added last.
    pub(super) fn add_components(&mut self, components: &[f64]) {
        self.components.extend_from_slice(components);
    }

    /// The components of F at a point.
    pub(super) fn components(&self, i: usize) -> &[f64] {
        let count = self.component_count();
        &self.components[i * count..(i + 1) * count]
    }

    /// Number of components of F; 0 where F itself is all that is known.
    pub(super) fn component_count(&self) -> usize {
        self.components.len() / self.len().max(1)
    }

    pub(super) fn axes(&self) -> usize {
        self.axes
    }

    /// All that has to be saved, for [`Record::restored`].
    pub(super) fn saved(&self) -> (usize, [Vec<f64>; 3], [Vec<usize>; 2]) {
        let numbers = [self.units.clone(), self.values.clone(), self.components.clone()];
        let lists = [self.hits.clone(), self.duplicates.clone()];
        (self.axes, numbers, lists)
    }

    /// `None` if the lists do not fit each other.
    pub(super) fn restored(
        axes: usize,
        [units, values, components]: [Vec<f64>; 3],
        [hits, duplicates]: [Vec<usize>; 2],
    ) -> Option<Self> {
        let fits = |list: &[usize]| {
            list.is_sorted_by(|a, b| a < b) && list.last().is_none_or(|&last| last < values.len())
        };
        let whole = components
            .len()
            .checked_rem(values.len())
            .unwrap_or(components.len());
        if units.len() != axes * values.len() || whole != 0 || !fits(&hits) || !fits(&duplicates) {
            return None;
        }
        let mut record = Self {
            axes,
            units,
            values,
            components,
            hits,
            duplicates,
            answers: Vec::new(),
            seen: HashSet::default(),
        };
        for &i in record.hits.iter().chain(&record.duplicates) {
            let point = &record.units[i * axes..(i + 1) * axes];
            record.answers.extend_from_slice(point);
        }
        for i in 0..record.len() {
            let key = key(record.point(i));
            record.seen.insert(key);
        }
        Some(record)
    }
}

fn key(units: &[f64]) -> u64 {
    use core::hash::Hasher;
    let mut hasher = KEYS.build_hasher();
    for x in units {
        hasher.write_u64((x + 0.0).to_bits());
    }
    hasher.finish()
}
