use crate::kinematics::Twist;
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

    pub(super) fn insert(&mut self, index: usize) {
        self.0 |= 1_u16.checked_shl(index as u32).unwrap_or(0);
    }

    pub(super) fn join(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// Notes that joint `index` is held: from `value` by `most` in the direction of `by`.
    // Cold: what rarely happens must not cost a tick in which it does not.
    #[cold]
    #[inline(never)]
    pub(super) fn hold<T: Scalar>(&mut self, index: usize, value: T, by: T, most: T) -> T {
        self.insert(index);
        if by > T::ZERO { value + most } else { value - most }
    }

    /// Where a joint that would be beyond a limit stands instead: at that limit;
    /// at the command where this is beyond it already, as the controller may have
    /// reasons; and not further in than by `change` from where it was `before`,
    /// if an arm with narrower limits left it outside. That is told by the correction that it
    /// `had`: by a command it may have been anywhere.
    // Not inlined: unrolled for every joint it would take a kilobyte.
    #[inline(never)]
    pub(super) fn stop<T: Scalar>(
        &mut self,
        index: usize,
        [command, joint]: [T; 2],
        [before, had]: [T; 2],
        change: T,
        [low, high]: [T; 2],
    ) -> T {
        self.insert(index);
        let least = |a: T, b: T| if a < b { a } else { b };
        let most = |a: T, b: T| if a > b { a } else { b };
        if joint < low {
            let end = least(low, command);
            let stop = least(end, most(before, end + had) + change);
            most(stop, joint)
        } else {
            let end = most(high, command);
            let stop = most(end, least(before, end + had) - change);
            least(stop, joint)
        }
    }
}

/// What stopped a joint's correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Clamped {
    /// These would be corrected by more than `max_correction`: all are scaled.
    pub bound: Joints,
    /// These change by `max_change`.
    pub change: Joints,
    /// These are near a joint limit of the parameters or at it.
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
    /// The payload, the temperature or a torque is infinite or NaN, and a term depends on it: its
    /// last good value counts, and the correction fades.
    StateNotFinite,
    /// A term follows torques that are read, and the state has none,
    /// [`Arm::reads_torques`](crate::Arm::reads_torques): the last ones count, and the correction
    /// fades.
    TorqueUnknown,
    /// A result is not finite: a joint, or a joint times the order of a periodic error, beyond the
    /// range of [`crate::Scalar::sin_cos`] (8192 rad in `f32`), or lengths beyond that of the number type.
    OutOfRange,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::CommandNotFinite { joint } => {
                write!(f, "the command of joint {} is not finite", joint + 1)
            }
            Self::StateNotFinite => f.write_str("payload, temperature or torque is not finite"),
            Self::TorqueUnknown => f.write_str("no torques of the joints are given"),
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
    /// No correction of this command and state could be computed. Where a reading of the state
    /// is missing, what it was last counts in its place, and the correction fades by the ramp, as
    /// if switched off for this tick: one that is missed is no step, and one that stays away is
    /// gone after [`super::Settings::ramp_ticks`]. Beyond the range of numbers what was applied
    /// goes back to zero by at most `max_change` a tick.
    Refused(Refusal),
}

/// By how much the tool misses: where the nominal model says it is, less where
/// it is; in the commanded frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TaskError<T> {
    /// Of the tool point, m.
    pub position: [T; 3],
    /// Of the orientation, as a rotation vector (axis times angle) of at most half a turn,
    /// rad. What a tick has left is it to first order: its share wrong by about the angle
    /// itself, a thousandth at a milliradian, and too small from a right angle on;
    /// [`Compensator::error`](super::Compensator::error) is exact.
    pub rotation: [T; 3],
}

impl<T: Scalar> From<Twist<T>> for TaskError<T> {
    fn from(error: Twist<T>) -> Self {
        Self { position: error.linear.into(), rotation: error.angular.into() }
    }
}

/// What one tick did. What a tick had no need to compute is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "`joints` are what the arm is to be commanded to"]
pub struct Tick<T, const N: usize> {
    /// Joints to command, rad or m: always finite, and the command but for a correction within
    /// its bounds, or the joints of the last tick where the command is not finite. Whether the
    /// arm may go where it is commanded is not judged here: one that is finite and absurd is
    /// handed on, also where it is [refused](Refusal::OutOfRange).
    pub joints: [T; N],
    /// How far it went.
    pub status: Status,
    /// By how much the model misses its target at `joints`; computed where
    /// anything held the correction back and the model has a finite pose. A [complete](Tick::is_complete) tick
    /// leaves what its [`super::Settings::refinements`] leave.
    pub left: Option<TaskError<T>>,
    /// mu of the damped least squares, m^2; 0 away from singular poses.
    pub damping: Option<T>,
    /// What held joints back.
    pub clamped: Clamped,
    /// Whether the identification [covers](crate::Arm::covers) the command. Elsewhere the
    /// correction is extrapolated.
    pub covered: Option<bool>,
    /// Whether the data determined the flange's orientation; if not, only the
    /// tool point is better than nominal.
    pub orientation_identified: bool,
}

impl<T: Scalar, const N: usize> Tick<T, N> {
    /// Whether the whole error was taken back: switched on, not damped, and
    /// nothing held back.
    #[must_use]
    #[inline]
    pub fn is_complete(&self) -> bool {
        let damped = self.damping.is_none_or(|damping| damping > T::ZERO);
        self.status == Status::On && !damped && self.clamped.is_empty()
    }
}
