//! Joint compensation in every tick: the joints at which the *real* tool is
//! where the nominal model says it is.
//!
//! Two layers. The **law** gives the correction c of a command:
//!
//! * c depends on the command and on the state of the arm, on nothing else: not
//!   on the ticks before, nor on the way to the command. A reading of the state that is no number
//!   and that a term needs is in its place what it was last.
//! * c is continuous in the command, the payload, the temperature and the torques, except
//!   where a term itself jumps (approach, the side of a gap that gravity
//!   chooses).
//! * at q + c the tool is never farther from its target than at q, the command
//!   as it is, but for 2 % and 2 um: in position, or for [`Task::Pose`] in
//!   `sqrt(|dp|^2 + rotation_length^2 |dw|^2)`. This is for arms that are off by
//!   thousandths of their reach, tools within it, joints that turn, `singular` 0.02 to 0.1 of the
//!   reach, `max_correction` up to `singular` over the reach, and in `f32` for
//!   commands within 100 rad, and within 8192 rad over the highest order of a periodic term of
//!   the joint, 81 rad with an order of 101: beyond it a tick is refused. Where it is damped, what terms bend a joint by may
//!   add up to 0.07 mm a mrad, and play its own size. `docs/compensation.md` has
//!   what was seen beyond.
//! * no joint is corrected by more than `max_correction`, but for four roundings of it, nor
//!   beyond a limit, to the last bit; all joints are scaled by one factor to stay within, so that
//!   what is applied is a part of the way to the solution.
//!
//! What is **applied** goes to c by at most `max_change` a tick, but for a joint that a
//! limit stops, which gives up at once what would take it beyond, and stands there, exactly,
//! within `ceil(max |c - applied| / max_change)` ticks of a standing command after the ramp. A
//! step is rounded as sums are, by at most a 32nd of the smallest `max_change` and two
//! millionths of the usual one in `f32`: by that share of the ticks, and one more, it may be
//! later, and by that share a change may be larger. On the
//! way there, as after [`Compensator::set_arm`], where the joints may first have to come in from
//! beyond narrower limits, or where a fast motion near a
//! singular pose asks for more than `max_change` a tick, nothing is claimed but that.
//!
//! Each is a property test of `tests/compensate`; `docs/compensation.md` says
//! why they must hold and where they end.

mod applied;
mod correction;
mod damped;
mod law;
mod outcome;
mod settings;

use crate::arm::{Arm, State};
use crate::kinematics::Pose;
use crate::scalar::Scalar;
use correction::Correction;
use law::Law;

pub use outcome::{Clamped, Joints, Refusal, Status, TaskError, Tick};
pub use settings::{SettingError, Settings, Task};

/// Turns the controller's nominal joint commands into corrected ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensator<'t, T, const N: usize> {
    arm: Arm<'t, T, N>,
    settings: Settings<T, N>,
    law: Law<T, N>,
    active: bool,
    /// Ticks of the ramp that have passed, 0 to `ramp_ticks`.
    ramp: u32,
    /// The state that a correction was last computed in; its values stand in for readings that
    /// are missing.
    known: Option<State<T, N>>,
    /// The applied correction.
    applied: [T; N],
    /// Joints of the last tick.
    joints: [T; N],
    /// Of the last tick; nothing of it counts in the next.
    correction: Correction<T, N>,
}

impl<'t, T: Scalar, const N: usize> Compensator<'t, T, N> {
    /// Switched off, for an arm that stands at `joints` (rad or m).
    ///
    /// # Errors
    /// A setting that makes no sense, by name; [`Task::Pose`] for an arm whose
    /// orientation was not identified.
    pub fn new(
        arm: Arm<'t, T, N>,
        settings: Settings<T, N>,
        joints: &[T; N],
    ) -> Result<Self, SettingError> {
        settings.check(&arm)?;
        if let Some(joint) = joints.iter().position(|q| !q.is_finite()) {
            return Err(SettingError::Start { joint });
        }
        let law = Law::new(&arm, &settings);
        let applied = [T::ZERO; N];
        let correction = Correction::none(settings.max_correction);
        Ok(Self {
            arm,
            settings,
            law,
            active: false,
            ramp: 0,
            known: None,
            applied,
            joints: *joints,
            correction,
        })
    }

    /// The arm.
    #[must_use]
    pub fn arm(&self) -> &Arm<'t, T, N> {
        &self.arm
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &Settings<T, N> {
        &self.settings
    }

    /// What the last tick added to its command, rad or m; one whose command was not finite
    /// changed nothing.
    #[must_use]
    pub fn applied(&self) -> &[T; N] {
        &self.applied
    }

    /// Another arm, after a re-identification ([`Arm::with_parameters`], which keeps the
    /// production tool) or with another tool. What is applied goes over to its correction
    /// by at most `max_change` a tick. From a buffer that is used again:
    /// [`ArmParameters::detached`](crate::ArmParameters::detached), and the example `update`.
    ///
    /// # Errors
    /// [`SettingError::OrientationNotIdentified`]; the arm is then the old one.
    pub fn set_arm(&mut self, arm: Arm<'t, T, N>) -> Result<(), SettingError> {
        self.settings.check(&arm)?;
        self.law = Law::new(&arm, &self.settings);
        self.arm = arm;
        Ok(())
    }

    /// The production tool, a pose in the flange frame, also while compensation is on: what is
    /// applied goes over to its correction by at most `max_change` a tick. In place, so that a
    /// control task can call it between two ticks: [`Self::set_arm`] of
    /// [`Arm::with_tool`] does the same and takes 8 KB of stack in place of half a one.
    pub fn set_tool(&mut self, tool: &Pose<T>) {
        // Of the law nothing depends on what is behind the last joint.
        self.arm.set_tool(tool);
    }

    /// Switches compensation on or off from the next tick on; it is faded in
    /// or out, also half way: from where it is along the same ramp, see
    /// [`Settings::ramp_ticks`].
    pub fn set_active(&mut self, active: bool) {
        self.active = active;
    }

    /// Whether it is switched on, however far it has been faded in.
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.active
    }

    /// Whether it is switched off and nothing is left of it: the next tick gives its command.
    #[must_use]
    #[inline]
    pub fn is_idle(&self) -> bool {
        !self.active && self.ramp == 0 && self.applied.iter().all(|a| *a == T::ZERO)
    }

    /// One tick: the joints at which the real tool is where the nominal model
    /// has it at `command` (rad or m), in this state of the arm. Never fails: where
    /// nothing can be computed it goes back to the command, and
    /// says why ([`Status::Refused`]). What no term depends on is not looked at in the state; of
    /// torques that are read all joints' are, where a term follows any.
    #[inline]
    pub fn tick(&mut self, command: &[T; N], state: &State<T, N>) -> Tick<T, N> {
        if self.is_idle() {
            return self.pass(command);
        }
        if self.arm.bends() {
            // What is no number but not needed, either, is no reason.
            if !state.is_finite(self.arm.reads_torques()) && !self.arm.can_be_in(state) {
                return self.refuse(command, Some(state));
            }
            self.known = Some(*state);
        }
        self.law.correct(&self.arm, command, state, &mut self.correction);
        if !self.correction.is_finite() {
            return self.refuse(command, Some(state));
        }
        let mut clamped = self.apply(command, true);
        clamped.bound = self.correction.bound;
        clamped.limit.join(self.correction.limited);
        let ramped = self.active && self.ramp >= self.settings.ramp_ticks;
        let mut tick = self.report(if ramped { Status::On } else { Status::Ramping });
        tick.damping = Some(self.correction.damping());
        tick.clamped = clamped;
        tick.covered = Some(self.arm.covers(command));
        if !tick.is_complete() {
            tick.left = self.left(state);
        }
        tick
    }

    /// One tick of a controller that does not know the state of the arm at all, as after a bus
    /// is lost: as [`Self::tick`] in the state of the last one, with its correction fading as if
    /// switched off for this tick; [`Refusal::StateNotFinite`].
    pub fn tick_without_state(&mut self, command: &[T; N]) -> Tick<T, N> {
        if self.is_idle() {
            return self.pass(command);
        }
        self.refuse(command, None)
    }

    /// The law alone: the correction of a command (rad or m) in a state of the
    /// arm, whatever is applied at present. What a tick goes to.
    ///
    /// # Errors
    /// As [`Status::Refused`] of a tick.
    pub fn correction(&self, command: &[T; N], state: &State<T, N>) -> Result<[T; N], Refusal> {
        let mut correction = Correction::none(self.settings.max_correction);
        self.law.correct(&self.arm, command, state, &mut correction);
        if correction.is_finite() {
            Ok(correction.joints)
        } else {
            Err(self.why(command, Some(state)))
        }
    }

    /// By how much the tool misses where the nominal model has it at `command`,
    /// with the arm at encoder readings `joints`, both rad or m, in this state. Wherever the
    /// arm stands, also with its tool upside down: the rotation is exact for any angle.
    #[must_use]
    pub fn error(&self, command: &[T; N], joints: &[T; N], state: &State<T, N>) -> TaskError<T> {
        let nominal = self.arm.nominal().forward(command);
        let real = self.arm.real_pose_in(joints, state);
        let position = nominal.translation - real.translation;
        let rotation = nominal.compose(&real.inverse()).rotation_vector();
        TaskError { position: position.into(), rotation: rotation.into() }
    }

    /// The same of the joints of this tick, by what the law has at hand; `None`
    /// where the model has no finite pose.
    #[cold]
    #[inline(never)]
    fn left(&mut self, state: &State<T, N>) -> Option<TaskError<T>> {
        let left: TaskError<T> =
            self.law.error(&self.arm, &self.joints, state, &mut self.correction).into();
        (finite(&left.position) && finite(&left.rotation)).then_some(left)
    }

    /// Switched off: the joints are the command, if that is finite.
    fn pass(&mut self, command: &[T; N]) -> Tick<T, N> {
        if !finite(command) {
            return self.refuse(command, None);
        }
        self.joints = *command;
        self.report(Status::Off)
    }

    /// Why no correction could be computed.
    #[cold]
    fn why(&self, command: &[T; N], state: Option<&State<T, N>>) -> Refusal {
        if let Some(joint) = command.iter().position(|q| !q.is_finite()) {
            return Refusal::CommandNotFinite { joint };
        }
        let Some(state) = state else { return Refusal::StateNotFinite };
        if self.arm.reads_torques() && state.torque.is_none() {
            return Refusal::TorqueUnknown;
        }
        let known = self.arm.can_be_in(state);
        if known { Refusal::OutOfRange } else { Refusal::StateNotFinite }
    }

    fn report(&self, status: Status) -> Tick<T, N> {
        Tick {
            joints: self.joints,
            status,
            left: None,
            damping: None,
            clamped: Clamped::default(),
            covered: None,
            orientation_identified: self.arm.orientation_identified(),
        }
    }
}

fn finite<T: Scalar, const M: usize>(values: &[T; M]) -> bool {
    values.iter().all(|value| value.is_finite())
}
