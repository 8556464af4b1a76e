//! A path.csv: joints or tool poses, and the state columns of measurements.csv.

use std::path::Path as FilePath;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

use super::instruments::Gathered;
use super::reading::cells;
use super::source::Source;
use crate::error::{Error, Result};
use crate::headings::{Heading, Named, Role};
use crate::model::{Coordinates, Measurements, Path, Placement, Robot, Row, Target};
use crate::units::{joint_column, point_from_mm, to_mm};

const POINT: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];
const RPY: [&str; 3] = ["roll_deg", "pitch_deg", "yaw_deg"];
/// No arm of these files reaches farther, mm.
const MOST_MM: f64 = 1e6;

/// Which columns of a path are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The joints; other columns are only carried along.
    Joints,
    /// The poses of the tool; joint columns are only carried along.
    Poses,
    /// The one of the two that is there; both are an error.
    Either,
}

impl Path {
    /// Reads and checks a path of `robot`.
    ///
    /// # Errors
    /// Names file, line, column and remedy.
    pub fn read(path: &FilePath, robot: &Robot, wanted: Wanted) -> Result<Self> {
        Self::parse(path, &super::read(path)?, robot, wanted)
    }

    /// Like [`Path::read`] from a text.
    ///
    /// # Errors
    /// As for [`Path::read`].
    pub fn parse(path: &FilePath, text: &str, robot: &Robot, wanted: Wanted) -> Result<Self> {
        let source = Source { path, text };
        let names = source.headings();
        let header: Vec<&str> = names.iter().map(String::as_str).collect();
        let joints = joints_wanted(&source, &header, wanted)?;
        let mut data = Measurements::table(
            path,
            text,
            robot,
            (joints.then_some("q"), false),
            Gathered::default(),
        )?;
        let cells = cells(&source, &data.rows);
        remark_idle(&mut data);
        if joints {
            data.remark_joints(robot);
            let coordinates = Coordinates::Joints;
            return Ok(Self { data, targets: Vec::new(), coordinates, names, cells });
        }
        let poses = Poses::find(&source, &header)?;
        poses.refuse_other_turns(&data.extra_columns)?;
        let targets = data.rows.iter().enumerate();
        let targets: Vec<Target> =
            targets.map(|(i, row)| poses.target(&cells[i], row)).collect::<Result<_>>()?;
        data.warnings.extend(in_metres(path, &targets, robot));
        Ok(Self { data, targets, coordinates: poses.coordinates(), names, cells })
    }

    /// Whether joint values are within the limits of the robot.
    ///
    /// # Errors
    /// The first that is not: its line, column, value and limits.
    pub fn within_limits(&self, robot: &Robot) -> Result<()> {
        for row in &self.data.rows {
            for (j, (q, joint)) in row.q.iter().zip(&robot.joints).enumerate() {
                let Some([low, high]) = joint.limits else { continue };
                if *q < low || *q > high {
                    let kind = joint.link.kind;
                    let value = |x| crate::units::joint_to_file(kind, x);
                    let unit = crate::units::joint_unit(kind);
                    return Err(Error::file(
                        &self.data.path,
                        crate::error::Place::field(row.line, &joint_column("q", j, kind)),
                        format!(
                            "joint {} at {} {unit} is outside its limits, {} to {}",
                            j + 1,
                            value(*q),
                            value(low),
                            value(high)
                        ),
                        format!(
                            "the robot does not go there: mend the row, or the limits in {}",
                            robot.path.display()
                        ),
                    ));
                }
            }
        }
        Ok(())
    }
}

/// What a heading means that no reader of these files takes.
fn meant(name: &str) -> Option<Role> {
    Named::of(&Heading::new(name)).map(|named| named.role)
}

/// A remark where all points are as near to the base as points in metres would be.
fn in_metres(path: &FilePath, targets: &[Target], robot: &Robot) -> Option<String> {
    let far = targets.iter().map(|target| target.point.norm()).fold(0.0, f64::max);
    (far > 0.0 && far < NEAR_THE_BASE * robot.reach()).then(|| {
        format!(
            "{}: all points are within {:.1} mm of the base: are they metres? The columns are mm",
            path.display(),
            to_mm(far)
        )
    })
}

/// Points of an arm are farther from its base than this part of all its lengths.
const NEAR_THE_BASE: f64 = 0.01;

/// A remark where a column says a state in another way than is read.
fn remark_idle(data: &mut Measurements) {
    let state = |role| matches!(role, Role::Payload | Role::Temperature | Role::Direction(_));
    let idle = data.extra_columns.iter().filter(|name| meant(name).is_some_and(state));
    let idle: Vec<&str> = idle.map(String::as_str).collect();
    if !idle.is_empty() {
        data.warnings.push(format!(
            "{}: carried along without use: {}; payload_kg, temperature_c and dir1.. are read",
            data.path.display(),
            idle.join(", ")
        ));
    }
}

/// Whether the joints are meant, of the columns that are there.
fn joints_wanted(source: &Source, header: &[&str], wanted: Wanted) -> Result<bool> {
    let joint = |name: &str| {
        let rest =
            name.strip_prefix('q').and_then(|r| r.strip_suffix("_deg").or(r.strip_suffix("_mm")));
        rest.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
    };
    let joints = header.iter().any(|name| joint(name));
    let point = POINT.iter().any(|name| header.contains(name));
    match wanted {
        Wanted::Joints => Ok(true),
        Wanted::Poses => Ok(false),
        Wanted::Either if joints && point => Err(source.in_headings(
            "both joints and points of the tool",
            "say which of them is the command with --from joints or --from poses, or delete the \
             other columns",
        )),
        Wanted::Either if !joints && !point && !source.text.trim().is_empty() => Err(source
            .in_headings(
                "no joints and no points of the tool",
                "add the columns q1_deg.. (qN_mm for prismatic joints), or x_mm, y_mm, z_mm with \
                 qx, qy, qz, qw or roll_deg, pitch_deg, yaw_deg, of [tool] in [base]",
            )),
        Wanted::Either => Ok(!point),
    }
}

/// Where the columns of the poses stand.
struct Poses<'a> {
    source: &'a Source<'a>,
    point: [usize; 3],
    rpy: Option<[usize; 3]>,
    quaternion: bool,
}

impl<'a> Poses<'a> {
    fn find(source: &'a Source<'a>, header: &[&str]) -> Result<Self> {
        let at = |name: &str| header.iter().position(|n| *n == name);
        let mut point = [0; 3];
        for (slot, name) in point.iter_mut().zip(POINT) {
            *slot = at(name).ok_or_else(|| {
                let help = "a pose of the tool needs x_mm, y_mm, z_mm, of [tool] in [base]";
                source.in_headings(format!("missing column {name}"), help)
            })?;
        }
        let quaternion = QUATERNION.iter().all(|name| at(name).is_some());
        let rpy = match RPY.map(at) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            [None, None, None] => None,
            _ => {
                let message = "orientation needs all of roll_deg, pitch_deg, yaw_deg";
                let help = "add the missing ones or delete the others";
                return Err(source.in_headings(message, help));
            }
        };
        if quaternion && rpy.is_some() {
            return Err(source.in_headings(
                "orientation as quaternion and as angles",
                "keep qx, qy, qz, qw or roll_deg, pitch_deg, yaw_deg and delete the other columns",
            ));
        }
        Ok(Self { source, point, rpy, quaternion })
    }

    /// A path of points that has orientations in another way than is read would turn the
    /// tool anyhow.
    fn refuse_other_turns(&self, others: &[String]) -> Result<()> {
        let turn = |role| {
            matches!(role, Role::Quaternion(_) | Role::Rpy(_) | Role::Turn(_) | Role::Matrix(..))
        };
        // A, B, C of a KUKA are joints to no path.
        let kuka = |name: &str| ["a", "b", "c"].contains(&name.to_lowercase().as_str());
        let of = |name: &&String| kuka(name) || meant(name).is_some_and(turn);
        let turns: Vec<&str> = others.iter().filter(of).map(String::as_str).collect();
        if self.coordinates() != Coordinates::Point || turns.is_empty() {
            return Ok(());
        }
        Err(self.source.in_headings(
            format!("orientations that are not read: {}", turns.join(", ")),
            "name them qx, qy, qz, qw or roll_deg, pitch_deg, yaw_deg (R = Rz Ry Rx), in which case \
             they are followed; delete them where the point alone is meant",
        ))
    }

    fn coordinates(&self) -> Coordinates {
        match (self.quaternion, self.rpy) {
            (true, _) => Coordinates::Quaternion,
            (false, Some(_)) => Coordinates::Rpy,
            (false, None) => Coordinates::Point,
        }
    }

    fn target(&self, cells: &[String], row: &Row) -> Result<Target> {
        let mut mm = [0.0; 3];
        for ((slot, column), name) in mm.iter_mut().zip(self.point).zip(POINT) {
            *slot = self.number(cells, row, (column, name), MOST_MM)?;
        }
        Ok(Target { point: point_from_mm(mm), rotation: self.rotation(cells, row)? })
    }

    fn rotation(&self, cells: &[String], row: &Row) -> Result<Option<Matrix3<f64>>> {
        if let Some(columns) = self.rpy {
            let mut placement = Placement::default();
            for ((turn, column), name) in placement.rpy.iter_mut().zip(columns).zip(RPY) {
                *turn = self.number(cells, row, (column, name), 1e5)?.to_radians();
            }
            return Ok(Some(placement.pose().rotation));
        }
        let unit = |[x, y, z, w]: [f64; 4]| {
            UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)).to_rotation_matrix()
        };
        match row.orientation {
            Some(q) => Ok(Some(unit(q).into_inner())),
            None if self.quaternion => {
                let start = self.source.start_of(row.line);
                let help = "give every row qx, qy, qz, qw, or delete the columns for a path of \
                            positions";
                Err(self.source.in_line(row.line, start, "a pose without orientation", help))
            }
            None => Ok(None),
        }
    }

    fn number(
        &self,
        cells: &[String],
        row: &Row,
        (column, name): (usize, &str),
        most: f64,
    ) -> Result<f64> {
        let text = cells.get(column).map_or("", String::as_str);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() && value.abs() <= most => Ok(value),
            _ => {
                let span = self.source.cell(self.source.start_of(row.line), column);
                let message = format!("\"{text}\" is no coordinate of a pose");
                let help = "give the point of [tool] in mm and its angles in degrees, in [base]";
                Err(self.source.in_cell(row.line, (name, span), message, help))
            }
        }
    }
}
