//! Rigid placements: a rotation and a translation.

use crate::error::Error;
use crate::mesh::Mesh;

/// A rigid motion `x -> R x + t`: a rotation about the origin, then a translation, in `f64`.
///
/// ```
/// use satisfice_collision::Placement;
/// let quarter = Placement::from_axis_angle([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2)?.moved([5.0, 0.0, 0.0])?;
/// let [x, y, z] = quarter.apply([1.0, 0.0, 0.0]);
/// assert!((x - 5.0).abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && z == 0.0);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    quaternion: [f64; 4],
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Placement {
    /// The identity. It leaves every bit of a point unchanged.
    pub const IDENTITY: Self = Self {
        quaternion: [1.0, 0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
    };

    /// A translation without a rotation.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a component is not finite.
    pub fn from_translation(translation: [f64; 3]) -> Result<Self, Error> {
        Self::IDENTITY.moved(translation)
    }

    /// A rotation from a quaternion `[w, x, y, z]` of any length but zero; it is normalised.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a component is not finite or all are zero.
    pub fn from_quaternion(quaternion: [f64; 4]) -> Result<Self, Error> {
        let refuse = |allowed| Err(Error::parameter("quaternion", format!("{quaternion:?}"), allowed));
        if quaternion.iter().any(|c| !c.is_finite()) {
            return refuse("four finite numbers w, x, y, z");
        }
        let Some(quaternion) = unit(quaternion) else {
            return refuse("not all zero");
        };
        Ok(Self {
            quaternion,
            rotation: matrix(quaternion),
            translation: [0.0; 3],
        })
    }

    /// A rotation by `angle` in radians about `axis`, counter-clockwise seen from its tip; the axis may have any length
    /// but zero.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a number is not finite or the axis is zero.
    pub fn from_axis_angle(axis: [f64; 3], angle: f64) -> Result<Self, Error> {
        if !angle.is_finite() {
            return Err(Error::parameter("angle", angle, "a finite number of radians"));
        }
        let refuse = |allowed| Err(Error::parameter("axis", format!("{axis:?}"), allowed));
        if axis.iter().any(|c| !c.is_finite()) {
            return refuse("three finite numbers");
        }
        let Some([x, y, z]) = unit(axis) else {
            return refuse("not all zero");
        };
        let (s, c) = (angle / 2.0).sin_cos();
        Self::from_quaternion([c, s * x, s * y, s * z])
    }

    /// The same placement, then a translation by `offset`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the translation is not finite.
    pub fn moved(mut self, offset: [f64; 3]) -> Result<Self, Error> {
        for (t, o) in self.translation.iter_mut().zip(offset) {
            *t += o;
        }
        if self.translation.iter().all(|t| t.is_finite()) {
            Ok(self)
        } else {
            Err(Error::parameter(
                "translation",
                format!("{offset:?}"),
                "three finite numbers",
            ))
        }
    }

    /// First `self`, then `next`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the translation overflows.
    pub fn then(&self, next: &Self) -> Result<Self, Error> {
        let [a, b, c, d] = next.quaternion;
        let [e, f, g, h] = self.quaternion;
        let product = [
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ];
        Self::from_quaternion(product)?.moved(next.apply(self.translation))
    }

    /// The inverse motion: exact for a translation, within rounding otherwise.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the translation overflows.
    pub fn inverse(&self) -> Result<Self, Error> {
        let [w, x, y, z] = self.quaternion;
        let back = if self.rotation == Self::IDENTITY.rotation {
            Self::IDENTITY
        } else {
            Self::from_quaternion([w, -x, -y, -z])?
        };
        back.moved(back.apply(self.translation).map(|c| -c))
    }

    /// The unit quaternion `[w, x, y, z]`.
    #[must_use]
    #[inline]
    pub fn quaternion(&self) -> [f64; 4] {
        self.quaternion
    }

    /// The rows of the rotation matrix.
    #[must_use]
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        self.rotation
    }

    /// The translation.
    #[must_use]
    #[inline]
    pub fn translation(&self) -> [f64; 3] {
        self.translation
    }

    /// The image of a point. Without a rotation it is `p + t`, rounded once.
    #[must_use]
    pub fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| {
            let [x, y, z] = self.rotation[i];
            x * p[0] + y * p[1] + z * p[2] + self.translation[i]
        })
    }

    /// The same rotation, and this translation, which is finite.
    pub(crate) fn at(self, translation: [f64; 3]) -> Self {
        Self { translation, ..self }
    }

    /// The mesh after the motion. It shares edges and triangles with the original.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] if a coordinate overflows.
    pub fn place(&self, mesh: &Mesh) -> Result<Mesh, Error> {
        mesh.with_vertices(mesh.vertices().iter().map(|&p| self.apply(p)).collect())
    }
}

/// A placement without its matrix: less than half the size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CompactPlacement {
    quaternion: [f64; 4],
    translation: [f64; 3],
}

impl CompactPlacement {
    pub(crate) const IDENTITY: Self = Self {
        quaternion: Placement::IDENTITY.quaternion,
        translation: Placement::IDENTITY.translation,
    };

    /// A unit quaternion and a finite translation.
    pub(crate) fn new(quaternion: [f64; 4], translation: [f64; 3]) -> Self {
        Self {
            quaternion,
            translation,
        }
    }

    pub(crate) const fn quaternion(&self) -> [f64; 4] {
        self.quaternion
    }
}

/// The image of a point under a rotation alone.
pub(crate) fn rotate(quaternion: [f64; 4], p: [f64; 3]) -> [f64; 3] {
    matrix(quaternion).map(|[x, y, z]| x * p[0] + y * p[1] + z * p[2])
}

impl From<&Placement> for CompactPlacement {
    fn from(placement: &Placement) -> Self {
        Self {
            quaternion: placement.quaternion,
            translation: placement.translation,
        }
    }
}

impl From<CompactPlacement> for Placement {
    fn from(compact: CompactPlacement) -> Self {
        Self {
            quaternion: compact.quaternion,
            rotation: matrix(compact.quaternion),
            translation: compact.translation,
        }
    }
}

impl Default for Placement {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// `v` scaled to length 1, or `None` for zero. It is divided by its largest component first, so that no square overflows
/// or underflows.
fn unit<const N: usize>(v: [f64; N]) -> Option<[f64; N]> {
    let greatest = v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if greatest == 0.0 {
        return None;
    }
    let v = v.map(|c| c / greatest);
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    Some(v.map(|c| c / length))
}

fn matrix([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use proptest::prelude::*;

    use super::*;

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    }

    /// Rodrigues' formula, the reference for the quaternion.
    fn rodrigues(axis: [f64; 3], angle: f64, p: [f64; 3]) -> [f64; 3] {
        let length = distance(axis, [0.0; 3]);
        let [x, y, z] = axis.map(|c| c / length);
        let (s, c) = angle.sin_cos();
        let along = (x * p[0] + y * p[1] + z * p[2]) * (1.0 - c);
        let cross = [y * p[2] - z * p[1], z * p[0] - x * p[2], x * p[1] - y * p[0]];
        std::array::from_fn(|k| p[k] * c + cross[k] * s + [x, y, z][k] * along)
    }

    #[test]
    fn no_rotation_is_exact() {
        let p = [0.1, -1e300, 7.3e-310];
        assert_eq!(Placement::IDENTITY.apply(p), p);
        let moved = Placement::from_translation([0.2, 1e299, 1.0]).unwrap();
        assert_eq!(moved.apply(p), [0.1 + 0.2, -1e300 + 1e299, 7.3e-310 + 1.0]);
    }

    #[test]
    fn what_is_not_a_placement_is_refused_by_name() {
        let named = |result: Result<Placement, Error>, name: &str| match result {
            Err(Error::Parameter { parameter, .. }) => assert_eq!(parameter, name),
            other => panic!("{name}: {other:?}"),
        };
        named(Placement::from_translation([0.0, f64::NAN, 0.0]), "translation");
        named(Placement::from_quaternion([0.0; 4]), "quaternion");
        named(
            Placement::from_quaternion([1.0, f64::INFINITY, 0.0, 0.0]),
            "quaternion",
        );
        named(Placement::from_axis_angle([0.0; 3], 1.0), "axis");
        named(Placement::from_axis_angle([f64::NAN, 0.0, 1.0], 1.0), "axis");
        named(
            Placement::from_axis_angle([0.0, 0.0, 1.0], f64::INFINITY),
            "angle",
        );
        let far = Placement::from_translation([1.7e308, 0.0, 0.0]).unwrap();
        named(far.then(&far), "translation");
        let mesh = Mesh::new(vec![[1.7e308, 0.0, 0.0]], vec![], vec![]).unwrap();
        assert!(matches!(
            far.place(&mesh),
            Err(Error::NonFiniteVertex {
                vertex: 0,
                axis: 'x',
                ..
            })
        ));
    }

    #[test]
    fn quaternions_of_any_length_are_normalised() {
        let plain = Placement::from_quaternion([1.0, 2.0, -3.0, 4.0]).unwrap();
        for scale in [2.0_f64.powi(-1060), 2.0_f64.powi(1020)] {
            let scaled = Placement::from_quaternion([1.0, 2.0, -3.0, 4.0].map(|c| c * scale)).unwrap();
            assert_eq!(plain, scaled);
        }
    }

    proptest! {
        #[test]
        fn agrees_with_rodrigues_and_keeps_distances(
            axis in prop::array::uniform3(-1.0..1.0_f64),
            angle in -10.0..10.0_f64,
            offset in prop::array::uniform3(-5.0..5.0_f64),
            p in prop::array::uniform3(-5.0..5.0_f64),
            q in prop::array::uniform3(-5.0..5.0_f64),
        ) {
            prop_assume!(distance(axis, [0.0; 3]) > 1e-3);
            let placed = Placement::from_axis_angle(axis, angle).unwrap().moved(offset).unwrap();
            let turned = rodrigues(axis, angle, p);
            let expected = std::array::from_fn(|k| turned[k] + offset[k]);
            prop_assert!(distance(placed.apply(p), expected) < 1e-13);
            prop_assert!((distance(placed.apply(p), placed.apply(q)) - distance(p, q)).abs() < 1e-13);
            let twice = placed.then(&placed).unwrap();
            prop_assert!(distance(twice.apply(p), placed.apply(placed.apply(p))) < 1e-12);
        }
    }
}
