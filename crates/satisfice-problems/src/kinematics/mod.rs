//! Inverse kinematics: all joint angles that bring a hand to its goal.

mod arm;

pub use arm::Arm;
