use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;
use truearm::Task;

use crate::model::{Model, Path};
use crate::paths::{CompensateOptions, Compensated, Row, Step, largest_steps};
use crate::statistics::Stats;
use crate::units::{joint_unit, to_mm};

/// What `compensate --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CompensateReport {
    /// The schema.
    #[schemars(extend("const" = CompensateReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "compensate"))]
    pub command: &'static str,
    /// The model.
    pub model: String,
    /// The path.
    pub path: String,
    /// Its rows.
    pub rows: usize,
    /// `position` or `pose`: what is brought to where it was commanded.
    pub task: &'static str,
    /// `f64`, or `f32`: the bits of the controller.
    pub numbers: &'static str,
    /// By how much the tool misses at the commands, as the model predicts;
    /// `null` where no row is reached.
    pub before: Option<Stats>,
    /// What is left at the corrected joints.
    pub left: Option<Stats>,
    /// The turns that belong to them.
    pub turns: Turns,
    /// Lines of the rows whose correction was held back: at its largest, or near
    /// a limit.
    pub clamped: Vec<usize>,
    /// Corrected rows at which more than half of the miss stays, and more than 0.1 mm.
    pub mostly_left: Vec<RowLeft>,
    /// Lines of the rows outside the joint ranges of the identification.
    pub not_covered: Vec<usize>,
    /// Whether these were corrected all the same.
    pub extrapolated: bool,
    /// Rows that the arm does not reach, with what is left at the nearest.
    pub not_reached: Vec<RowLeft>,
    /// The largest step from row to row, of joints that turn and that slide.
    pub largest_steps: Vec<LargestStep>,
    /// The corrected path.
    pub out: String,
    /// Remarks.
    pub warnings: Vec<String>,
}

/// Largest turns of the tool from where it was commanded, degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Turns {
    /// At the commands.
    pub before_max_deg: f64,
    /// At the corrected joints.
    pub left_max_deg: f64,
}

/// What is left of a row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct RowLeft {
    /// Its line in the file.
    pub line: usize,
    /// Of the point, mm.
    pub left_mm: f64,
    /// Of the orientation, degrees.
    pub left_deg: f64,
}

impl RowLeft {
    /// Of a line and m and rad.
    #[must_use]
    pub fn new(line: usize, [metres, radians]: [f64; 2]) -> Self {
        Self { line, left_mm: to_mm(metres), left_deg: radians.to_degrees() }
    }
}

/// A largest step from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LargestStep {
    /// `degrees` or `mm`.
    pub unit: &'static str,
    /// Of the path as it was commanded.
    pub commanded: f64,
    /// Of the corrected path.
    pub corrected: f64,
    /// The joint that takes the corrected one, counted from 1.
    pub joint: usize,
    /// The line of the row that it leads to.
    pub line: usize,
}

impl From<Step> for LargestStep {
    fn from(step: Step) -> Self {
        let Step { kind, own, corrected, joint, line } = step;
        Self { unit: joint_unit(kind), commanded: own, corrected, joint, line }
    }
}

/// A row is not corrected if more than this share of its miss stays, and...
const STAYS: f64 = 0.5;
/// ...more than this, m.
const NOTICED: f64 = 1e-4;

/// What stays of a row that was corrected, if that is most of it: as a rule the correction
/// was held back.
fn mostly_left(row: &Row) -> Option<[f64; 2]> {
    match row {
        Row::Corrected { clamped, command, joints, before, left, .. } => {
            let corrected = *clamped || joints != command;
            (corrected && left[0] > STAYS * before[0] && left[0] > NOTICED).then_some(*left)
        }
        Row::NotReached(_) => None,
    }
}

impl CompensateReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-compensate-1";

    /// Of a model file, a path and what became of it in a file.
    #[must_use]
    pub fn new(
        [file, out]: [String; 2],
        model: &Model,
        path: &Path,
        found: &Compensated,
        options: &CompensateOptions,
        warnings: Vec<String>,
    ) -> Self {
        let lines = |is: fn(&Row) -> bool| {
            let rows = found.rows.iter().zip(&path.data.rows);
            rows.filter(|(row, _)| is(row)).map(|(_, input)| input.line).collect()
        };
        let misses = |of: fn(&Row) -> Option<[f64; 2]>| -> (Option<Stats>, f64) {
            let all: Vec<_> = found.rows.iter().filter_map(of).collect();
            let points: Vec<_> = all.iter().map(|[m, _]| Vector3::new(*m, 0.0, 0.0)).collect();
            let most = all.iter().map(|[_, turn]| *turn).fold(0.0, f64::max);
            (Stats::of(&points), most.to_degrees())
        };
        let (before, before_max_deg) = misses(|row| match row {
            Row::Corrected { before, .. } => Some(*before),
            Row::NotReached(_) => None,
        });
        let (left, left_max_deg) = misses(|row| match row {
            Row::Corrected { left, .. } => Some(*left),
            Row::NotReached(_) => None,
        });
        let rows = found.rows.iter().zip(&path.data.rows);
        let stays = rows
            .clone()
            .filter_map(|(row, input)| mostly_left(row).map(|left| RowLeft::new(input.line, left)));
        Self {
            schema: Self::SCHEMA,
            command: "compensate",
            model: file,
            path: path.data.path.display().to_string(),
            rows: found.rows.len(),
            task: if found.task == Task::Pose { "pose" } else { "position" },
            numbers: if options.single { "f32" } else { "f64" },
            before,
            left,
            turns: Turns { before_max_deg, left_max_deg },
            clamped: lines(|row| matches!(row, Row::Corrected { clamped: true, .. })),
            mostly_left: stays.collect(),
            not_covered: lines(|row| matches!(row, Row::Corrected { covered: false, .. })),
            extrapolated: options.extrapolate,
            not_reached: rows
                .filter_map(|(row, input)| match row {
                    Row::NotReached(left) => Some(RowLeft::new(input.line, *left)),
                    Row::Corrected { .. } => None,
                })
                .collect(),
            largest_steps: largest_steps(model, path, &found.rows)
                .into_iter()
                .map(Into::into)
                .collect(),
            out,
            warnings,
        }
    }
}
