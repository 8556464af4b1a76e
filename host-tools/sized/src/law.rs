//! The controller's law for one command, as a standing controller answers it: no ramp,
//! no step limit.

use truearm::blob::{Blob, DecodeError};
use truearm::compensate::{Refusal, SettingError, Status};
use truearm::{Arm, ArmParameters, Compensator, Pose, Scalar, Settings, Task};

use crate::{Conditions, Parameters, fixed, with_joints};

/// What the law is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// Point or pose.
    pub task: Task,
    /// That the flange is mounted as drawn.
    pub trust_nominal_orientation: bool,
    /// The tool in the last frame.
    pub tool: Pose<f64>,
}

/// What the law made of a command.
#[derive(Debug, Clone, PartialEq)]
pub struct Applied {
    /// rad or m
    pub joints: Vec<f64>,
    /// Something held the correction back.
    pub clamped: bool,
    /// The command is within the joint ranges of the identification.
    pub covered: bool,
}

/// The law of an arm.
pub trait Law {
    /// The joints for a command.
    ///
    /// # Errors
    /// As [`Compensator::tick`].
    fn apply(&self, command: &[f64], at: &Conditions<'_>) -> Result<Applied, Refusal>;

    /// How late the arm follows a temperature, s; 0 at once.
    fn time_constant(&self) -> f64;

    /// Largest correction of each joint, rad or m.
    fn max_correction(&self) -> Vec<f64>;
}

/// The law in f64.
///
/// # Errors
/// As [`Compensator::new`].
pub fn double<'t>(
    parameters: &Parameters<'t>,
    asked: &Asked,
) -> Result<Box<dyn Law + 't>, SettingError> {
    with_joints!(parameters.nominal.len(), N => {
        let arm = Arm::new(&parameters.sized::<N>());
        Ok(Box::new(SizedLaw::<f64, N>::new(arm, asked)?))
    })
}

/// The law in f32, of a blob: the controller's bits.
///
/// # Errors
/// Why a controller would refuse the blob; the inner one as [`Compensator::new`].
pub fn single<'t>(
    blob: &Blob<'t>,
    asked: &Asked,
) -> Result<Result<Box<dyn Law + 't>, SettingError>, DecodeError> {
    with_joints!(blob.joints(), N => {
        let parameters: ArmParameters<'t, f32, N> = blob.parameters()?;
        let law = SizedLaw::<f32, N>::new(Arm::new(&parameters), asked);
        Ok(law.map(|law| Box::new(law) as Box<dyn Law + 't>))
    })
}

struct SizedLaw<'t, T, const N: usize> {
    arm: Arm<'t, T, N>,
    settings: Settings<T, N>,
}

impl<'t, T: Scalar, const N: usize> SizedLaw<'t, T, N> {
    fn new(arm: Arm<'t, T, N>, asked: &Asked) -> Result<Self, SettingError> {
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
        Compensator::new(arm.clone(), settings, &[T::ZERO; N])?;
        Ok(Self { arm, settings })
    }
}

impl<T: Scalar, const N: usize> Law for SizedLaw<'_, T, N> {
    fn apply(&self, command: &[f64], at: &Conditions<'_>) -> Result<Applied, Refusal> {
        let q: [T; N] = fixed::<f64, N>(command).map(T::from_f64);
        let state = at.state(&self.arm);
        // A new one for every row: what was applied before must not count.
        let Ok(mut compensator) = Compensator::new(self.arm.clone(), self.settings, &q) else {
            return Err(Refusal::OutOfRange);
        };
        compensator.set_active(true);
        let tick = compensator.tick(&q, &state);
        if let Status::Refused(refusal) = tick.status {
            return Err(refusal);
        }
        Ok(Applied {
            joints: tick.joints.map(Scalar::to_f64).to_vec(),
            clamped: !tick.clamped.is_empty(),
            covered: tick.covered.unwrap_or(false),
        })
    }

    fn time_constant(&self) -> f64 {
        self.arm.thermal_lag().time_constant().to_f64()
    }

    fn max_correction(&self) -> Vec<f64> {
        self.settings.max_correction.map(Scalar::to_f64).to_vec()
    }
}
