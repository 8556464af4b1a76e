//! The controller's law for one command, for any number of joints.

use truearm::blob::Blob;
use truearm::compensate::{Refusal, Status};
use truearm::effects::{MAX_TERMS, Term, deflection};
use truearm::{Approach, Arm, ArmParameters, Compensator, Pose, Scalar, Settings, State, Task};

use crate::blob::{PackOptions, arm_terms, pack_with, parameters};
use crate::error::{Error, ErrorKind, Result};
use crate::model::arm::{RowInputs, fixed, with_joints};
use crate::model::{JointTables, Model, Row};

/// What the law is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Asked {
    pub task: Task,
    pub trust_nominal_orientation: bool,
    /// The tool in the last frame.
    pub tool: Pose<f64>,
}

/// What the law made of a command.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Applied {
    /// rad or m
    pub joints: Vec<f64>,
    /// Something held the correction back.
    pub clamped: bool,
    /// The command is within the joint ranges of the identification.
    pub covered: bool,
}

/// A command as a standing controller answers it: no ramp, no step limit.
pub(super) trait Law {
    fn apply(&self, row: &Row, command: &[f64]) -> std::result::Result<Applied, Refusal>;
}

/// The law in f64. A model with more terms than a controller takes keeps its
/// periodic ones outside of the arm, where [`Waves`] takes them back as the law
/// would.
pub(super) fn double<'t>(
    model: &'t Model,
    tables: &'t JointTables,
    asked: &Asked,
) -> Result<Box<dyn Law + 't>> {
    let all: Vec<Term<f64>> = arm_terms(model).collect();
    let (waves, others): (Vec<_>, Vec<_>) = if all.len() <= MAX_TERMS {
        (Vec::new(), all)
    } else {
        all.iter().partition(|term| term.effect.order().is_cycles())
    };
    let terms = heapless::Vec::from_slice(&others).map_err(|_| too_many(model, others.len()))?;
    with_joints!(model.robot.joints.len(), N => {
        let arm = Arm::new(&parameters::<N>(model, terms, tables.curves(), [0, 0]));
        Ok(Box::new(SizedLaw { waves: Waves::new(waves, model), ..sized::<f64, N>(model, arm, asked)? }) as Box<dyn Law + 't>)
    })
}

/// The parameters that the controller would be given.
pub(super) fn packed(model: &Model) -> Result<Vec<u8>> {
    // The number counts for nothing here; the creation time need not be known.
    pack_with(model, &PackOptions { sequence: Some(1), ..PackOptions::default() })
}

/// The law in f32, of [`packed`] parameters: the controller's bits.
pub(super) fn single<'t>(
    model: &Model,
    blob: &'t [u8],
    asked: &Asked,
) -> Result<Box<dyn Law + 't>> {
    with_joints!(model.robot.joints.len(), N => {
        let refused = |e: String| {
            let help = "`truearm pack` says what a controller refuses of this model";
            Error::data(ErrorKind::Refused, format!("{}: {e}", model.robot.path.display()), help)
        };
        let blob = Blob::check(blob).map_err(|e| refused(e.to_string()))?;
        let parameters: ArmParameters<'t, f32, N> =
            blob.parameters().map_err(|e| refused(e.to_string()))?;
        Ok(Box::new(sized::<f32, N>(model, Arm::new(&parameters), asked)?) as Box<dyn Law + 't>)
    })
}

fn too_many(model: &Model, terms: usize) -> Error {
    Error::data(
        ErrorKind::TooManyTerms,
        format!(
            "{}: {terms} terms that are not periodic, where the law takes {MAX_TERMS}",
            model.robot.path.display()
        ),
        "`truearm diagnose --most-terms 24` gives the best model of that size",
    )
}

struct SizedLaw<'t, T, const N: usize> {
    arm: Arm<'t, T, N>,
    settings: Settings<T, N>,
    waves: Waves,
}

fn sized<'t, T: Scalar, const N: usize>(
    model: &Model,
    arm: Arm<'t, T, N>,
    asked: &Asked,
) -> Result<SizedLaw<'t, T, N>> {
    let number = T::from_f64;
    let tool = Pose {
        rotation: asked.tool.rotation.map(number),
        translation: asked.tool.translation.map(number),
    };
    let mut settings = Settings::new(asked.task);
    settings.trust_nominal_orientation = asked.trust_nominal_orientation;
    // A standing command gets all of its correction at once.
    settings.ramp_ticks = 0;
    settings.max_change = [number(0.2); N];
    let arm = arm.with_tool(tool);
    Compensator::new(arm.clone(), settings, &[T::ZERO; N]).map_err(|e| {
        let help = "points alone were measured: take --task position, or \
                    --trust-nominal-orientation if you answer for the flange being mounted as drawn";
        Error::usage(format!("{}: {e}", model.robot.path.display()), help)
    })?;
    Ok(SizedLaw { arm, settings, waves: Waves::new(Vec::new(), model) })
}

impl<T: Scalar, const N: usize> Law for SizedLaw<'_, T, N> {
    fn apply(&self, row: &Row, command: &[f64]) -> std::result::Result<Applied, Refusal> {
        let q: [T; N] = fixed::<f64, N>(command).map(T::from_f64);
        let rest = self.arm.state();
        let mut approach = [Approach::Unknown; N];
        for (side, direction) in approach.iter_mut().zip(&row.directions) {
            *side = Approach::of_motion(f64::from(*direction));
        }
        let state = State {
            approach,
            payload: row.payload.map_or(rest.payload, T::from_f64),
            // What the controller's own filter makes of what was read up to here.
            temperature: row
                .temperature_of_arm(self.arm.thermal_lag().time_constant().to_f64())
                .map_or(rest.temperature, T::from_f64),
        };
        // A new one for every row: what was applied before must not count.
        let Ok(mut compensator) = Compensator::new(self.arm.clone(), self.settings, &q) else {
            return Err(Refusal::OutOfRange);
        };
        compensator.set_active(true);
        let tick = compensator.tick(&q, &state);
        if let Status::Refused(refusal) = tick.status {
            return Err(refusal);
        }
        let mut joints = tick.joints.map(Scalar::to_f64).to_vec();
        let bound = self
            .waves
            .take_back(command, &mut joints, |j| self.settings.max_correction[j].to_f64());
        // A limit in the controller's numbers may be beyond the one of the files by
        // rounding: either has the same bits there, and this one is within.
        for (joint, limit) in joints.iter_mut().zip(&self.waves.limits) {
            if let Some([low, high]) = limit {
                *joint = joint.max(*low).min(*high);
            }
        }
        Ok(Applied {
            joints,
            clamped: bound || !tick.clamped.is_empty(),
            covered: tick.covered.unwrap_or(false),
        })
    }
}

/// Periodic errors of joints beside the arm: joint j turns further by w_j(q_j).
struct Waves {
    of: Vec<(usize, Vec<Term<f64>>)>,
    limits: Vec<Option<[f64; 2]>>,
}

/// A periodic error changes by less than its joint does; steeper than a tenth
/// none was seen, so that so many rounds are at rounding.
const ROUNDS: usize = 40;

impl Waves {
    fn new(terms: Vec<Term<f64>>, model: &Model) -> Self {
        let limits: Vec<_> = model.robot.joints.iter().map(|j| j.limits).collect();
        let of = (0..limits.len()).map(|j| {
            let own = terms.iter().filter(|t| t.own_joint().map(usize::from) == Some(j));
            (j, own.copied().collect::<Vec<_>>())
        });
        Self { of: of.filter(|(_, own)| !own.is_empty()).collect(), limits }
    }

    /// Joints at which the arm with its waves stands where the arm without them
    /// stands at `joints`; as the law, within `most` of the command and within the
    /// limits, all by one factor. Whether that held something back.
    fn take_back(&self, command: &[f64], joints: &mut [f64], most: impl Fn(usize) -> f64) -> bool {
        if self.of.is_empty() {
            return false;
        }
        let room = |j: usize| {
            let left = self.limits[j].map_or(f64::INFINITY, |[low, high]| {
                (command[j] - low).min(high - command[j]).max(0.0)
            });
            left.min(most(j))
        };
        let mut held = false;
        for (j, terms) in &self.of {
            // Near a limit the law takes back a share that falls to zero.
            let share = room(*j) / most(*j);
            held |= share < 1.0;
            let stands = joints[*j];
            for _ in 0..ROUNDS {
                joints[*j] = stands - share * wave(terms, command.len(), *j, joints[*j]);
            }
        }
        let size = |j: usize| (joints[j] - command[j]).abs();
        let fits = |j: usize| if size(j) > room(j) { room(j) / size(j) } else { 1.0 };
        let scale = (0..joints.len()).map(fits).fold(1.0, f64::min);
        if scale < 1.0 {
            for (joint, q) in joints.iter_mut().zip(command) {
                *joint = q + (*joint - q) * scale;
            }
        }
        held || scale < 1.0
    }
}

/// What its periodic terms turn a joint by at a reading q.
fn wave(terms: &[Term<f64>], joints: usize, joint: usize, q: f64) -> f64 {
    with_joints!(joints, N => {
        let mut all = [0.0; N];
        all[joint] = q;
        deflection(terms, &RowInputs::default().fixed::<N>(&all)).joints[joint]
    })
}
