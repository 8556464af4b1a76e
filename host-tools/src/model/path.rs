use nalgebra::{Matrix3, Vector3};

use super::Measurements;

/// Where a robot is told to go, row by row: a `path.csv`. SI units, in the
/// coordinates of the files.
#[derive(Debug, Clone)]
pub struct Path {
    /// The state that each row tells; its `q` are the commanded joints, empty
    /// where points were commanded. Nothing was measured.
    pub data: Measurements,
    /// Commanded points, one a row; empty where joints were commanded.
    pub targets: Vec<Target>,
    /// How the rows say where to go.
    pub coordinates: Coordinates,
    /// Names of all columns.
    pub names: Vec<String>,
    /// Their cells as they stand in the file, row by row.
    pub cells: Vec<Vec<String>>,
}

/// Where a tool is to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Its point, m.
    pub point: Vector3<f64>,
    /// Its axes; `None` where only the position counts.
    pub rotation: Option<Matrix3<f64>>,
}

/// How a row of a path says where to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinates {
    /// `q1_deg..`, `qN_mm` of joints that slide.
    Joints,
    /// `x_mm, y_mm, z_mm` alone.
    Point,
    /// The point and `qx, qy, qz, qw`.
    Quaternion,
    /// The point and `roll_deg, pitch_deg, yaw_deg`: turns about the fixed axes
    /// x, then y, then z.
    Rpy,
}

impl Coordinates {
    /// The columns of a tool's pose.
    #[must_use]
    pub fn pose_columns(self) -> &'static [&'static str] {
        match self {
            Self::Rpy => &["x_mm", "y_mm", "z_mm", "roll_deg", "pitch_deg", "yaw_deg"],
            _ => &["x_mm", "y_mm", "z_mm", "qx", "qy", "qz", "qw"],
        }
    }
}
