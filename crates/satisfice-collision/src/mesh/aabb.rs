//! Axis-aligned bounding boxes.

/// A closed axis-aligned box, `min[k] <= max[k]` for every axis `k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The least coordinates.
    pub min: [f64; 3],
    /// The greatest coordinates.
    pub max: [f64; 3],
}

impl Aabb {
    /// The box that holds one point.
    #[must_use]
    pub fn point(point: [f64; 3]) -> Self {
        Self {
            min: point,
            max: point,
        }
    }

    /// The least box around some points; `None` if there are none.
    pub fn of_points(points: impl IntoIterator<Item = [f64; 3]>) -> Option<Self> {
        let mut points = points.into_iter();
        let mut bounds = Self::point(points.next()?);
        for point in points {
            bounds.include(point);
        }
        Some(bounds)
    }

    /// Grows to hold `point`.
    pub fn include(&mut self, point: [f64; 3]) {
        for (k, &c) in point.iter().enumerate() {
            self.min[k] = self.min[k].min(c);
            self.max[k] = self.max[k].max(c);
        }
    }

    /// `max - min` by axis. Infinite where finite bounds lie further apart than the greatest `f64`.
    #[must_use]
    pub fn extents(&self) -> [f64; 3] {
        [
            self.max[0] - self.min[0],
            self.max[1] - self.min[1],
            self.max[2] - self.min[2],
        ]
    }

    /// The axis (0, 1 or 2) of the longest extent; the first of equals.
    #[must_use]
    pub fn longest_axis(&self) -> usize {
        let extents = self.extents();
        (1..3).fold(0, |best, k| if extents[k] > extents[best] { k } else { best })
    }

    /// The longest extent: what "size" means everywhere.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.extents()[self.longest_axis()]
    }

    /// Whether `point` lies inside or on the boundary.
    #[must_use]
    pub fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|k| self.min[k] <= point[k] && point[k] <= self.max[k])
    }
}
