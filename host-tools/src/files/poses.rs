use super::csv_text;
use crate::model::Robot;
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
        let mut cells: Vec<String> =
            joints.map(|(j, q)| format!("{:.3}", joint_to_file(kind(j), *q))).collect();
        cells.extend(point_to_mm(&target(q).translation).map(|x| format!("{x:.3}")));
        let sides = directions.get(i).into_iter().flatten();
        cells.extend(sides.map(|side| side.to_string()));
        cells
    };
    csv_text(names.iter().map(String::as_str), poses.iter().enumerate().map(row))
}
