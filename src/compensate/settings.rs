use crate::kinematics::{Twist, dot};
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
    /// Most linearised steps a tick, 1 to 3. One is enough while the arm moves
    /// steadily: the correction starts from that of the last tick.
    pub steps: u8,
    /// Error below which no further step is made, m.
    pub tolerance: T,
    /// Largest correction of each joint, rad or m. A correction takes back a
    /// geometric error and is a few milliradians; the bound keeps a singular
    /// pose or wrong parameters from moving the arm elsewhere.
    pub max_correction: [T; N],
    /// Largest change of a joint's correction from tick to tick, rad or m.
    pub max_change: [T; N],
    /// Ticks in which the correction is faded in and out, with neither a step
    /// in velocity nor in acceleration.
    pub ramp_ticks: u32,
    /// Length that weighs orientation against position, m: an error of 1 rad
    /// counts as much as one of this length.
    pub rotation_length: T,
    /// Singular value of the Jacobian (m per rad, orientation weighed by
    /// `rotation_length`) below which damping sets in.
    pub singular: T,
}

impl<T: Scalar, const N: usize> Settings<T, N> {
    /// For an arm of about a metre: one step a tick down to 1 um, corrections up to
    /// 0.03 rad (m for a prismatic joint), 1 mrad a tick, faded in over 500
    /// ticks, damping from singular values of 0.05 m per rad on.
    #[must_use]
    pub fn new(task: Task) -> Self {
        Self {
            task,
            steps: 1,
            tolerance: T::from_f32(1e-6),
            max_correction: [T::from_f32(0.03); N],
            max_change: [T::from_f32(1e-3); N],
            ramp_ticks: 500,
            rotation_length: T::from_f32(0.3),
            singular: T::from_f32(0.05),
        }
    }

    /// Whether an error is small enough to stop.
    #[inline]
    pub(super) fn accepts(&self, error: &Twist<T>) -> bool {
        let mut square = dot(&error.linear, &error.linear);
        if self.task == Task::Pose {
            let length = self.rotation_length;
            square += dot(&error.angular, &error.angular) * (length * length);
        }
        square <= self.tolerance * self.tolerance
    }

    pub(super) fn check(&self) -> Result<(), SettingError> {
        let positive = |value: T| value > T::ZERO && value.is_finite();
        let joint = |values: &[T; N]| values.iter().position(|v| !positive(*v));
        if !(1..=3).contains(&self.steps) {
            return Err(SettingError::Steps(self.steps));
        }
        if !(self.tolerance >= T::ZERO && self.tolerance.is_finite()) {
            return Err(SettingError::NotPositive("tolerance"));
        }
        if !positive(self.rotation_length) {
            return Err(SettingError::NotPositive("rotation_length"));
        }
        if !positive(self.singular) {
            return Err(SettingError::NotPositive("singular"));
        }
        if let Some(joint) = joint(&self.max_correction) {
            return Err(SettingError::Joint { setting: "max_correction", joint });
        }
        if let Some(joint) = joint(&self.max_change) {
            return Err(SettingError::Joint { setting: "max_change", joint });
        }
        Ok(())
    }
}

/// A setting that makes no sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingError {
    /// `steps` is not 1 to 3.
    Steps(u8),
    /// This setting must be a positive number.
    NotPositive(&'static str),
    /// This setting must be a positive number for every joint.
    Joint {
        /// Its name.
        setting: &'static str,
        /// Joint, counted from 0.
        joint: usize,
    },
    /// The joint value at the start is not finite.
    Start {
        /// Joint, counted from 0.
        joint: usize,
    },
}

impl core::fmt::Display for SettingError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Steps(steps) => write!(f, "steps is {steps}, must be 1 to 3"),
            Self::NotPositive(setting) => write!(f, "{setting} must be a positive number"),
            Self::Joint { setting, joint } => {
                write!(f, "{setting} of joint {} must be a positive number", joint + 1)
            }
            Self::Start { joint } => {
                write!(f, "joint {} starts at a value that is not finite", joint + 1)
            }
        }
    }
}

impl core::error::Error for SettingError {}
