use truearm::JointKind;

use super::points;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Model, Path};
use crate::paths::Compensated;

/// How a Universal Robots controller goes from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Move {
    /// Joints turn together.
    Joints,
    /// The tool moves on a line.
    Line,
}

/// Accelerations and speeds that URScript's manual has as defaults: rad/s^2 and
/// rad/s, m/s^2 and m/s.
const JOINTS: &str = "a=1.4, v=1.05";
const LINE: &str = "a=1.2, v=0.25";

/// A URScript program. Both moves are given joints, so that neither the
/// controller's tool nor its own calibration counts.
///
/// # Errors
/// An arm that is not of six turning joints; a row that is not reached.
pub fn urscript(model: &Model, path: &Path, found: &Compensated, how: Move) -> Result<String> {
    let joints = &model.robot.joints;
    if joints.len() != 6 || joints.iter().any(|j| j.link.kind != JointKind::Revolute) {
        return Err(Error::data(
            ErrorKind::OtherArm,
            format!("{}: URScript moves six turning joints", model.robot.path.display()),
            "write --format csv, or a --template of this robot's language",
        ));
    }
    let (name, speed) = match how {
        Move::Joints => ("movej", JOINTS),
        Move::Line => ("movel", LINE),
    };
    let mut text = "def corrected_path():\n".to_owned();
    for point in points(path, found)? {
        let joints: Vec<String> = point.joints.iter().map(|q| format!("{q:.9}")).collect();
        text += &format!("  {name}([{}], {speed})\n", joints.join(", "));
    }
    Ok(text + "end\ncorrected_path()\n")
}
