//! Rigid placements: a rotation and a translation.

use crate::error::Error;
use crate::mesh::Mesh;

/// The square of the length of a normalised quaternion differs from 1 by no more than this.
const UNIT: f64 = 8.0 * f64::EPSILON;
/// Products of rows of a rotation matrix may be off by this.
const OFF: f64 = 1e-6;

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

    /// A rotation from a quaternion `[w, x, y, z]` of any length but zero. It is normalised, unless its length is 1 within rounding: what
    /// [`Placement::quaternion`] returns gives the same rotation to the last bit.
    ///
    /// ```
    /// use satisfice_collision::Placement;
    /// let placement = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7)?.moved([1.0, 0.0, 0.0])?;
    /// let (rotation, translation) = (placement.quaternion(), placement.translation());
    /// assert_eq!(Placement::from_quaternion(rotation)?.moved(translation)?, placement);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if a component is not finite or all are zero.
    pub fn from_quaternion(quaternion: [f64; 4]) -> Result<Self, Error> {
        let refuse = |allowed| Err(Error::parameter("quaternion", format!("{quaternion:?}"), allowed));
        if quaternion.iter().any(|c| !c.is_finite()) {
            return refuse("four finite numbers w, x, y, z");
        }
        let square: f64 = quaternion.iter().map(|c| c * c).sum();
        if (square - 1.0).abs() <= UNIT {
            return Ok(Self::turned(quaternion));
        }
        match unit(quaternion) {
            Some(quaternion) => Ok(Self::turned(quaternion)),
            None => refuse("not all zero"),
        }
    }

    /// The rotation of a unit quaternion.
    fn turned(quaternion: [f64; 4]) -> Self {
        Self {
            quaternion,
            rotation: matrix(quaternion),
            translation: [0.0; 3],
        }
    }

    /// The rotation of a quaternion that is not near 0, normalised.
    fn normalised(quaternion: [f64; 4]) -> Self {
        Self::turned(unit(quaternion).unwrap_or(Self::IDENTITY.quaternion))
    }

    /// A rotation from the rows of its matrix, then a translation: `x -> R x + t`. Of a matrix whose rows have length 1 and are at right
    /// angles up to 1e-6, about the nearest rotation. What [`Placement::rotation`] returns gives the same rotation within rounding; to
    /// get it to the last bit, keep the [quaternion](Placement::from_quaternion).
    ///
    /// ```
    /// use satisfice_collision::Placement;
    /// let quarter = Placement::from_matrix([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [5.0, 0.0, 0.0])?;
    /// let [x, y, z] = quarter.apply([1.0, 0.0, 0.0]);
    /// assert!((x - 5.0).abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && z == 0.0);
    /// assert!(Placement::from_matrix([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).is_err());
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if a number is not finite, or the matrix scales, shears or mirrors.
    pub fn from_matrix(rows: [[f64; 3]; 3], translation: [f64; 3]) -> Result<Self, Error> {
        let refuse = |allowed| Err(Error::parameter("rotation", format!("{rows:?}"), allowed));
        if rows.as_flattened().iter().any(|c| !c.is_finite()) {
            return refuse("three rows of three finite numbers");
        }
        let product = |i: usize, j: usize| (0..3).map(|k| rows[i][k] * rows[j][k]).sum::<f64>();
        let is_off = |(i, j): (usize, usize)| {
            let expected = if i == j { 1.0 } else { 0.0 };
            let off = (product(i, j) - expected).abs();
            off.is_nan() || off > OFF
        };
        if (0..3).flat_map(|i| (i..3).map(move |j| (i, j))).any(is_off) {
            return refuse(
                "rows of length 1 at right angles, up to 1e-6: a rotation scales and shears nothing",
            );
        }
        let [[a, b, c], [d, e, f], [g, h, i]] = rows;
        if a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0 {
            return refuse("a matrix of positive determinant: a rotation mirrors nothing");
        }
        Self::normalised(of_matrix(&rows)).with_translation(translation)
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
        Ok(Self::normalised([c, s * x, s * y, s * z]))
    }

    /// The same rotation, and this translation instead of its own.
    ///
    /// ```
    /// use satisfice_collision::Placement;
    /// let turned = Placement::from_axis_angle([0.0, 0.0, 1.0], 0.5)?.moved([5.0, 0.0, 0.0])?;
    /// let elsewhere = turned.with_translation([0.0, 1.0, 0.0])?;
    /// assert_eq!(elsewhere.rotation(), turned.rotation());
    /// assert_eq!(elsewhere.translation(), [0.0, 1.0, 0.0]);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if a component is not finite.
    pub fn with_translation(self, translation: [f64; 3]) -> Result<Self, Error> {
        if translation.iter().all(|t| t.is_finite()) {
            return Ok(self.at(translation));
        }
        Err(not_finite(translation))
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
            Err(not_finite(offset))
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
        Self::normalised(product).moved(next.apply(self.translation))
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
            Self::normalised([w, -x, -y, -z])
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

fn not_finite(translation: [f64; 3]) -> Error {
    Error::parameter("translation", format!("{translation:?}"), "three finite numbers")
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

/// The quaternion `[w, x, y, z]` of a rotation, of any length: the greatest of its components is computed first
/// (Shepperd 1978, <https://doi.org/10.2514/3.55767b>).
pub(crate) fn of_matrix(m: &[[f64; 3]; 3]) -> [f64; 4] {
    let trace = m[0][0] + m[1][1] + m[2][2];
    let greatest = (0..3).fold(0, |best, k| if m[k][k] > m[best][best] { k } else { best });
    if trace >= m[greatest][greatest] {
        return [
            1.0 + trace,
            m[2][1] - m[1][2],
            m[0][2] - m[2][0],
            m[1][0] - m[0][1],
        ];
    }
    let (i, j, k) = (greatest, (greatest + 1) % 3, (greatest + 2) % 3);
    let mut q = [0.0; 4];
    q[0] = m[k][j] - m[j][k];
    q[1 + i] = 1.0 + m[i][i] - m[j][j] - m[k][k];
    q[1 + j] = m[j][i] + m[i][j];
    q[1 + k] = m[k][i] + m[i][k];
    q
}

#[cfg(test)]
mod tests;
