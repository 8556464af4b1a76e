//! Torques that files read.

use crate::error::{Error, ErrorKind, Result};
use crate::model::{Measurements, Robot};

/// Torques that were read count in place of computed ones: in both files or in none.
///
/// # Errors
/// One file has them, the other does not, and nothing else tells of loads.
pub fn same_torques(robot: &Robot, data: &Measurements, holdout: &Measurements) -> Result<()> {
    let alone = match (data.has_torques(), holdout.has_torques()) {
        (true, false) => holdout,
        (false, true) => data,
        _ => return Ok(()),
    };
    if robot.is_weighed() {
        return Ok(());
    }
    Err(Error::data(
        ErrorKind::NoTorques,
        format!("{}: no columns torque1_nm.., which the other file has", alone.path.display()),
        "springs that one file's torques show say nothing of rows without: give both files the \
         columns, or the robot gravity and [[links]]",
    ))
}
