#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![doc = include_str!("README.md")]

pub mod arm;
pub mod blob;
pub mod check_point;
pub mod compensate;
pub mod drift;
pub mod effects;
pub mod kinematics;
pub mod measurement;
pub mod parameters;
pub mod position;
pub mod reidentify;
pub mod scalar;
pub mod sensor;
pub mod solve;
pub mod store;
pub mod streaming;
pub mod thermal_lag;
mod words;

// The types of these two are part of the interface.
pub use heapless;
pub use nalgebra;

pub use arm::{Arm, ArmParameters, MAX_JOINTS, State};
pub use compensate::{Compensator, Settings, Task, Tick};
pub use effects::{Approach, Curves};
pub use kinematics::{Chain, JointKind, Link, LinkParameter, MdhParameters, Pose};
pub use position::RealPosition;
pub use scalar::Scalar;
pub use thermal_lag::ThermalLag;

/// A six-joint arm, the usual case.
pub type Arm6<'t, T> = Arm<'t, T, 6>;
/// The parameters of a six-joint arm.
pub type ArmParameters6<'t, T> = ArmParameters<'t, T, 6>;
