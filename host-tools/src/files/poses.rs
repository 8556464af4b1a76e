use super::csv_text;
use crate::model::{PlannedRow, Robot};
use crate::observations::Kind;
use crate::units::{joint_column, joint_to_file, point_to_mm};

/// Poses as lines of a CSV file: a column a joint, named after `prefix`, where
/// the nominal target then is in the robot's frame, and the side that each joint
/// is to come from, unless `directions` is empty.
#[must_use]
pub fn poses_csv(
    robot: &Robot,
    prefix: &str,
    poses: &[Vec<f64>],
    directions: &[Vec<i8>],
) -> String {
    let target = robot.nominal_target();
    let kind = |j: usize| robot.joints[j].link.kind;
    let joints = 0..robot.joints.len();
    let mut names: Vec<String> = joints.map(|j| joint_column(prefix, j, kind(j))).collect();
    names.extend(["nominal_x_mm", "nominal_y_mm", "nominal_z_mm"].map(str::to_owned));
    let sides = directions.first().map_or(0, Vec::len);
    names.extend((1..=sides).map(|joint| format!("dir{joint}")));
    let row = |(i, q): (usize, &Vec<f64>)| {
        let joints = q.iter().enumerate();
        let mut cells: Vec<String> = joints.map(|(j, q)| planned_joint(robot, j, *q, 3)).collect();
        cells.extend(point_to_mm(&target(q).translation).map(|x| format!("{x:.3}")));
        let sides = directions.get(i).into_iter().flatten();
        cells.extend(sides.map(|side| side.to_string()));
        cells
    };
    csv_text(names.iter().map(String::as_str), poses.iter().enumerate().map(row))
}

/// A joint value with so many digits, rounded inwards at a limit.
fn planned_joint(robot: &Robot, joint: usize, q: f64, digits: usize) -> String {
    let kind = robot.joints[joint].link.kind;
    let value = joint_to_file(kind, q);
    let step = 0.1_f64.powi(digits as i32);
    let beyond = |shown: &str, low: f64, high: f64| {
        let shown: f64 = shown.parse().unwrap_or(value);
        if shown < low {
            step
        } else if shown > high {
            -step
        } else {
            0.0
        }
    };
    let shown = format!("{value:.digits$}");
    let inwards = robot.joints[joint].limits.map_or(0.0, |limits| {
        let [low, high] = limits.map(|limit| joint_to_file(kind, limit));
        beyond(&shown, low, high)
    });
    if inwards == 0.0 { shown } else { format!("{:.digits$}", value + inwards) }
}

/// Digits of a joint value where the target is to be in one place: 1e-5 degrees or mm.
const DIGITS: usize = 5;

/// Measurements of a kind to be made, as lines of a measurements.csv: joint values, the
/// kind, the labels of what is measured on, the columns of its readings, which are empty,
/// and where the nominal target then is. Rows of one measurement have its number, from 1,
/// in the column that joins them. Where the joints themselves are read, at contact, those
/// that are planned stand apart, and what is read is empty.
#[must_use]
pub fn planned_csv(robot: &Robot, kind: &dyn Kind, measurements: &[Vec<PlannedRow>]) -> String {
    let target = robot.nominal_target();
    let joint = |j: usize| robot.joints[j].link.kind;
    let number = kind.joined_by().or(kind.labels().contains(&"image").then_some("image"));
    let used = |label: &&&str| {
        let mut rows = measurements.iter().flatten();
        Some(**label) == number || rows.any(|row| row.labels.iter().any(|(l, _)| l == *label))
    };
    let labels: Vec<&str> = kind.labels().iter().filter(used).copied().collect();
    let readings = kind.columns().iter().map(|column| column.name);
    let at_contact = kind.columns().is_empty();
    let of_joints = |prefix: &str| -> Vec<String> {
        (0..robot.joints.len()).map(|j| joint_column(prefix, j, joint(j))).collect()
    };
    let mut names = of_joints(if at_contact { "planned" } else { "q" });
    if at_contact {
        names.extend(of_joints("q"));
    }
    names.push("kind".to_owned());
    names.extend(labels.iter().copied().chain(readings.clone()).map(str::to_owned));
    names.extend(["nominal_x_mm", "nominal_y_mm", "nominal_z_mm"].map(str::to_owned));
    let row = |(i, row): (usize, &PlannedRow)| {
        let joints = row.q.iter().enumerate();
        let mut cells: Vec<String> =
            joints.map(|(j, q)| planned_joint(robot, j, *q, DIGITS)).collect();
        if at_contact {
            cells.extend(row.q.iter().map(|_| String::new()));
        }
        cells.push(kind.name().to_owned());
        cells.extend(labels.iter().map(|column| {
            let own = row.labels.iter().find(|(l, _)| l == column).map(|(_, label)| label.clone());
            own.unwrap_or_else(|| match Some(*column) == number {
                true => (i + 1).to_string(),
                false => String::new(),
            })
        }));
        cells.extend(readings.clone().map(|_| String::new()));
        cells.extend(point_to_mm(&target(&row.q).translation).map(|x| format!("{x:.3}")));
        cells
    };
    let rows = measurements.iter().enumerate();
    let rows = rows.flat_map(|(i, rows)| rows.iter().map(move |row| (i, row))).map(row);
    csv_text(names.iter().map(String::as_str), rows)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// What is written may be read: never beyond a limit by rounding, never farther
        /// than one step from what was planned.
        #[test]
        fn planned_joints_are_within_their_limits(
            (low, width) in (-3.0..3.0_f64, 0.01..3.0_f64),
            share in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0],
            digits in 3..=5_usize,
        ) {
            let limits = [low, low + width].map(f64::to_degrees);
            let text = include_str!("../../../tests/data/seed-table-8/robot.toml");
            let mut robot = Robot::parse(Path::new("robot.toml"), text).unwrap();
            robot.joints[0].limits = Some([low, low + width]);
            let q = (low + share * width).min(low + width);
            let shown: f64 = planned_joint(&robot, 0, q, digits).parse().unwrap();
            prop_assert!((limits[0]..=limits[1]).contains(&shown), "{shown} {limits:?}");
            prop_assert!((shown - q.to_degrees()).abs() <= 0.1_f64.powi(digits as i32));
        }
    }
}
