//! URDF in and out.

mod bodies;
mod chain;
mod document;
mod patch;
mod robot;
mod write;

pub use chain::{Ends, Moving, Serial};
pub use document::Document;
pub use patch::calibrated_like;
pub use robot::{FromUrdf, robot_of_urdf};
pub use write::urdf_text;

use nalgebra::Vector3;
use truearm::Pose;

use crate::model::Placement;

/// `xyz` in m, `rpy` in rad about fixed axes, as an `<origin>` has them.
fn origin(pose: &urdf_rs::Pose) -> Pose<f64> {
    Placement { xyz: Vector3::from(*pose.xyz), rpy: Vector3::from(*pose.rpy) }.pose()
}
