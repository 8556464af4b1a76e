use super::damped::Rule;
use crate::arm::Arm;
use crate::scalar::Scalar;

/// What a [`super::Compensator`] has to meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Task {
    /// The tool point, by the smallest change of joints. For arms of three
    /// joints and more, and where the orientation was not identified.
    Position,
    /// Point and orientation. For arms of six joints and more; with fewer it
    /// is a compromise between the two.
    Pose,
}

/// How a [`super::Compensator`] works; set once.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings<T, const N: usize> {
    /// Point, or point and orientation.
    pub task: Task,
    /// Take [`Task::Pose`] although the arm's orientation was not identified:
    /// the directions that points cannot see are then taken as nominal, and
    /// the caller answers for that.
    pub trust_nominal_orientation: bool,
    /// How often what is left is looked at and solved for again, 1 to 4. Each
    /// leaves the error times the misfit of the nominal Jacobian, typically a
    /// hundredth. There is no iteration until something converges: the same
    /// number whatever the command. Damping and bounds cost what `src/README.md`
    /// says of the worst case.
    pub refinements: u8,
    /// Largest correction of each joint, rad or m, to 0.2. A correction takes
    /// back a geometric error and is a few milliradians; the bound keeps a
    /// singular pose or wrong parameters from moving the arm elsewhere.
    pub max_correction: [T; N],
    /// Largest change of a joint's correction from tick to tick, rad or m; at least what
    /// `max_correction` is rounded by, 2^-19 of it in `f32`. It bounds the following of fast
    /// motions and transitions alike: at 1 kHz the usual 1e-3 is 1 rad/s (1 m/s on a rail), by
    /// which an arm, a tool or a payload is changed over to. Where that is a step, switch off
    /// and wait until it [is idle](super::Compensator::is_idle) before an arm or a tool is set,
    /// and let a payload grow over some hundred ticks.
    pub max_change: [T; N],
    /// Ticks in which the correction is faded in and out, with neither a step
    /// in velocity nor in acceleration; at most 2^24. Turned round half way, as when it is switched
    /// off while it is faded in, it goes back as it came: its velocity, up to 1.9 corrections a
    /// ramp, changes sign from tick to tick.
    pub ramp_ticks: u32,
    /// Length that weighs orientation against position, m, 0.001 to 10: an
    /// error of 1 rad counts as much as one of this length.
    pub rotation_length: T,
    /// Singular value of the nominal Jacobian (m per rad or m per m,
    /// orientation weighed by `rotation_length`), 0.001 to 1; 0.02 to 0.1 of the
    /// arm's reach for what [`super`] promises. Wherever the
    /// smallest one is below, the solution is damped; nowhere is it where that is
    /// above sqrt(3) times this, or sqrt(6) times for a pose.
    pub singular: T,
}

/// Largest of corrections and of their changes, rad or m: what the blob allows
/// an angle or a length to be corrected by.
const MOST_CORRECTION: f64 = 0.2;
const MOST_REFINEMENTS: u8 = 4;
/// Counted exactly in `f32`.
const LONGEST_RAMP: u32 = 1 << 24;
const ROTATION_LENGTH: [f64; 2] = [0.001, 10.0];
const SINGULAR: [f64; 2] = [0.001, 1.0];

impl<T: Scalar, const N: usize> Settings<T, N> {
    /// For an arm of about a metre ([`Self::for_reach`] for others): one refinement, corrections up to 0.03 rad
    /// (m for a prismatic joint), 1 mrad a tick, faded in over 500 ticks,
    /// damping from singular values of 0.03 m per rad on (`docs/compensation.md`
    /// has the study that chose it).
    #[must_use]
    pub fn new(task: Task) -> Self {
        Self {
            task,
            trust_nominal_orientation: false,
            refinements: 1,
            max_correction: [T::from_f64(0.03); N],
            max_change: [T::from_f64(1e-3); N],
            ramp_ticks: 500,
            rotation_length: T::from_f64(0.3),
            singular: T::from_f64(0.03),
        }
    }

    /// The same for an arm that reaches `reach` m, with its tool: `singular` and
    /// `rotation_length` are lengths of it, 0.03 and 0.3 of the reach. For arms of 0.04 to 33 m;
    /// [`super::Compensator::new`] refuses what others make of it.
    #[must_use]
    pub fn for_reach(mut self, reach: T) -> Self {
        self.singular = T::from_f64(0.03) * reach;
        self.rotation_length = T::from_f64(0.3) * reach;
        self
    }

    /// The same, with [`Self::trust_nominal_orientation`].
    #[must_use]
    pub fn trusting_nominal_orientation(mut self) -> Self {
        self.trust_nominal_orientation = true;
        self
    }

    pub(super) fn rule(&self) -> Rule<T> {
        Rule {
            pose: self.task == Task::Pose,
            threshold: self.singular * self.singular,
            weight: self.rotation_length * self.rotation_length,
        }
    }

    pub(super) fn check(&self, arm: &Arm<'_, T, N>) -> Result<(), SettingError> {
        // NaN is in no range.
        let within = |value: T, [low, high]: [f64; 2]| {
            value >= T::from_f64(low) && value <= T::from_f64(high)
        };
        let correction = |value: &T| *value > T::ZERO && within(*value, [0.0, MOST_CORRECTION]);
        let joint = |values: &[T; N]| values.iter().position(|v| !correction(v));
        if !(1..=MOST_REFINEMENTS).contains(&self.refinements) {
            return Err(SettingError::Refinements(self.refinements));
        }
        if self.ramp_ticks > LONGEST_RAMP {
            return Err(SettingError::RampTicks(self.ramp_ticks));
        }
        if !within(self.rotation_length, ROTATION_LENGTH) {
            return Err(SettingError::RotationLength);
        }
        if !within(self.singular, SINGULAR) {
            return Err(SettingError::Singular);
        }
        if let Some(joint) = joint(&self.max_correction) {
            return Err(SettingError::MaxCorrection { joint });
        }
        // What a step is rounded by must be little of it, or the last ones are no steps.
        let lost = |(change, most): (&T, &T)| *change < *most * T::EPSILON * T::from_f32(16.0);
        let steps = || self.max_change.iter().zip(&self.max_correction);
        if let Some(joint) = joint(&self.max_change).or_else(|| steps().position(lost)) {
            return Err(SettingError::MaxChange { joint });
        }
        let trusted = self.trust_nominal_orientation || arm.orientation_identified();
        if self.task == Task::Pose && !trusted {
            return Err(SettingError::OrientationNotIdentified);
        }
        Ok(())
    }
}

/// A setting that makes no sense. Joints are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingError {
    /// `refinements` is not 1 to 4.
    Refinements(u8),
    /// `ramp_ticks` is above 2^24.
    RampTicks(u32),
    /// `rotation_length` is not 0.001 to 10 m.
    RotationLength,
    /// `singular` is not 0.001 to 1 m per rad.
    Singular,
    /// `max_correction` is not above 0 and at most 0.2 rad or m.
    MaxCorrection {
        /// Of this joint.
        joint: usize,
    },
    /// `max_change` is not above 0 and at most 0.2 rad or m, or below what `max_correction` is
    /// rounded by, 2^-19 of it in `f32`.
    MaxChange {
        /// Of this joint.
        joint: usize,
    },
    /// The joint value at the start is not finite.
    Start {
        /// Of this joint.
        joint: usize,
    },
    /// [`Task::Pose`], and the arm's orientation was not identified: see
    /// [`Settings::trust_nominal_orientation`].
    OrientationNotIdentified,
}

impl core::fmt::Display for SettingError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Refinements(given) => {
                write!(f, "refinements is {given}, must be 1 to {MOST_REFINEMENTS}")
            }
            Self::RampTicks(given) => {
                write!(f, "ramp_ticks is {given}, must be at most {LONGEST_RAMP}")
            }
            Self::RotationLength => {
                let [low, high] = ROTATION_LENGTH;
                write!(f, "rotation_length must be {low} to {high} m")
            }
            Self::Singular => {
                let [low, high] = SINGULAR;
                write!(f, "singular must be {low} to {high} m per rad")
            }
            Self::MaxCorrection { joint } => write!(
                f,
                "max_correction of joint {} must be above 0 and at most {MOST_CORRECTION}",
                joint + 1
            ),
            Self::MaxChange { joint } => write!(
                f,
                "max_change of joint {} must be at most {MOST_CORRECTION} and above what its \
                 max_correction is rounded by",
                joint + 1
            ),
            Self::Start { joint } => {
                write!(f, "joint {} starts at a value that is not finite", joint + 1)
            }
            Self::OrientationNotIdentified => f.write_str(
                "Task::Pose, and the orientation of this arm was not identified: take \
                 Task::Position, or trust_nominal_orientation if you answer for it",
            ),
        }
    }
}

impl core::error::Error for SettingError {}
