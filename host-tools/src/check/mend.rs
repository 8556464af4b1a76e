//! The user's two files with the mistakes undone, everything else as it was.

use nalgebra::{Rotation3, Vector3};
use toml_edit::{DocumentMut, Item, TableLike, Value};
use truearm::JointKind;

use super::mistake::{Convention, Mistake};
use super::words::tidy;
use super::{Finding, undone};
use crate::error::Result;
use crate::files::{CsvEdit, not_that_text, tables};
use crate::model::{Measurements, Robot};
use crate::units::{DEGREES, joint_column, point_to_mm, to_mm};

/// What the first line of a mended file begins with.
pub const MENDED: &str = "# truearm check: ";

/// The two texts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mended {
    /// `robot.toml`
    pub robot: String,
    /// `measurements.csv`
    pub measurements: String,
}

/// Undoes the mistakes in the texts that robot and measurements were read from.
///
/// # Errors
/// Texts that are not those.
pub fn mend(
    (robot, robot_text): (&Robot, &str),
    (data, data_text): (&Measurements, &str),
    finding: &Finding,
) -> Result<Mended> {
    let (of_data, of_robot): (Vec<_>, Vec<_>) =
        finding.changes.iter().zip(&finding.said).partition(|(change, _)| change.of_data());
    let remarks = |said: &[(&Mistake, &super::Said)]| {
        said.iter().map(|(_, said)| format!("{MENDED}{said}; mended\n")).collect::<String>()
    };
    let mut texts = Mended { robot: robot_text.to_owned(), measurements: data_text.to_owned() };
    if !of_robot.is_empty() {
        texts.robot = remarks(&of_robot) + &robot_mended(robot, robot_text, finding)?;
    }
    if !of_data.is_empty() {
        let mut ordered: Vec<&Mistake> = of_data.iter().map(|(change, _)| *change).collect();
        ordered.sort_by_key(|change| change.rank());
        let mut edit = CsvEdit::new(&data.path, data_text)?;
        let rows: Vec<usize> = match finding.only_rows() {
            // Rows are known by their place: none may be missing.
            Some(_) if edit.rows() != data.rows.len() => return Err(not_that_text(&data.path)),
            Some(rows) => rows.to_vec(),
            None => (0..edit.rows()).collect(),
        };
        ordered.iter().for_each(|change| rows_mended(&mut edit, robot, change, &rows));
        texts.measurements = remarks(&of_data) + &edit.finish();
    }
    Ok(texts)
}

impl Mistake {
    /// Whether measurements.csv is mended; else robot.toml is.
    pub(super) fn of_data(&self) -> bool {
        !matches!(
            self,
            Self::Convention(_) | Self::RobotUnit(_) | Self::RobotAngles | Self::Value(..)
        )
    }
}

/// A change of all these rows; steps are of all rows of a file.
fn rows_mended(edit: &mut CsvEdit, robot: &Robot, change: &Mistake, rows: &[usize]) {
    let kinds: Vec<JointKind> = robot.joints.iter().map(|j| j.link.kind).collect();
    let joints: Vec<Option<usize>> = kinds
        .iter()
        .enumerate()
        .map(|(j, kind)| edit.column(&joint_column("q", j, *kind)))
        .collect();
    let sides: Vec<Option<usize>> =
        (1..=kinds.len()).map(|j| edit.column(&format!("dir{j}"))).collect();
    let of_kind = |of: JointKind| {
        joints.iter().zip(&kinds).filter(move |(_, k)| **k == of).filter_map(|(c, _)| *c)
    };
    let points = || ["x_mm", "y_mm", "z_mm"];
    match change {
        Mistake::Step(step) => stepped(edit, *step, joints.iter().chain(&sides).flatten()),
        Mistake::JointUnit(unit) => {
            scaled(edit, rows, of_kind(JointKind::Revolute), unit.degrees())
        }
        Mistake::SlideUnit(unit) => {
            scaled(edit, rows, of_kind(JointKind::Prismatic), unit.millimetres());
        }
        Mistake::PointUnit(unit) => {
            let columns: Vec<usize> = points().iter().filter_map(|c| edit.column(c)).collect();
            scaled(edit, rows, columns.into_iter(), unit.millimetres());
        }
        // With the points their orientation is seen in a mirror.
        Mistake::Hand => {
            let columns: Vec<usize> =
                ["z_mm", "qx", "qy"].iter().filter_map(|c| edit.column(c)).collect();
            negated(edit, rows, columns);
        }
        Mistake::Order(order) => {
            permuted(edit, rows, &joints, order);
            permuted(edit, rows, &sides, order);
        }
        Mistake::Sense(joint) => {
            negated(edit, rows, [joints[*joint], sides[*joint]].into_iter().flatten());
        }
        Mistake::Convention(_)
        | Mistake::RobotUnit(_)
        | Mistake::RobotAngles
        | Mistake::Value(..) => {}
    }
}

/// Cells of these columns from the row before or after.
fn stepped<'a>(edit: &mut CsvEdit, step: isize, columns: impl Iterator<Item = &'a usize>) {
    let (rows, down) = (edit.rows(), step > 0);
    for column in columns {
        let cells: Vec<String> = (0..rows).map(|r| edit.cell(r, *column).to_owned()).collect();
        for row in 0..rows {
            let from = if down { row + 1 } else { row.wrapping_sub(1) };
            if let Some(cell) = cells.get(from) {
                edit.set(row, *column, cell.as_str());
            }
        }
    }
    // Nobody knows the joints of the row at the end.
    edit.drop_row(if down { rows.saturating_sub(1) } else { 0 });
}

fn permuted(edit: &mut CsvEdit, rows: &[usize], columns: &[Option<usize>], order: &[usize]) {
    for row in rows.iter().copied() {
        let cell = |column: &Option<usize>| column.map(|c| edit.cell(row, c).to_owned());
        let cells: Vec<Option<String>> = columns.iter().map(cell).collect();
        for (column, from) in columns.iter().zip(order) {
            if let Some(column) = column {
                edit.set(row, *column, cells[*from].clone().unwrap_or_default());
            }
        }
    }
}

fn scaled(edit: &mut CsvEdit, rows: &[usize], columns: impl Iterator<Item = usize>, factor: f64) {
    for column in columns {
        for row in rows.iter().copied() {
            if let Ok(value) = edit.cell(row, column).parse::<f64>() {
                // Nine decimals: a picometre, a nanodegree.
                let now = (value * factor * 1e9).round() / 1e9;
                edit.set(row, column, format!("{now}"));
            }
        }
    }
}

/// The same digits with the other sign; nought has none.
fn negated(edit: &mut CsvEdit, rows: &[usize], columns: impl IntoIterator<Item = usize>) {
    for column in columns {
        for row in rows.iter().copied() {
            let cell = edit.cell(row, column);
            let now = match (cell.strip_prefix('-'), cell.parse::<f64>()) {
                (_, Err(_) | Ok(0.0)) => continue,
                (Some(digits), _) => digits.to_owned(),
                (None, _) => format!("-{}", cell.strip_prefix('+').unwrap_or(cell)),
            };
            edit.set(row, column, now);
        }
    }
}

fn robot_mended(robot: &Robot, text: &str, finding: &Finding) -> Result<String> {
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

/// Noise of a tracker, mm.
const USUAL_SIGMA: f64 = 0.05;

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
    rescale(document.as_table_mut(), "measurement_sigma_mm", (scale, USUAL_SIGMA));
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

/// Whether a length is nearer to the usual one once it is scaled; always, where there is none.
fn nearer(length: f64, (scale, usual): (f64, f64)) -> bool {
    let farther = |length: f64| (length / usual).ln().abs();
    length > 0.0 && (usual.is_infinite() || farther(length * scale) < farther(length))
}

/// Scales the numbers of a key where they are then nearer to the usual one.
fn rescale(table: &mut dyn TableLike, key: &str, by: (f64, f64)) {
    let Some(all) = numbers(table, key) else { return };
    let far = all.iter().fold(0.0_f64, |far, x| far.max(x.abs()));
    if nearer(far, by) {
        let scaled = all.iter().map(|x| scaled_number(*x, by.0));
        let single = table.get(key).is_some_and(|item| item.as_array().is_none());
        let value = if single { scaled.clone().next() } else { None };
        set(table, key, value.unwrap_or_else(|| scaled.collect()));
    }
}

/// The numbers of a key: one, or a list.
fn numbers(table: &dyn TableLike, key: &str) -> Option<Vec<f64>> {
    let item = table.get(key)?;
    match item.as_array() {
        Some(all) => all.iter().map(|v| number(&Item::Value(v.clone()))).collect(),
        None => number(item).map(|one| vec![one]),
    }
}

/// A number of a file, whole or not.
fn number(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64))
}

/// Nine decimals: a picometre.
fn scaled_number(value: f64, scale: f64) -> Value {
    ((value * scale * 1e9).round() / 1e9).into()
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

/// A file's angles are within a turn.
fn within_a_turn(key: &str, value: f64) -> f64 {
    let angle = key.ends_with("_deg") && value.abs() > 180.0;
    let value = if angle { value - 360.0 * (value / 360.0).round() } else { value };
    tidy(value).parse().unwrap_or(value)
}

/// Another value of a key; blanks and comments around it stay.
fn set(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(stood) => {
            *value.decor_mut() = stood.decor().clone();
            *stood = value;
        }
        None => {
            table.insert(key, Item::Value(value));
        }
    }
}

fn set_tool(document: &mut DocumentMut, key: &str, numbers: [f64; 3]) {
    let value: Value = numbers.map(|x| within_a_turn(key, x)).into_iter().collect();
    let tool = document.entry("tool").or_insert_with(toml_edit::table);
    if let Some(tool) = tool.as_table_like_mut() {
        set(tool, key, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_keeps_what_stands_around_it() {
        let text = "# arm\njoints = [\n  { alpha_deg = 0, a_mm = 12.5 }, # first\n]\n";
        let mut document: DocumentMut = text.parse().unwrap();
        set(tables(&mut document, "joints")[0], "a_mm", (-12.5).into());
        assert_eq!(document.to_string(), text.replace("12.5", "-12.5"));
        let text = "[[joints]]\na_mm   =  12.5  # by hand\n\n[[joints]]\na_mm = 1\n";
        let mut document: DocumentMut = text.parse().unwrap();
        set(tables(&mut document, "joints")[0], "a_mm", 25.0.into());
        assert_eq!(document.to_string(), text.replace("12.5", "25.0"));
    }
}
