//! Rows of measurements.csv with a mistake undone.

use truearm::JointKind;

use crate::check::mistake::Mistake;
use crate::files::CsvEdit;
use crate::model::Robot;
use crate::units::joint_column;

/// A change of all these rows; steps are of all rows of a file.
pub fn mend(edit: &mut CsvEdit, robot: &Robot, change: &Mistake, rows: &[usize]) {
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
