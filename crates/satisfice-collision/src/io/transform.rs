//! Placements with scale and shear, as scene files have them, and meshes that share what they can.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::error::Error;
use crate::mesh::Mesh;
use crate::placement::{Placement, of_matrix};

/// A matrix written in single precision is a rotation up to this.
const SINGLE_PRECISION: f64 = 1e-6;

type Matrix = [[f64; 3]; 3];

/// Where a node is in the scene. A [`Placement`] is rigid, so that scale and shear go into the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Transform {
    /// `x -> placement(scale x)`; the scale may be negative, never 0.
    Similar { scale: f64, placement: Placement },
    /// `x -> linear x + translation`.
    Affine { linear: Matrix, translation: [f64; 3] },
}

impl Transform {
    pub(super) const IDENTITY: Self = Self::Similar {
        scale: 1.0,
        placement: Placement::IDENTITY,
    };

    /// First scaled, then turned by the quaternion `[w, x, y, z]`, then moved.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a scale or quaternion of 0 and for numbers that are not finite.
    pub(super) fn new(scale: [f64; 3], quaternion: [f64; 4], translation: [f64; 3]) -> Result<Self, Error> {
        let placement = Placement::from_quaternion(quaternion)?.moved(translation)?;
        if scale.iter().any(|s| *s == 0.0 || !s.is_finite()) {
            return Err(Error::parameter(
                "scale",
                format!("{scale:?}"),
                "finite numbers other than 0",
            ));
        }
        let [x, y, z] = scale;
        if x == y && y == z {
            return Ok(Self::Similar { scale: x, placement });
        }
        Ok(Self::Affine {
            linear: placement.rotation().map(|[a, b, c]| [a * x, b * y, c * z]),
            translation,
        })
    }

    /// First scaled, then turned about the x, y and z axis by `degrees`, in this order, then moved.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a scale of 0 and for numbers that are not finite.
    pub(super) fn of_degrees(translation: [f64; 3], degrees: [f64; 3], scale: f64) -> Result<Self, Error> {
        let mut turned = Placement::IDENTITY;
        for (axis, angle) in Placement::IDENTITY.rotation().into_iter().zip(degrees) {
            if angle != 0.0 {
                turned = turned.then(&Placement::from_axis_angle(axis, angle.to_radians())?)?;
            }
        }
        Self::new([scale; 3], turned.quaternion(), translation)
    }

    /// From the rows of a matrix and a translation. A matrix that is a rotation times a number to single precision
    /// counts as one, so that instances can share a mesh.
    ///
    /// # Errors
    /// [`Error::Parameter`] for numbers that are not finite and for a matrix that flattens bodies.
    pub(super) fn from_matrix(linear: Matrix, translation: [f64; 3]) -> Result<Self, Error> {
        let refuse = || {
            let allowed = "finite numbers, and a matrix that flattens nothing";
            Err(Error::parameter("matrix", format!("{linear:?}"), allowed))
        };
        if linear
            .iter()
            .flatten()
            .chain(&translation)
            .any(|c| !c.is_finite())
        {
            return refuse();
        }
        let determinant = dot(linear[0], cross(linear[1], linear[2]));
        if determinant == 0.0 || !determinant.is_finite() {
            return refuse();
        }
        let scale = determinant.cbrt();
        let rotation = linear.map(|row| row.map(|c| c / scale));
        if !is_rotation(&rotation) {
            return Ok(Self::Affine { linear, translation });
        }
        let placement = Placement::from_quaternion(of_matrix(&rotation))?.moved(translation)?;
        let is_unit = (scale.abs() - 1.0).abs() <= SINGLE_PRECISION;
        Ok(Self::Similar {
            scale: if is_unit { scale.signum() } else { scale },
            placement,
        })
    }

    /// First `self`, then `next`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the translation overflows.
    pub(super) fn then(&self, next: &Self) -> Result<Self, Error> {
        if let (
            Self::Similar { scale, placement },
            Self::Similar {
                scale: next_scale,
                placement: next_placement,
            },
        ) = (self, next)
        {
            let scaled = placement.translation().map(|c| c * next_scale);
            let inner = Placement::from_quaternion(placement.quaternion())?.moved(scaled)?;
            return Ok(Self::Similar {
                scale: scale * next_scale,
                placement: inner.then(next_placement)?,
            });
        }
        let (a, s) = self.parts();
        let (b, t) = next.parts();
        let columns = [0, 1, 2].map(|k| a.map(|row| row[k]));
        let moved = apply(&b, s);
        Ok(Self::Affine {
            linear: b.map(|row| columns.map(|column| dot(row, column))),
            translation: [0, 1, 2].map(|k| moved[k] + t[k]),
        })
    }

    /// The matrix and the translation.
    fn parts(&self) -> (Matrix, [f64; 3]) {
        match *self {
            Self::Similar { scale, placement } => (
                placement.rotation().map(|row| row.map(|c| c * scale)),
                placement.translation(),
            ),
            Self::Affine { linear, translation } => (linear, translation),
        }
    }

    /// What goes into the mesh, and the rigid rest.
    fn split(&self) -> Result<(Matrix, Placement), Error> {
        match *self {
            Self::Similar { scale: s, placement } => {
                Ok(([[s, 0.0, 0.0], [0.0, s, 0.0], [0.0, 0.0, s]], placement))
            }
            Self::Affine { linear, translation } => Ok((linear, Placement::from_translation(translation)?)),
        }
    }
}

/// A mesh by its address, and the bits of a matrix.
type Shape = (usize, [u64; 9]);

/// Meshes in the scales and shears that a scene uses, each made once.
#[derive(Default)]
pub(super) struct Instances {
    /// By the address of the mesh, which is kept alive beside, and the bits of the matrix.
    shaped: BTreeMap<Shape, (Arc<Mesh>, Arc<Mesh>)>,
}

impl Instances {
    /// The mesh shaped as the transform wants it, and the rigid placement that is left.
    ///
    /// # Errors
    /// [`Error::NonFiniteVertex`] or [`Error::Parameter`] if a number overflows.
    pub(super) fn instance(
        &mut self,
        mesh: &Arc<Mesh>,
        transform: &Transform,
    ) -> Result<(Arc<Mesh>, Placement), Error> {
        let (linear, placement) = transform.split()?;
        if linear == Placement::IDENTITY.rotation() {
            return Ok((Arc::clone(mesh), placement));
        }
        let mut bits = [0; 9];
        for (bits, c) in bits.iter_mut().zip(linear.iter().flatten()) {
            *bits = c.to_bits();
        }
        let key = (Arc::as_ptr(mesh) as usize, bits);
        if let Some((_, shaped)) = self.shaped.get(&key) {
            return Ok((Arc::clone(shaped), placement));
        }
        let vertices = mesh.vertices().iter().map(|&p| apply(&linear, p)).collect();
        let shaped = Arc::new(mesh.with_vertices(vertices)?);
        self.shaped.insert(key, (Arc::clone(mesh), Arc::clone(&shaped)));
        Ok((shaped, placement))
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn apply(linear: &Matrix, p: [f64; 3]) -> [f64; 3] {
    linear.map(|row| dot(row, p))
}

/// Whether the rows have length 1 and are perpendicular to each other, to single precision.
fn is_rotation(m: &Matrix) -> bool {
    (0..3).all(|i| {
        (0..=i).all(|j| {
            let expected = if i == j { 1.0 } else { 0.0 };
            (dot(m[i], m[j]) - expected).abs() <= 2.0 * SINGLE_PRECISION
        })
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use proptest::prelude::*;

    use super::*;

    fn at(transform: &Transform, p: [f64; 3]) -> [f64; 3] {
        let (linear, translation) = transform.parts();
        let moved = apply(&linear, p);
        [0, 1, 2].map(|k| moved[k] + translation[k])
    }

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        (0..3).all(|k| (a[k] - b[k]).abs() < 1e-9)
    }

    proptest! {
        #[test]
        fn chains_and_instances_agree_with_matrices(
            scales in prop::array::uniform2(prop::array::uniform3(prop_oneof![0.2..3.0, -2.0..-0.2])),
            uniform in prop::array::uniform2(any::<bool>()),
            quaternions in prop::array::uniform2(prop::array::uniform4(-1.0..1.0_f64)),
            translations in prop::array::uniform2(prop::array::uniform3(-5.0..5.0_f64)),
            p in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            prop_assume!(quaternions.iter().all(|q| q.iter().map(|c| c * c).sum::<f64>() > 0.01));
            let part = |k: usize| {
                let scale = if uniform[k] { [scales[k][0]; 3] } else { scales[k] };
                Transform::new(scale, quaternions[k], translations[k]).unwrap()
            };
            let (first, second) = (part(0), part(1));
            let both = first.then(&second).unwrap();
            let expected = at(&second, at(&first, p));
            prop_assert!(near(at(&both, p), expected));
            if uniform == [true, true] {
                let is_similar = matches!(both, Transform::Similar { .. });
                prop_assert!(is_similar);
            }
            // The same from its matrix.
            let (linear, translation) = first.parts();
            let again = Transform::from_matrix(linear, translation).unwrap();
            prop_assert!(near(at(&again, p), at(&first, p)));
            let same_kind = matches!(again, Transform::Similar { .. }) == matches!(first, Transform::Similar { .. });
            prop_assert!(same_kind || !uniform[0]);

            let mesh = Arc::new(Mesh::new(vec![p], vec![], vec![]).unwrap());
            let mut instances = Instances::default();
            let (shaped, placement) = instances.instance(&mesh, &both).unwrap();
            prop_assert!(near(placement.apply(shaped.vertex(0)), expected));
            prop_assert!(Arc::ptr_eq(&shaped, &instances.instance(&mesh, &both).unwrap().0));
        }
    }

    #[test]
    fn flat_and_infinite_transforms_are_refused() {
        let unit = [1.0, 0.0, 0.0, 0.0];
        for scale in [[0.0; 3], [1.0, 0.0, 1.0], [f64::NAN; 3]] {
            assert!(Transform::new(scale, unit, [0.0; 3]).is_err());
        }
        assert!(Transform::new([1.0; 3], [0.0; 4], [0.0; 3]).is_err());
        assert!(
            Transform::from_matrix([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).is_err()
        );
        assert!(Transform::from_matrix([[f64::NAN; 3]; 3], [0.0; 3]).is_err());
    }
}
