//! The units of files and texts: millimetres and degrees. Everything inside is
//! SI; numbers change their unit here, on their way in or out, and nowhere else.

use nalgebra::Vector3;
use truearm::{JointKind, LinkParameter};

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

/// Degrees in a radian.
pub const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Millimetres in a metre; also milliradians in a radian.
pub const MILLI: f64 = 1e3;
/// Micrometres in a metre.
pub const MICRO: f64 = 1e6;

/// A length in mm.
#[must_use]
pub fn to_mm(metres: f64) -> f64 {
    metres * 1e3
}

/// A length from mm.
#[must_use]
pub fn from_mm(mm: f64) -> f64 {
    mm * 1e-3
}

/// A point in mm.
#[must_use]
pub fn point_to_mm(point: &Vector3<f64>) -> [f64; 3] {
    [point.x, point.y, point.z].map(to_mm)
}

/// A point from mm.
#[must_use]
pub fn point_from_mm(mm: [f64; 3]) -> Vector3<f64> {
    Vector3::from(mm) * 1e-3
}

/// The unit of a link parameter, and how many of it one of SI is.
#[must_use]
pub fn link_unit(parameter: LinkParameter) -> (&'static str, f64) {
    if parameter.is_length() { ("mm", MILLI) } else { ("deg", DEGREES) }
}
