//! The units of files and texts: millimetres and degrees. Everything inside is
//! SI; numbers change their unit here, on their way in or out, and nowhere else.

use truearm::JointKind;

/// A joint value in degrees, of a prismatic joint in mm.
#[must_use]
pub fn joint_to_file(kind: JointKind, value: f64) -> f64 {
    match kind {
        JointKind::Revolute => value.to_degrees(),
        JointKind::Prismatic => value * 1e3,
    }
}

/// A joint value from degrees, of a prismatic joint from mm.
#[must_use]
pub fn joint_from_file(kind: JointKind, value: f64) -> f64 {
    match kind {
        JointKind::Revolute => value.to_radians(),
        JointKind::Prismatic => value * 1e-3,
    }
}

/// The unit of a joint value in a text.
#[must_use]
pub const fn joint_unit(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "degrees",
        JointKind::Prismatic => "mm",
    }
}

/// Name of the column of a joint's values, the joint counted from 0: `q1_deg`,
/// `q3_mm`.
#[must_use]
pub fn joint_column(prefix: &str, joint: usize, kind: JointKind) -> String {
    let unit = match kind {
        JointKind::Revolute => "deg",
        JointKind::Prismatic => "mm",
    };
    format!("{prefix}{}_{unit}", joint + 1)
}
