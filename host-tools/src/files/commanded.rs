use std::path::Path;

use nalgebra::Vector3;

use super::instruments::Gathered;
use super::reading::cells;
use super::source::Source;
use crate::error::Result;
use crate::model::near::Reach;
use crate::model::{Commanded, Measurements, Model, Robot, Row};
use crate::units::from_mm;

const POINT: [&str; 3] = ["cmd_x_mm", "cmd_y_mm", "cmd_z_mm"];
/// Commanded points whose coordinates agree within this are one pose, m.
const SAME_POINT: f64 = 1e-6;

impl Commanded {
    /// Reads and checks the file. What its rows refer to beside the arm is as the
    /// instruments.toml beside it states, or else as the model found it.
    ///
    /// # Errors
    /// Names file, line, column and remedy.
    pub fn read(path: &Path, model: &Model) -> Result<Self> {
        let mut book = Gathered::beside(path, &model.robot)?;
        book.known_to(&model.instruments);
        Self::parsed(path, &super::read(path)?, &model.robot, book)
    }

    /// Like [`Commanded::read`] from a text, with nothing but an arm.
    ///
    /// # Errors
    /// As for [`Commanded::read`].
    pub fn parse(path: &Path, text: &str, robot: &Robot) -> Result<Self> {
        Self::parsed(path, text, robot, Gathered::default())
    }

    fn parsed(path: &Path, text: &str, robot: &Robot, book: Gathered) -> Result<Self> {
        let source = Source { path, text };
        let names = source.headings();
        let header: Vec<&str> = names.iter().map(String::as_str).collect();
        let points = POINT.iter().any(|name| header.contains(name));
        let joints = header.iter().any(|name| {
            name.strip_prefix("cmd")
                .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
        });
        match (joints, points) {
            (true, true) => Err(source.in_headings(
                "both commanded joints and commanded points",
                "keep what the controller was told and delete the other columns",
            )),
            (false, false) if !text.trim().is_empty() => Err(source.in_headings(
                "no commanded joints and no commanded points",
                "add the columns cmd1_deg.. (cmdN_mm for prismatic joints), or cmd_x_mm, cmd_y_mm, \
                 cmd_z_mm in the robot's frame",
            )),
            (_, false) => {
                let mut data = Measurements::table(path, text, robot, (Some("cmd"), true), book)?;
                data.remark_joints(robot);
                Ok(Self { data, points: Vec::new() })
            }
            (false, true) => {
                let mut data = Measurements::table(path, text, robot, (None, true), book)?;
                let to_arm = robot.base.pose().inverse();
                let points = points_of(&source, &header, &data)?;
                let points: Vec<_> = points.iter().map(|p| to_arm.transform_point(p)).collect();
                number(&mut data, &points);
                Ok(Self { data, points })
            }
        }
    }
}

/// In the coordinates of the file, m.
fn points_of(source: &Source, header: &[&str], data: &Measurements) -> Result<Vec<Vector3<f64>>> {
    let mut at = [0; 3];
    for (slot, name) in at.iter_mut().zip(POINT) {
        *slot = header.iter().position(|c| *c == name).ok_or_else(|| {
            let help = "a commanded point needs cmd_x_mm, cmd_y_mm, cmd_z_mm";
            source.in_headings(format!("missing column {name}"), help)
        })?;
    }
    let cell = |(row, cells): (&Row, &[String]), axis: usize| match cells[at[axis]].parse::<f64>() {
        Ok(mm) if mm.is_finite() && mm.abs() <= 1e6 => Ok(from_mm(mm)),
        _ => {
            let span = source.cell(source.start_of(row.line), at[axis]);
            let message = format!("\"{}\" is not a coordinate", cells[at[axis]]);
            let help = "give the commanded point in mm, in the robot's frame";
            Err(source.in_cell(row.line, (POINT[axis], span), message, help))
        }
    };
    let cells = cells(source, &data.rows);
    data.rows
        .iter()
        .zip(&cells)
        .map(|(row, cells)| (row, cells.as_slice()))
        .map(|row| Ok(Vector3::new(cell(row, 0)?, cell(row, 1)?, cell(row, 2)?)))
        .collect()
}

/// Numbers the poses by their commanded points.
fn number(data: &mut Measurements, points: &[Vector3<f64>]) {
    let numbers;
    (numbers, data.poses) =
        Reach::uniform(3, SAME_POINT).number(points.iter().map(|point| point.as_slice()));
    data.rows.iter_mut().zip(numbers).for_each(|(row, number)| row.pose = number);
}
