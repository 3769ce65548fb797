//! Inverse kinematics: all joint angles that bring a hand to its goal.

mod arm;
mod puma;
mod seven_joints;

pub use arm::Arm;
pub use puma::Puma;
pub use seven_joints::SevenJoints;
