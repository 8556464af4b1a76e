use super::{Point, points};
use crate::error::{Error, Place, Result};
use crate::model::{Model, Path};
use crate::paths::Compensated;

/// What a trajectory needs beside its joints.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timing {
    /// Seconds from row to row, where the path has no column `time_s`.
    pub every: Option<f64>,
    /// Names of the joints; `joint_1` and so on where there are none.
    pub names: Vec<String>,
}

/// A `trajectory_msgs/msg/JointTrajectory` as YAML, positions in rad and m.
///
/// # Errors
/// Times that are missing or do not grow; a number of names that is not that of
/// the joints; a row that is not reached.
pub fn ros2(model: &Model, path: &Path, found: &Compensated, timing: &Timing) -> Result<String> {
    let joints = model.robot.joints.len();
    let names = match &timing.names[..] {
        [] => (1..=joints).map(|j| format!("joint_{j}")).collect(),
        names if names.len() == joints => {
            if let Some(twice) = (1..joints).find(|k| names[..*k].contains(&names[*k])) {
                let what = format!("--joint-names: {} stands twice", names[twice]);
                return Err(Error::usage(what, "give every joint the name it has there"));
            }
            names.to_vec()
        }
        names => {
            return Err(Error::usage(
                format!("--joint-names of {} joints, but the robot has {joints}", names.len()),
                "give a name for every joint, separated by commas",
            ));
        }
    };
    let points = points(path, found)?;
    let times = times(path, &points, timing)?;
    // JSON strings are YAML strings, whatever a name holds.
    let names = names.iter().map(|name| serde_json::Value::from(name.as_str()).to_string());
    let mut text = format!("joint_names: [{}]\npoints:\n", names.collect::<Vec<_>>().join(", "));
    for (point, time) in points.iter().zip(times) {
        let positions: Vec<String> = point.joints.iter().map(|q| format!("{q:.12}")).collect();
        let nanos = (time * 1e9).round() as u64;
        text += &format!(
            "- positions: [{}]\n  time_from_start: {{sec: {}, nanosec: {}}}\n",
            positions.join(", "),
            nanos / 1_000_000_000,
            nanos % 1_000_000_000
        );
    }
    Ok(text)
}

/// Seconds from the start of the motion: the first row is reached after one step,
/// as the robot stands elsewhere before it.
fn times(path: &Path, points: &[Point], timing: &Timing) -> Result<Vec<f64>> {
    if let Some(every) = timing.every {
        if points.len() as f64 * every >= f64::from(i32::MAX) {
            let help = "the last row must be within 68 years: sec is a signed 32-bit number";
            return Err(Error::usage(format!("--every {every:?} is too long"), help));
        }
        return Ok((1..=points.len()).map(|i| i as f64 * every).collect());
    }
    let fail = |line: usize, message: &str| {
        let help =
            "a trajectory needs a growing time_s in every row, from above 0; or --every SECONDS";
        Err(Error::file(&path.data.path, Place::field(line, "time_s"), message, help))
    };
    let (mut times, mut last) = (Vec::new(), 0.0);
    for point in points {
        match point.time {
            None => return fail(point.line, "no time"),
            Some(time) if time < last || (time == last && !times.is_empty()) => {
                return fail(point.line, "the time does not grow");
            }
            // sec is a signed 32-bit number.
            Some(time) if time >= f64::from(i32::MAX) => return fail(point.line, "too late"),
            Some(time) => {
                times.push(time);
                last = time;
            }
        }
    }
    Ok(times)
}
