use schemars::JsonSchema;
use serde::Serialize;

use crate::model::Robot;
use crate::plan::{Determined, Observability, PosePlan};
use crate::units::MICRO;

/// What `plan --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PlanReport {
    /// The schema.
    #[schemars(extend("const" = PlanReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "plan"))]
    pub command: &'static str,
    /// The robot.
    pub robot: String,
    /// Poses to measure.
    pub poses: usize,
    /// Measurements: a pair is one of two poses.
    pub measurements: usize,
    /// Candidates they were chosen from.
    pub candidates: usize,
    /// Kind of measurement that the poses are for.
    pub kind: &'static str,
    /// What the standard deviations are of: the tool point, or the place of what
    /// measures where the kind says nothing of a tool.
    pub what: &'static str,
    /// Parameters that it can determine, those of instruments included.
    pub parameters: usize,
    /// Of the scaled Jacobian of the poses.
    pub observability: Observability,
    /// Largest 3-D standard deviation (1 sigma) of the tool point over the
    /// region.
    pub worst_um: f64,
    /// Its root mean square over the region.
    pub rms_um: f64,
    /// No set of as many poses has a smaller worst: sigma sqrt(p / n). Of points
    /// only.
    pub bound_um: Option<f64>,
    /// Worst of as many random poses, median of 9 draws.
    pub random_worst_um: f64,
    /// The same but for what no measurement of this kind tells; `null` where it tells
    /// all that matters.
    pub determined: Option<DeterminedFigures>,
    /// What no measurement of this kind tells, in words.
    pub undetermined: Vec<String>,
    /// The worst that was asked for.
    pub target_um: Option<f64>,
    /// Whether it was reached.
    pub target_reached: Option<bool>,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl PlanReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-plan-1";

    /// Of planned poses.
    #[must_use]
    pub fn new(robot: &Robot, found: &PosePlan, candidates: usize, target_um: Option<f64>) -> Self {
        Self {
            schema: Self::SCHEMA,
            command: "plan",
            robot: robot.name.clone(),
            poses: found.poses.len(),
            measurements: found.measurements.len(),
            candidates,
            kind: found.kind,
            what: found.what,
            parameters: found.parameters,
            observability: found.observability,
            worst_um: found.worst * MICRO,
            rms_um: found.rms * MICRO,
            bound_um: found.bound.map(|bound| bound * MICRO),
            random_worst_um: found.random_worst * MICRO,
            determined: found.determined.as_ref().map(DeterminedFigures::of),
            undetermined: found.undetermined.clone(),
            target_um,
            target_reached: found.reached,
            warnings: [robot.warnings.clone(), found.warnings.clone()].concat(),
        }
    }
}

/// Standard deviations of what a kind determines at all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct DeterminedFigures {
    /// Largest over the region.
    pub worst_um: f64,
    /// Root mean square over the region.
    pub rms_um: f64,
    /// Worst of as many random measurements.
    pub random_worst_um: f64,
}

impl DeterminedFigures {
    fn of(found: &Determined) -> Self {
        let [worst_um, rms_um, random_worst_um] =
            [found.worst, found.rms, found.random_worst].map(|m| m * MICRO);
        Self { worst_um, rms_um, random_worst_um }
    }
}

/// What `plan --discriminate --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SeparationReport {
    /// The schema.
    #[schemars(extend("const" = SeparationReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "plan"))]
    pub command: &'static str,
    /// The robot.
    pub robot: String,
    /// The diagnosed measurements.
    pub data: String,
    /// Poses to measure.
    pub poses: usize,
    /// Candidates they were chosen from.
    pub candidates: usize,
    /// What the poses are to tell from the best explanation.
    pub alternatives: Vec<SeparatedAlternative>,
    /// Remarks.
    pub warnings: Vec<String>,
}

impl SeparationReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-plan-discriminate-1";
}

/// An alternative of a diagnosis, and what the planned poses will say of it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SeparatedAlternative {
    /// Its effects: name and joints.
    pub effects: Vec<(&'static str, Vec<usize>)>,
    /// What it says otherwise than the best explanation, in words.
    pub instead: String,
    /// How much worse it is, in units of chi-square.
    pub worse_by_now: f64,
    /// Expected chi-square that the planned poses add.
    pub worse_by_planned: f64,
}
