//! Axis-aligned bounding boxes.

/// A closed axis-aligned box, with `min[k] <= max[k]` for every axis `k`.
///
/// ```
/// use satisfice_collision::Aabb;
/// let mut bounds = Aabb::point([0.0, 0.0, 0.0]);
/// bounds.include([1.0, 3.0, -2.0]);
/// assert_eq!((bounds.longest_axis(), bounds.size()), (1, 3.0));
/// assert!(bounds.contains([0.5, 1.0, -2.0]));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: [f64; 3],
    /// The largest coordinates.
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

    /// The smallest box around the points; `None` if there are none.
    pub fn of_points(points: impl IntoIterator<Item = [f64; 3]>) -> Option<Self> {
        let mut points = points.into_iter();
        let mut bounds = Self::point(points.next()?);
        for point in points {
            bounds.include(point);
        }
        Some(bounds)
    }

    /// Extends the box to contain `point`.
    pub fn include(&mut self, point: [f64; 3]) {
        for (k, &c) in point.iter().enumerate() {
            self.min[k] = self.min[k].min(c);
            self.max[k] = self.max[k].max(c);
        }
    }

    /// `max - min` by axis. Infinite where the difference of finite bounds exceeds the largest `f64`.
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

    /// The longest extent, called the *size* throughout this crate.
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
