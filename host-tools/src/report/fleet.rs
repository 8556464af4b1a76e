use schemars::JsonSchema;
use serde::Serialize;
use truearm::LinkParameter;

use crate::fleet::{Fleet, LEVEL, Prior};
use crate::identify::Figures;
use crate::units::link_unit;

/// What `fleet --json` prints, and its `fleet.json`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FleetReport {
    /// The schema.
    #[schemars(extend("const" = FleetReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "fleet"))]
    pub command: &'static str,
    /// Name of the type.
    pub robot: String,
    /// Chance that a fleet in which no arm differs has one named, and that a type whose
    /// drawing is right has a common correction named.
    pub error_rate: f64,
    /// Noise of the measurements over what was stated.
    pub noise_over_stated: f64,
    /// Every folder with what came of it.
    pub arms: Vec<FleetArm>,
    /// Five a joint, in the order of the joints.
    pub parameters: Vec<FleetParameter>,
    /// Remarks for the user.
    pub warnings: Vec<String>,
}

/// A folder of a fleet.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct FleetArm {
    /// Its name.
    pub name: String,
    /// Poses measured.
    pub poses: usize,
    /// RMS error of poses held out, mm.
    pub cross_validated_rms_mm: Option<f64>,
    /// How it stands to the others; none where it was not identified.
    pub judgement: Option<FleetJudgement>,
    /// Why it was not identified, and what to do.
    pub failure: Option<String>,
}

/// An arm against its type.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FleetJudgement {
    /// Whether it differs, and the type was learned without it.
    pub differs: bool,
    /// The parameter that stands out most, such as `joint 2 theta_offset`, or what the
    /// poses do not tell from it.
    pub farthest: String,
    /// Its deviation from the mean of the type, in `unit`.
    pub deviation: f64,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// The same over its standard deviation in arms of the type.
    pub sigmas: f64,
    /// Noise of its measurements over what was stated.
    pub noise_over_stated: f64,
    /// The same over that of the others.
    pub noise_over_others: f64,
    /// Chance that some arm of a fleet without any that differs is as far off.
    pub chance: f64,
}

/// A parameter of the type.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FleetParameter {
    /// Such as `joint 2 theta_offset`.
    pub name: String,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// Tolerance of the next arm: one standard deviation.
    pub tolerance: f64,
    /// 95 % interval of the spread.
    pub interval: [f64; 2],
    /// Tolerance where nothing is known of the type.
    pub usual: f64,
    /// Correction that all arms share; zero where none is.
    pub expected: f64,
    /// Chance of one so far from zero in a type whose drawing is right; none of those
    /// that are not common.
    pub chance: Option<f64>,
    /// How many arms' worth the measurements say of it.
    pub determined_by_arms: f64,
}

impl FleetReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-fleet-1";

    /// Of a type, of all folders (those that were identified in the order of the fleet).
    #[must_use]
    pub fn new(
        robot: String,
        fleet: &Fleet,
        folders: Vec<(String, std::result::Result<Figures, String>)>,
        warnings: Vec<String>,
    ) -> Self {
        let mut judgements = fleet.arms.iter().zip(&fleet.noises).map(|(judged, noise)| {
            let (unit, factor) = link_unit(judged.parameter);
            FleetJudgement {
                differs: judged.apart,
                farthest: name(judged.joint, judged.parameter),
                deviation: judged.deviation * factor,
                unit,
                sigmas: judged.sigmas,
                noise_over_stated: *noise,
                noise_over_others: judged.noise,
                chance: judged.chance,
            }
        });
        let arms = folders.into_iter().map(|(name, found)| match found {
            Ok(figures) => FleetArm {
                name,
                poses: figures.poses,
                cross_validated_rms_mm: figures.cross_validated.map(|s| s.rms_mm),
                judgement: judgements.next(),
                failure: None,
            },
            Err(failure) => FleetArm { name, failure: Some(failure), ..FleetArm::default() },
        });
        Self {
            schema: Self::SCHEMA,
            command: "fleet",
            robot,
            error_rate: LEVEL,
            noise_over_stated: fleet.learned.noise().sqrt(),
            arms: arms.collect(),
            parameters: fleet.priors().iter().map(parameter).collect(),
            warnings: warnings.into_iter().chain(fleet.unexplained()).collect(),
        }
    }
}

fn name(joint: usize, parameter: LinkParameter) -> String {
    format!("joint {} {}", joint + 1, parameter.name())
}

fn parameter(prior: &Prior) -> FleetParameter {
    let (unit, factor) = link_unit(prior.parameter);
    FleetParameter {
        name: name(prior.joint, prior.parameter),
        unit,
        tolerance: prior.tolerance * factor,
        interval: prior.interval.map(|end| end * factor),
        usual: prior.usual * factor,
        expected: prior.expected * factor,
        chance: prior.chance,
        determined_by_arms: prior.determined,
    }
}
