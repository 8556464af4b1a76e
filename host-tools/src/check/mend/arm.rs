//! The arm of robot.toml with the mistakes undone: what was found, then what nothing measured
//! tells of and is of the same unit.

use nalgebra::{Rotation3, Vector3};
use toml_edit::{DocumentMut, Item, Value};
use truearm::JointKind;

use super::numbers::{nearer, numbers, rescale, set, within_a_turn};
use crate::check::finding::Finding;
use crate::check::mistake::{Convention, Mistake};
use crate::check::scene::undone;
use crate::error::Result;
use crate::files::{not_that_text, tables};
use crate::model::Robot;
use crate::units::{DEGREES, point_to_mm, to_mm};

/// The text with what was found undone.
///
/// # Errors
/// A text that is not the robot's.
pub fn mended(robot: &Robot, text: &str, finding: &Finding) -> Result<String> {
    let other = || not_that_text(&robot.path);
    let mut document: DocumentMut = text.parse().map_err(|_| other())?;
    let now = undone(robot, &finding.changes);
    let mut joints = tables(&mut document, "joints");
    if joints.len() != robot.joints.len() {
        return Err(other());
    }
    for ((table, stated), joint) in joints.iter_mut().zip(&robot.joints).zip(&now.joints) {
        let (then, now) = (&stated.link.parameters, &joint.link.parameters);
        let along = match joint.link.kind {
            JointKind::Revolute => "d_mm",
            JointKind::Prismatic => "d_offset_mm",
        };
        let numbers = [
            ("alpha_deg", then.alpha, now.alpha, DEGREES),
            ("a_mm", then.a, now.a, 1e3),
            ("theta_offset_deg", then.theta, now.theta, DEGREES),
            (along, then.d, now.d, 1e3),
        ];
        for (key, then, now, unit) in numbers {
            if then != now {
                set(*table, key, within_a_turn(key, now * unit).into());
            }
        }
    }
    if let Some(scale) = robot_unit(finding) {
        other_lengths_mended(&mut document, scale, to_mm(now.reach()));
    }
    if finding.changes.contains(&Mistake::RobotAngles) {
        other_angles_mended(&mut document);
    }
    let tool = tool_mended(robot, &now, finding);
    if tool != robot.tool {
        set_tool(&mut document, "xyz_mm", point_to_mm(&tool));
    }
    if let Some(turn) = finding.changes.iter().find_map(|c| turned_tool(robot, c)) {
        set_tool(&mut document, "rpy_deg", turn.map(|angle| angle * DEGREES));
    }
    Ok(document.to_string())
}

/// What lengths of robot.toml must be multiplied by, if they are in another unit.
fn robot_unit(finding: &Finding) -> Option<f64> {
    finding.changes.iter().find_map(|c| match c {
        Mistake::RobotUnit(unit) => Some(unit.millimetres()),
        _ => None,
    })
}

/// Noise of a tracker, mm, that tells by its size in what unit another was stated.
const OF_A_TRACKER: f64 = 0.05;

/// From so many mm a unit is a metre: what nothing measured tells of is of the arm's unit or
/// not, beyond doubt. Of centimetres and inches it stays, and that is said.
const PLAIN: f64 = 100.0;

/// Whether robot.toml may have lengths in the arm's unit that were left as they are.
#[must_use]
pub fn leaves_lengths(finding: &Finding) -> bool {
    robot_unit(finding).is_some_and(|scale| scale < PLAIN)
}

/// The lengths that nothing measured tells of, where in the other unit they are nearer to what
/// an arm of this reach, mm, has: a centre of mass a tenth of it away, the noise of a tracker,
/// a tolerance of 1 mm.
fn other_lengths_mended(document: &mut DocumentMut, scale: f64, reach: f64) {
    if scale < PLAIN {
        return;
    }
    rescale(document.as_table_mut(), "measurement_sigma_mm", (scale, OF_A_TRACKER));
    for key in ["links", "payload"] {
        let all: Vec<_> =
            tables(document, key).iter().filter_map(|t| numbers(*t, "com_mm")).collect();
        let far = all.iter().flatten().fold(0.0_f64, |far, x| far.max(x.abs()));
        if nearer(far, (scale, 0.1 * reach)) {
            for table in tables(document, key) {
                rescale(table, "com_mm", (scale, f64::INFINITY));
            }
        }
    }
    for table in tables(document, "base") {
        rescale(table, "xyz_mm", (scale, reach));
    }
    for joint in tables(document, "joints") {
        rescale(joint, "limits_mm", (scale, reach));
        if let Some(tolerance) = joint.get_mut("tolerance").and_then(Item::as_table_like_mut) {
            for key in ["a_mm", "d_mm", "d_offset_mm"] {
                rescale(tolerance, key, (scale, 1.0));
            }
        }
    }
}

/// The angles that nothing measured tells of: all of a file in radians are within a turn.
fn other_angles_mended(document: &mut DocumentMut) {
    for key in ["base", "tool"] {
        for table in tables(document, key) {
            let all = numbers(table, "rpy_deg").unwrap_or_default();
            if all.iter().all(|angle| angle.abs() <= std::f64::consts::TAU) {
                rescale(table, "rpy_deg", (DEGREES, f64::INFINITY));
            }
        }
    }
    for joint in tables(document, "joints") {
        if let Some(tolerance) = joint.get_mut("tolerance").and_then(Item::as_table_like_mut) {
            for key in ["alpha_deg", "theta_offset_deg", "beta_deg"] {
                rescale(tolerance, key, (DEGREES, 1e-3 * DEGREES));
            }
        }
    }
}

/// Where units were wrong the tool may have been typed in them as well: it is
/// what was seen that tells.
fn tool_mended(stated: &Robot, now: &Robot, finding: &Finding) -> Vector3<f64> {
    match robot_unit(finding) {
        Some(scale) => {
            let far = |tool: Vector3<f64>| (tool - finding.tool).norm();
            let scaled = stated.tool * scale;
            if far(scaled) < far(now.tool) { scaled } else { now.tool }
        }
        None => now.tool,
    }
}

/// How the target's frame is turned once the last alpha belongs to the tool.
fn turned_tool(robot: &Robot, change: &Mistake) -> Option<[f64; 3]> {
    let Mistake::Convention(Convention::Standard) = change else { return None };
    let alpha = robot.joints.last()?.link.parameters.alpha;
    if alpha == 0.0 {
        return None;
    }
    let [r, p, y] = [robot.tool_rpy.x, robot.tool_rpy.y, robot.tool_rpy.z];
    let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), alpha)
        * Rotation3::from_euler_angles(r, p, y);
    Some(turn.euler_angles().into())
}

fn set_tool(document: &mut DocumentMut, key: &str, numbers: [f64; 3]) {
    let value: Value = numbers.map(|x| within_a_turn(key, x)).into_iter().collect();
    let tool = document.entry("tool").or_insert_with(toml_edit::table);
    if let Some(tool) = tool.as_table_like_mut() {
        set(tool, key, value);
    }
}
