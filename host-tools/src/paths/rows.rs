//! Rows as lines of a CSV file. What is written takes the place of a column of
//! the same name; everything else of the input is carried along as it stood.

use nalgebra::{Rotation3, UnitQuaternion};
use truearm::{JointKind, Pose};

use super::compensate::{Compensated, Row};
use super::inverse::Found;
use crate::error::{Error, Place, Result};
use crate::files::csv_text;
use crate::model::{Coordinates, Path, Robot};
use crate::units::{End, joint_column, joint_to_file_at, point_to_mm, to_mm};

/// What an input column is called that one of the output has taken the name of.
const INPUT: &str = "input_";
/// What `compensate` says of a row.
const SAID: [&str; 4] = ["left_mm", "left_deg", "clamped", "covered"];

/// Names of the columns of the joints.
pub(super) fn joint_columns(kinds: &[JointKind]) -> Vec<String> {
    kinds.iter().enumerate().map(|(j, kind)| joint_column("q", j, *kind)).collect()
}

fn kinds(robot: &Robot) -> Vec<JointKind> {
    robot.joints.iter().map(|joint| joint.link.kind).collect()
}

/// All digits of joint values: a limit is read again as it was, and nothing beyond it.
pub(super) fn joint_cells(kinds: &[JointKind], q: &[f64]) -> Vec<String> {
    let cell = |(q, kind): (&f64, &JointKind)| joint_to_file_at(*kind, *q, End::Up).to_string();
    q.iter().zip(kinds).map(cell).collect()
}

/// A pose in the columns of [`Coordinates::pose_columns`], as numbers.
pub(super) fn pose_numbers(pose: &Pose<f64>, coordinates: Coordinates) -> Vec<f64> {
    let rotation = Rotation3::from_matrix_unchecked(pose.rotation);
    let turn = match coordinates {
        Coordinates::Rpy => {
            let (roll, pitch, yaw) = rotation.euler_angles();
            vec![roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees()]
        }
        _ => {
            let q = UnitQuaternion::from_rotation_matrix(&rotation);
            vec![q.i, q.j, q.k, q.w]
        }
    };
    point_to_mm(&pose.translation).into_iter().chain(turn).collect()
}

/// Points to 0.1 nm, angles and quaternions to a hundred times less than that moves.
fn pose_cells(pose: &Pose<f64>, coordinates: Coordinates) -> Vec<String> {
    let numbers = pose_numbers(pose, coordinates);
    let digits = |i: usize| if i < 3 { 7 } else { 12 };
    numbers.iter().enumerate().map(|(i, x)| format!("{x:.*}", digits(i))).collect()
}

/// What is left, never less than it is: to 1 nm or a millionth of a degree, up, with
/// room for the digits of two poses.
fn upward(left: f64) -> String {
    format!("{:.6}", ((left + 2.5e-7) * 1e6).ceil() / 1e6)
}

/// Columns of the input that are carried along, and their names now.
///
/// # Errors
/// A column whose new name is taken as well.
fn carried(path: &Path, written: &[String], dropped: &[String]) -> Result<Vec<(usize, String)>> {
    let mut out = Vec::new();
    for (i, name) in path.names.iter().enumerate() {
        if dropped.contains(name) {
            continue;
        }
        let taken = written.contains(name);
        let name = if taken { format!("{INPUT}{name}") } else { name.clone() };
        if taken && path.names.contains(&name) {
            return Err(Error::file(
                &path.data.path,
                Place::line(1),
                format!("column {name} stands there already"),
                "it would be written anew; rename or delete it",
            ));
        }
        out.push((i, name));
    }
    Ok(out)
}

fn lines(
    path: &Path,
    written: Vec<String>,
    dropped: &[String],
    rows: impl Iterator<Item = Vec<String>>,
) -> Result<String> {
    let carried = carried(path, &written, dropped)?;
    let names: Vec<&str> =
        written.iter().chain(carried.iter().map(|(_, name)| name)).map(String::as_str).collect();
    let rows = rows.zip(&path.cells).zip(&path.data.rows).map(|((mut row, cells), input)| {
        let unlike = |cell: &String| cell.parse().ok().filter(|x: &f64| !x.is_finite());
        if let Some((name, x)) = written.iter().zip(&row).find_map(|(n, c)| Some((n, unlike(c)?))) {
            let line = format!("{}, line {}: {name}", path.data.path.display(), input.line);
            return Err(Error::not_finite(&line, x));
        }
        row.extend(carried.iter().map(|(i, _)| cells.get(*i).cloned().unwrap_or_default()));
        Ok(row)
    });
    Ok(csv_text(names, rows.collect::<Result<Vec<_>>>()?))
}

/// The joints of a path as they stood, and the poses of the tool there.
///
/// # Errors
/// A column `input_..` that would be written twice; a result that is no number.
pub fn forward_csv(path: &Path, robot: &Robot, poses: &[Pose<f64>]) -> Result<String> {
    let joints = joint_columns(&kinds(robot));
    let at: Vec<usize> =
        joints.iter().filter_map(|name| path.names.iter().position(|n| n == name)).collect();
    let pose = Coordinates::Quaternion;
    let names = joints.iter().cloned().chain(pose.pose_columns().iter().map(|n| (*n).to_owned()));
    let rows = poses.iter().zip(&path.cells).map(|(found, cells)| {
        let joints = at.iter().map(|i| cells[*i].clone());
        joints.chain(pose_cells(found, pose)).collect()
    });
    lines(path, names.collect(), &joints, rows)
}

/// The joints of a path of poses; empty where a pose was not reached.
///
/// # Errors
/// A column `input_..` that would be written twice; a result that is no number.
pub fn inverse_csv(path: &Path, robot: &Robot, found: &[Found]) -> Result<String> {
    let kinds = kinds(robot);
    let mut names = joint_columns(&kinds);
    names.push("reached".to_owned());
    let rows = found.iter().map(|found| {
        let mut cells = match found.is_reached() {
            true => joint_cells(&kinds, &found.joints),
            false => vec![String::new(); kinds.len()],
        };
        cells.push(found.is_reached().to_string());
        cells
    });
    lines(path, names, &[], rows)
}

/// Corrected joints, what is left, and of a path of poses where the controller
/// then believes its tool to be.
///
/// # Errors
/// A path that was compensated before.
pub fn compensated_csv(path: &Path, robot: &Robot, found: &Compensated) -> Result<String> {
    if let Some(name) = SAID.iter().find(|name| path.names.iter().any(|n| n == *name)) {
        return Err(Error::file(
            &path.data.path,
            Place::line(1),
            format!("column {name}: this path was compensated before"),
            "compensate what the robot is to do, not what it was told; or rename the column",
        ));
    }
    let kinds = kinds(robot);
    let joints = joint_columns(&kinds);
    let pose = (path.coordinates != Coordinates::Joints).then_some(path.coordinates);
    let pose_columns = pose.map_or(&[][..], Coordinates::pose_columns);
    let pose_columns: Vec<String> = pose_columns.iter().map(|n| (*n).to_owned()).collect();
    let said = SAID.map(str::to_owned);
    let names: Vec<String> = joints.iter().chain(&said).chain(&pose_columns).cloned().collect();
    let own: Vec<Option<usize>> =
        joints.iter().map(|name| path.names.iter().position(|n| n == name)).collect();
    let rows = found.rows.iter().zip(&path.cells).map(|(row, cells)| match row {
        Row::NotReached(_) => {
            let mut out = vec![String::new(); names.len()];
            out[joints.len() + 2] = "false".to_owned();
            out[joints.len() + 3] = "false".to_owned();
            out
        }
        Row::Corrected { command, joints, believed, left, clamped, covered, .. } => {
            let mut out = joint_cells(&kinds, joints);
            for (j, cell) in out.iter_mut().enumerate() {
                // What is not corrected stays as it was written.
                if let (true, Some(at), None) = (joints[j] == command[j], own[j], pose) {
                    cell.clone_from(&cells[at]);
                }
            }
            out.extend([upward(to_mm(left[0])), upward(left[1].to_degrees())]);
            out.extend([clamped.to_string(), covered.to_string()]);
            out.extend(pose.iter().flat_map(|c| pose_cells(believed, *c)));
            out
        }
    });
    let dropped: Vec<String> = names.iter().filter(|n| path.names.contains(n)).cloned().collect();
    lines(path, names.clone(), &dropped, rows)
}
