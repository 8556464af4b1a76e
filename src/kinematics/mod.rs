//! Rigid kinematics: MD-H links, the chain, its Jacobians.

mod chain;
mod hinge;
mod jacobian;
mod link;
mod pose;

pub use chain::Chain;
pub(crate) use hinge::Joint;
pub use hinge::Turns;
pub use jacobian::{IdentificationJacobian, Jacobian, LinkColumns, Twist};
pub use link::{JointKind, Link, LinkParameter, MdhParameters};
pub use pose::Pose;
pub(crate) use pose::{axis, cross, dot, rotate};
