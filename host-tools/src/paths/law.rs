//! The controller's law for one command, for any number of joints.

use truearm::blob::Blob;
use truearm::compensate::{Refusal, SettingError};
use truearm::effects::{MAX_TERMS, Term, deflection};
use truearm::{Approach, MAX_JOINTS};
use truearm_sized::{Applied, Asked, Conditions, Law};

use crate::blob::{PackOptions, arm_terms, pack_with, parameters};
use crate::error::{Error, ErrorKind, Result};
use crate::model::arm::RowInputs;
use crate::model::{JointTables, Model, ModelTerm, Row};

/// The law in f64. A model with more terms than a controller takes keeps its
/// periodic ones outside of the arm, where [`Waves`] takes them back as the law
/// would.
pub(super) fn double<'t>(
    model: &'t Model,
    tables: &'t JointTables,
    asked: &Asked,
) -> Result<ModelLaw<'t>> {
    let all: Vec<Term<f64>> = arm_terms(model).collect();
    let (waves, others): (Vec<_>, Vec<_>) = if all.len() <= MAX_TERMS {
        (Vec::new(), all)
    } else {
        all.iter().partition(|term| term.effect.order().is_cycles())
    };
    let terms = heapless::Vec::from_slice(&others).map_err(|_| too_many(model, others.len()))?;
    let parameters = parameters(model, terms, tables.curves(), [0, 0]);
    let law = truearm_sized::double(&parameters, asked).map_err(|e| not_so(model, &e))?;
    Ok(ModelLaw { law, waves: Waves::new(waves, model) })
}

/// The parameters that the controller would be given.
pub(super) fn packed(model: &Model) -> Result<Vec<u8>> {
    let mut model = model.clone();
    // Which of several markers is the tool is said of the law; the parameters are the same.
    if let Some((tool, _)) = model.tool_marker().cloned() {
        model.markers.retain(|(label, _)| *label == tool);
    }
    // The number counts for nothing here; the creation time need not be known.
    pack_with(&model, &PackOptions { sequence: Some(1), ..PackOptions::default() })
}

/// Whether a controller would take every number of a model, be there as many terms as there
/// may.
///
/// # Errors
/// The first that it would refuse.
pub(super) fn plausible(model: &Model) -> Result<()> {
    let (arm, others): (Vec<_>, Vec<_>) =
        model.terms.iter().cloned().partition(|term| matches!(term, ModelTerm::Arm(_)));
    let parts = arm.chunks(MAX_TERMS).map(<[ModelTerm]>::to_vec);
    let parts: Vec<Vec<ModelTerm>> = if arm.is_empty() { vec![arm] } else { parts.collect() };
    for terms in parts {
        let part = Model { terms: [terms, others.clone()].concat(), ..model.clone() };
        if let Err(error) = packed(&part)
            && error.kind() == ErrorKind::Refused
        {
            return Err(error);
        }
    }
    Ok(())
}

/// The law in f32, of [`packed`] parameters: the controller's bits.
pub(super) fn single<'t>(model: &Model, blob: &'t [u8], asked: &Asked) -> Result<ModelLaw<'t>> {
    let refused = |e: truearm::blob::DecodeError| {
        let help = "`truearm pack` says what a controller refuses of this model";
        Error::data(ErrorKind::Refused, format!("{}: {e}", model.robot.path.display()), help)
    };
    let blob = Blob::check(blob).map_err(refused)?;
    let law = truearm_sized::single(&blob, asked).map_err(refused)?;
    let law = law.map_err(|e| not_so(model, &e))?;
    Ok(ModelLaw { law, waves: Waves::new(Vec::new(), model) })
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

fn not_so(model: &Model, e: &SettingError) -> Error {
    let help = "points alone were measured: take --task position, or \
                --trust-nominal-orientation if you answer for the flange being mounted as drawn";
    // The crate's words are for who writes firmware.
    let what = match e {
        SettingError::OrientationNotIdentified => {
            "task pose, and how the last frame of this arm is turned was not identified".to_owned()
        }
        other => other.to_string(),
    };
    Error::usage(format!("{}: {what}", model.robot.path.display()), help)
}

/// The law, and what of a model no controller takes.
pub(super) struct ModelLaw<'t> {
    law: Box<dyn Law + 't>,
    waves: Waves,
}

impl ModelLaw<'_> {
    /// The joints for the command of a row, with what was read of its torques as those of
    /// gravity.
    pub(super) fn apply(
        &self,
        row: &Row,
        torque: Option<Vec<f64>>,
        command: &[f64],
    ) -> std::result::Result<Applied, Refusal> {
        let mut approach = vec![Approach::Unknown; command.len()];
        for (side, direction) in approach.iter_mut().zip(&row.directions) {
            *side = Approach::of_motion(f64::from(*direction));
        }
        let conditions = Conditions {
            approach: &approach,
            payload: row.payload,
            // What the controller's own filter makes of what was read up to here.
            temperature: row.temperature_of_arm(self.law.time_constant()),
            torque: torque.as_deref(),
        };
        let mut applied = self.law.apply(command, &conditions)?;
        let most = self.law.max_correction();
        let bound = self.waves.take_back(command, &mut applied.joints, |j| most[j]);
        // A limit in the controller's numbers may be beyond the one of the files by
        // rounding: either has the same bits there, and this one is within.
        for (joint, limit) in applied.joints.iter_mut().zip(&self.waves.limits) {
            if let Some([low, high]) = limit {
                *joint = joint.max(*low).min(*high);
            }
        }
        Ok(Applied { clamped: bound || applied.clamped, ..applied })
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
                joints[*j] = stands - share * wave(terms, *j, joints[*j]);
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
fn wave(terms: &[Term<f64>], joint: usize, q: f64) -> f64 {
    // Of one joint's periodic terms nothing hangs on the other joints.
    let mut all = [0.0; MAX_JOINTS];
    all[joint] = q;
    deflection(terms, &RowInputs::default().fixed::<MAX_JOINTS>(&all)).joints[joint]
}
