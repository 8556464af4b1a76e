//! What the controller's crate does for N joints, for a number known at run time.
//!
//! `truearm` has arrays of N numbers, and its code is compiled for every N that is asked
//! for. Here it is asked for all of them, 1 to [`truearm::MAX_JOINTS`], once: what the
//! host calls is compiled without numbers of joints, and this changes seldom.

mod arm;
mod joints;
mod law;
mod parameters;

pub use arm::{Conditions, RealArm, real_arm};
pub use joints::fixed;
pub use law::{Applied, Asked, Law, double, single};
pub use parameters::{LinkMasses, Parameters};
