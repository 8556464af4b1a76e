//! The kinematics file of Universal Robots' ROS packages: what `ur_calibration`
//! extracts from a controller and `ur_description` takes as `kinematics_params`.

use truearm::{JointKind, Pose};

use super::Identified;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Placement, Robot};
use crate::units::to_mm;

/// The links as that file calls them.
const LINKS: [&str; 6] = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];
/// The twists of every arm of the family, degrees.
const TWISTS: [f64; 6] = [0.0, 90.0, 0.0, 0.0, 90.0, -90.0];
/// What the driver reads where no hash of a controller was given: one that no
/// controller has.
const NO_HASH: &str = "calib_not_of_a_controller";

/// The file's text. `hash` is the controller's own, as `ur_calibration` wrote it
/// into the file that this one replaces; without it the driver will report that
/// the calibration is not the controller's, which is true.
///
/// Lengths m, angles rad, every frame in the one before. The last frame is
/// `tool0`, where d of joint 6 puts it: the tool behind it has no place here.
///
/// # Errors
/// An arm that is not built as these are.
pub fn ur_calibration(robot: &Robot, arm: &Identified, hash: Option<&str>) -> Result<String> {
    check(robot)?;
    let mut text = String::from("kinematics:\n");
    for (name, frame) in LINKS.iter().zip(arm.steps()) {
        text += &format!("  {name}:\n{}", entry(&frame));
    }
    Ok(text + &format!("  hash: {}\n", hash.unwrap_or(NO_HASH)))
}

fn entry(frame: &Pose<f64>) -> String {
    let Placement { xyz, rpy } = Placement::of(frame);
    let values = [xyz.x, xyz.y, xyz.z, rpy.x, rpy.y, rpy.z];
    let names = ["x", "y", "z", "roll", "pitch", "yaw"];
    names
        .iter()
        .zip(values)
        .map(|(name, value)| format!("    {name}: {:?}\n", value + 0.0))
        .collect()
}

/// Whether an arm is built as those of the family.
fn check(robot: &Robot) -> Result<()> {
    let fail = |message: String| {
        let help = "this file is only for Universal Robots' arms in their own joint frames, as of \
                    `truearm robot --preset ur10e` or --urdf with --base-link base_link_inertia; for \
                    others use --urdf";
        Err(Error::data(ErrorKind::Refused, message, help))
    };
    if robot.joints.len() != LINKS.len() {
        return fail(format!("{} joints where a UR has 6", robot.joints.len()));
    }
    for (i, (joint, twist)) in robot.joints.iter().zip(TWISTS).enumerate() {
        let p = &joint.link.parameters;
        let n = i + 1;
        if joint.link.kind != JointKind::Revolute {
            return fail(format!("joint {n} is prismatic; a UR has none"));
        }
        if (p.alpha.to_degrees() - twist).abs() > 1.0 {
            let alpha = p.alpha.to_degrees();
            return fail(format!("joint {n} has alpha_deg = {alpha:.3} where a UR has {twist}"));
        }
        if p.theta.to_degrees().abs() > 1.0 || p.beta.to_degrees().abs() > 1.0 {
            return fail(format!("joint {n} has a theta_offset_deg or beta_deg; a UR has none"));
        }
        let long = matches!(i, 2 | 3);
        if long != (p.a < -0.05) || (!long && p.a.abs() > 0.005) {
            let a = to_mm(p.a);
            let usual = if long { "a negative length" } else { "none" };
            return fail(format!("joint {n} has a_mm = {a:.3} where a UR has {usual}"));
        }
    }
    Ok(())
}
