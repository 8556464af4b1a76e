use nalgebra::Vector3;
use truearm::{JointKind, Pose, Task};
use truearm_sized::{Applied, Asked};

use super::forward::{Forward, View, off};
use super::inverse::{Followed, Inverse};
use super::law::{self, ModelLaw};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Coordinates, JointTables, Model, Path, Placement};
use crate::units::joint_to_file;

/// What the user may choose.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CompensateOptions {
    /// Position, or position and orientation; by default what was identified, and
    /// the position of arms of fewer than six joints.
    pub task: Option<Task>,
    /// See [`truearm::Settings::trust_nominal_orientation`].
    pub trust_nominal_orientation: bool,
    /// Correct also where the identification covered no joint range, as a
    /// controller does, instead of leaving the command as it is.
    pub extrapolate: bool,
    /// In the numbers and with the parameters of the controller: its bits.
    pub single: bool,
    /// The tool is this target of the identification instead of `[tool]`.
    pub marker: Option<String>,
    /// Where the inverse kinematics of a path of poses begins, rad or m.
    pub start: Option<Vec<f64>>,
}

/// A path and what became of it.
#[derive(Debug, Clone)]
pub struct Compensated {
    /// What was asked of the law.
    pub task: Task,
    /// One entry a row of the path.
    pub rows: Vec<Row>,
    /// Whether the configuration of the first row was chosen here.
    pub chosen: bool,
    /// Rows of a path of poses that change the configuration, see
    /// [`Followed::jumps`](super::Followed::jumps).
    pub jumps: Vec<usize>,
}

/// A row of a path.
#[derive(Debug, Clone, PartialEq)]
pub enum Row {
    /// It has joints.
    Corrected {
        /// What the controller would be told without compensation, rad or m.
        command: Vec<f64>,
        /// What to tell it instead, rad or m.
        joints: Vec<f64>,
        /// Where the controller believes its tool to be at these, in `[base]`.
        believed: Pose<f64>,
        /// By how much the tool misses at the command: m, rad.
        before: [f64; 2],
        /// By how much at `joints`.
        left: [f64; 2],
        /// Something held the correction back: see [`truearm::compensate::Clamped`].
        clamped: bool,
        /// The command is within the joint ranges of the identification.
        covered: bool,
    },
    /// The arm does not reach the pose: what is left of it, m and rad.
    NotReached([f64; 2]),
}

/// A largest step of a joint from row to row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Turns or slides.
    pub kind: JointKind,
    /// Of the path as it was, in degrees or mm.
    pub own: f64,
    /// Of the corrected path.
    pub corrected: f64,
    /// The joint that takes the corrected one, counted from 1.
    pub joint: usize,
    /// The line of the file that it leads to.
    pub line: usize,
}

/// Corrects a path.
///
/// # Errors
/// Joints beyond their limits, numbers of a model that no controller takes, an orientation that
/// was not identified, more terms than the law takes, a marker that the model does not know, and as
/// [`Forward::along`].
pub fn compensate(model: &Model, path: &Path, options: &CompensateOptions) -> Result<Compensated> {
    path.within_limits(&model.robot)?;
    let view = View { station: None, marker: options.marker.clone() };
    let (nominal, real) =
        (Forward::nominal(model, &view)?, Forward::real(model, &view)?.along(&path.data, model)?);
    let asked = asked(model, options)?;
    let blob = if options.single { law::packed(model)? } else { Vec::new() };
    let tables = JointTables::new(&model.curves);
    let law = if options.single {
        law::single(model, &blob, &asked)?
    } else {
        law::plausible(model)?;
        law::double(model, &tables, &asked)?
    };
    let one = One { law: &law, nominal: &nominal, real: &real, path, options };
    let (rows, chosen, jumps) = match path.coordinates {
        Coordinates::Joints => {
            let rows = (0..path.data.rows.len()).map(|i| one.row(i, &path.data.rows[i].q));
            (rows.collect::<Result<_>>()?, false, Vec::new())
        }
        _ => {
            let inverse = Inverse::new(&nominal, &model.robot).preferring(&model.covered);
            let Followed { rows: found, chosen, jumps } =
                inverse.follow(&path.data, &path.targets, options.start.as_deref());
            let rows = found.iter().enumerate().map(|(i, found)| {
                if found.is_reached() {
                    one.row(i, &found.joints)
                } else {
                    Ok(Row::NotReached([found.position, found.rotation]))
                }
            });
            (rows.collect::<Result<_>>()?, chosen, jumps)
        }
    };
    Ok(Compensated { task: asked.task, rows, chosen, jumps })
}

fn asked(model: &Model, options: &CompensateOptions) -> Result<Asked> {
    let known = model.orientation_identified || options.trust_nominal_orientation;
    let usual = if known && model.robot.joints.len() >= 6 { Task::Pose } else { Task::Position };
    let translation = match &options.marker {
        Some(label) => {
            let found = model.markers.iter().find(|(l, _)| l == label);
            found.map_or_else(Vector3::zeros, |(_, point)| *point)
        }
        None => model.robot.tool,
    };
    let turn = Placement { xyz: Vector3::zeros(), rpy: model.robot.tool_rpy }.pose();
    Ok(Asked {
        task: options.task.unwrap_or(usual),
        trust_nominal_orientation: options.trust_nominal_orientation,
        tool: Pose { translation, ..turn },
    })
}

/// What one row needs.
struct One<'a> {
    law: &'a ModelLaw<'a>,
    nominal: &'a Forward,
    real: &'a Forward,
    path: &'a Path,
    options: &'a CompensateOptions,
}

impl One<'_> {
    fn row(&self, index: usize, command: &[f64]) -> Result<Row> {
        let row = &self.path.data.rows[index];
        let Applied { joints, clamped, covered } =
            self.law.apply(row, self.real.torques(row), command).map_err(|refusal| {
                Error::data(
                    ErrorKind::Refused,
                    format!("{}: line {}: {refusal}", self.path.data.path.display(), row.line),
                    "check the row and the model; truearm compensate without --f32 reaches farther",
                )
            })?;
        // What nobody has measured is not invented.
        let held = !covered && !self.options.extrapolate;
        let (joints, clamped) = if held { (command.to_vec(), false) } else { (joints, clamped) };
        let target = self.nominal.pose(row, command);
        let miss = |q: &[f64]| off(&target, &self.real.pose(row, q)).map(|v| v.norm());
        Ok(Row::Corrected {
            believed: self.nominal.pose(row, &joints),
            before: miss(command),
            left: miss(&joints),
            command: command.to_vec(),
            joints,
            clamped,
            covered,
        })
    }
}

/// The largest step of the joints that turn and of those that slide; of fewer
/// than two rows in a row none.
#[must_use]
pub fn largest_steps(model: &Model, path: &Path, rows: &[Row]) -> Vec<Step> {
    let kinds: Vec<JointKind> = model.robot.joints.iter().map(|j| j.link.kind).collect();
    let mut steps: Vec<Step> = Vec::new();
    for (i, pair) in rows.windows(2).enumerate() {
        let [
            Row::Corrected { command: q0, joints: j0, .. },
            Row::Corrected { command: q1, joints: j1, .. },
        ] = pair
        else {
            continue;
        };
        for (j, kind) in kinds.iter().enumerate() {
            let size = |a: &[f64], b: &[f64]| joint_to_file(*kind, (b[j] - a[j]).abs());
            let (own, corrected) = (size(q0, q1), size(j0, j1));
            let line = path.data.rows[i + 1].line;
            let step = Step { kind: *kind, own, corrected, joint: j + 1, line };
            match steps.iter_mut().find(|s| s.kind == *kind) {
                None => steps.push(step),
                Some(most) => {
                    let own = most.own.max(own);
                    *most = if corrected > most.corrected { step } else { *most };
                    most.own = own;
                }
            }
        }
    }
    steps
}
