//! Kinematics of a serial arm: MD-H links, the chain, its Jacobians, and how
//! far it is from rigid.

mod chain;
mod deflected;
mod deflection;
mod folded_joint;
mod jacobian;
mod link;
mod pose;
mod shared;
mod step;
mod walk;

pub use chain::Chain;
pub use deflection::Deflection;
pub(crate) use folded_joint::{FoldedJoint, Turn, Turns};
pub use jacobian::{IdentificationJacobian, Jacobian, LinkColumns, LinkTurns, Twist};
pub use link::{JointKind, Link, LinkParameter, MdhParameters};
pub use pose::Pose;
pub(crate) use pose::{axes, cross, dot, from_axes, rotate};
pub use step::Step;
pub use walk::Walk;
