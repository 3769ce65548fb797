//! The PUMA 560: six joints, eight postures for one pose of the hand.

use core::f64::consts::PI;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Boundary, Error, SatisficingProblem};

use crate::lattice::description;
use crate::number::Number;
use crate::roots::equations::{Equations, functions, root_methods};

const JOINTS: usize = 6;
/// Denavit-Hartenberg parameters a, d in metres, and the twist alpha as (cos, sin).
const LINKS: [(f64, f64, f64, f64); JOINTS] = [
    (0.0, 0.0, 0.0, 1.0),
    (0.4318, 0.0, 1.0, 0.0),
    (0.0203, 0.15005, 0.0, -1.0),
    (0.0, 0.4318, 0.0, 1.0),
    (0.0, 0.0, 0.0, -1.0),
    (0.0, 0.0, 1.0, 0.0),
];
/// One posture of the pose; the others are to be found.
const POSTURE: [f64; JOINTS] = [0.4, 0.6, -0.5, 0.9, 0.8, -0.6];
const LARGEST_THRESHOLD: f64 = 0.02;
const LARGEST_SEPARATION: f64 = 0.1;

/// The eight postures of a PUMA 560 that bring its hand to one pose.
///
/// The unknowns are the six joint angles in [-pi, pi], without the limits of the joints. F is the sum of the squared errors of the position
/// (in m^2) and of the nine entries of the rotation. A hit, F < 0.02, is polished by the Gauss-Newton method; hits more than 0.1
/// rad apart are distinct. The pose is that of the angles (0.4, 0.6, -0.5, 0.9, 0.8, -0.6). Left or right shoulder, elbow up or
/// down, wrist flipped or not: eight isolated postures.
///
/// Source: Pieper 1968; Lee 1982, doi 10.1109/MC.1982.1653917; parameters after Corke, Armstrong-Hélouvry 1994.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::Puma;
/// assert_eq!(Puma::new(0.02, 0.1)?.reference_hits(), Some(8));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Puma {
    equations: Equations,
    description: Description,
}

impl Puma {
    /// The postures with F below `threshold`, farther apart than `separation`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a number is not positive and finite.
    pub fn new(threshold: f64, separation: f64) -> Result<Self, Error> {
        let mut equations = Equations::new(functions!(errors), [(-PI, PI); JOINTS], threshold, separation)?;
        equations.residuals = 12;
        equations.space = equations.space.with_boundary(Boundary::Wrap);
        Ok(Self {
            equations,
            description: description(
                Self::NAME,
                [
                    ("threshold", threshold.to_string()),
                    ("separation", separation.to_string()),
                ],
            ),
        })
    }
}

/// Rotation and position of the hand: three rows of four.
fn pose<N: Number>(angles: &[N]) -> [[N; 4]; 3] {
    let constant = N::constant;
    let mut pose = core::array::from_fn(|row| {
        core::array::from_fn(|column| constant(f64::from(u8::from(row == column))))
    });
    for (angle, (a, d, cos_twist, sin_twist)) in angles.iter().zip(LINKS) {
        let (cos, sin) = (angle.cos(), angle.sin());
        let link = [
            [cos, -sin.times(cos_twist), sin.times(sin_twist), cos.times(a)],
            [sin, cos.times(cos_twist), -cos.times(sin_twist), sin.times(a)],
            [
                constant(0.0),
                constant(sin_twist),
                constant(cos_twist),
                constant(d),
            ],
        ];
        pose = pose.map(|row: [N; 4]| {
            core::array::from_fn(|column| {
                let sum = row[0] * link[0][column] + row[1] * link[1][column] + row[2] * link[2][column];
                if column == 3 { sum + row[3] } else { sum }
            })
        });
    }
    pose
}

fn errors<N: Number>(angles: &[N], errors: &mut [N]) {
    let wanted = pose(&POSTURE).into_iter().flatten();
    for ((error, here), wanted) in errors
        .iter_mut()
        .zip(pose(angles).into_iter().flatten())
        .zip(wanted)
    {
        *error = here.plus(-wanted);
    }
}

impl SatisficingProblem for Puma {
    root_methods!();
}

impl Catalogued for Puma {
    const NAME: &'static str = "puma";
    const SUMMARY: &'static str = "the eight postures of a PUMA 560 for one pose of its hand";
    const SOURCE: &'static str = "Pieper 1968; Lee 1982, doi 10.1109/MC.1982.1653917";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(
            "threshold",
            "level of the sum of squares, delta",
            LARGEST_THRESHOLD,
            1e-20,
            100.0,
        ),
        Parameter::real(
            "separation",
            "distance within which two hits are one posture, in radians",
            LARGEST_SEPARATION,
            1e-6,
            1.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.real("threshold"), params.real("separation"))
    }

    fn reference_hits(&self) -> Option<u64> {
        let sound = self.equations.threshold.total_cmp(&LARGEST_THRESHOLD).is_le()
            && self.equations.separation.total_cmp(&LARGEST_SEPARATION).is_le();
        sound.then_some(8)
    }
}
