use crate::scalar::Scalar;

/// A set of joints, as bits: joint i, counted from 0, is bit i.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Joints(pub u16);

impl Joints {
    /// Whether joint `index`, counted from 0, is in it.
    #[must_use]
    pub const fn contains(self, index: usize) -> bool {
        index < 16 && self.0 >> index & 1 != 0
    }

    /// Whether no joint is in it.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    fn insert(&mut self, index: usize) {
        self.0 |= 1_u16.checked_shl(index as u32).unwrap_or(0);
    }

    /// Notes that joint `index` is held: `value` at a magnitude of `most`.
    // Cold: what rarely happens must not cost a tick in which it does not.
    #[cold]
    #[inline(never)]
    pub(super) fn hold<T: Scalar>(&mut self, index: usize, value: T, most: T) -> T {
        self.insert(index);
        if value > T::ZERO { most } else { -most }
    }

    /// The joint, which is beyond a limit, at that limit; or at the command
    /// where this is beyond it already, as the controller may have reasons.
    #[cold]
    #[inline(never)]
    pub(super) fn stop<T: Scalar>(
        &mut self,
        index: usize,
        command: T,
        joint: T,
        [low, high]: [T; 2],
    ) -> T {
        let stopped = if joint < low {
            if command < low { command } else { low }
        } else if command > high {
            command
        } else {
            high
        };
        // Back inwards from a command beyond the limit is free.
        let outwards = if joint < low { joint < stopped } else { joint > stopped };
        if outwards {
            self.insert(index);
            stopped
        } else {
            joint
        }
    }
}

/// What stopped a joint's correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Clamped {
    /// `max_correction`.
    pub bound: Joints,
    /// `max_change`.
    pub change: Joints,
    /// A joint limit of the parameters.
    pub limit: Joints,
}

impl Clamped {
    /// Whether nothing was.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.bound.is_empty() && self.change.is_empty() && self.limit.is_empty()
    }
}

/// Why a tick did not compensate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Refusal {
    /// The command of this joint (from 0) is infinite or NaN: the joints of
    /// the tick before are repeated.
    CommandNotFinite {
        /// Joint, counted from 0.
        joint: usize,
    },
    /// The payload or the temperature is infinite or NaN.
    StateNotFinite,
    /// A result is not finite: a joint beyond the range of
    /// [`crate::Scalar::sin_cos`], or lengths beyond that of the number type.
    OutOfRange,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::CommandNotFinite { joint } => {
                write!(f, "the command of joint {} is not finite", joint + 1)
            }
            Self::StateNotFinite => f.write_str("payload or temperature is not finite"),
            Self::OutOfRange => f.write_str("no finite pose at this command"),
        }
    }
}

impl core::error::Error for Refusal {}

/// How far a tick went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Status {
    /// Switched off: the joints are the command.
    Off,
    /// Being faded in or out.
    Ramping,
    /// The whole correction, but for what [`Tick::clamped`] says.
    On,
    /// No correction could be computed; what was applied goes back to zero by
    /// at most `max_change` a tick.
    Refused(Refusal),
}

/// What one tick did.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tick<T, const N: usize> {
    /// Joints to command, rad or m: always finite.
    pub joints: [T; N],
    /// How far it went.
    pub status: Status,
    /// Linearised steps made.
    pub steps: u8,
    /// Error of the tool point that the last step found and took back, m. Where
    /// it is not small the remainders below, of first order, say less.
    pub step_error: [T; 3],
    /// What is left of the error of the tool point at `joints`, to first
    /// order: where the nominal model says it is, less where it is; m.
    pub position_error: [T; 3],
    /// The same of the orientation, as a rotation vector, rad. Zeros in
    /// [`super::Task::Position`].
    pub rotation_error: [T; 3],
    /// mu of the last step, m^2; 0 away from singular poses.
    pub damping: T,
    /// What held joints back.
    pub clamped: Clamped,
    /// Whether the command lies in the joint ranges that the identification
    /// covered. Outside of them the correction is extrapolated.
    pub covered: bool,
    /// Whether the data determined the flange's orientation; if not, only the
    /// tool point is better than nominal.
    pub orientation_identified: bool,
}
