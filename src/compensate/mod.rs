//! Joint compensation in every tick: the joints at which the *real* tool is
//! where the nominal model says it is.

mod damped;
mod outcome;
mod settings;

use crate::arm::{Arm, State};
use crate::kinematics::{Pose, Twist, axes, cross};
use crate::scalar::Scalar;
use damped::{Damped, Rule};

pub use outcome::{Clamped, Joints, Refusal, Status, Tick};
pub use settings::{SettingError, Settings, Task};

/// Turns the controller's nominal joint commands into corrected ones.
///
/// The correction c of a command q makes the real tool at q + c meet the
/// nominal tool at q. It is the smallest that does (damped least squares, see
/// [`Settings::singular`]), found by linearising at the correction of the tick
/// before; it depends on the command and the state only, not on the way there.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensator<'t, T, const N: usize> {
    arm: Arm<'t, T, N>,
    settings: Settings<T, N>,
    rule: Rule<T>,
    active: bool,
    /// Ticks of the ramp that have passed, 0 to `ramp_ticks`.
    ramp: u32,
    /// Full correction of the last tick.
    correction: [T; N],
    /// What of it was applied.
    applied: [T; N],
    /// Joints of the last tick.
    joints: [T; N],
    /// Joint limits, rad or m.
    limits: [[T; 2]; N],
    /// Jacobian of the last step.
    columns: [Twist<T>; N],
    step: Step<T, N>,
}

/// A linearised step.
#[derive(Debug, Clone, PartialEq)]
struct Step<T, const N: usize> {
    /// At the linearisation point.
    error: Twist<T>,
    solution: Damped<T, N>,
    /// Joints held back by `max_correction`.
    bound: Joints,
}

impl<'t, T: Scalar, const N: usize> Compensator<'t, T, N> {
    /// Switched off, for an arm that stands at `joints` (rad or m).
    ///
    /// # Errors
    /// A setting that makes no sense, by name.
    pub fn new(
        arm: Arm<'t, T, N>,
        settings: Settings<T, N>,
        joints: &[T; N],
    ) -> Result<Self, SettingError> {
        settings.check()?;
        if let Some(joint) = joints.iter().position(|q| !q.is_finite()) {
            return Err(SettingError::Start { joint });
        }
        let zero = [T::ZERO; N];
        Ok(Self {
            limits: limits(&arm),
            arm,
            rule: Rule {
                pose: settings.task == Task::Pose,
                threshold: settings.singular * settings.singular,
                weight: settings.rotation_length * settings.rotation_length,
            },
            settings,
            active: false,
            ramp: 0,
            correction: zero,
            applied: zero,
            joints: *joints,
            columns: [Twist::zero(); N],
            step: Step {
                error: Twist::zero(),
                solution: Damped { joints: zero, left: Twist::zero(), damping: T::ZERO },
                bound: Joints::default(),
            },
        })
    }

    /// The arm.
    #[must_use]
    pub fn arm(&self) -> &Arm<'t, T, N> {
        &self.arm
    }

    /// Another arm, after a re-identification or with another tool. What is
    /// applied goes over to its correction by at most `max_change` a tick.
    pub fn set_arm(&mut self, arm: Arm<'t, T, N>) {
        self.limits = limits(&arm);
        self.arm = arm;
    }

    /// Switches compensation on or off from the next tick on; it is faded in
    /// or out, also half way.
    pub fn set_active(&mut self, active: bool) {
        self.active = active;
    }

    /// One tick: the joints at which the real tool is where the nominal model
    /// has it at `command` (rad or m), in this state of the arm. Never fails: where
    /// nothing can be computed it goes back to the command, without a step, and
    /// says why. What no term depends on is not looked at in the state.
    #[inline]
    pub fn tick(&mut self, command: &[T; N], state: &State<T, N>) -> Tick<T, N> {
        let idle = !self.active && self.ramp == 0 && self.applied.iter().all(|a| *a == T::ZERO);
        if idle {
            return self.pass(command);
        }
        let target = self.arm.nominal().forward(command);
        let mut steps = 0;
        loop {
            if !self.step(command, &target, state) {
                return self.refuse(command, state);
            }
            steps += 1;
            if steps >= self.settings.steps || self.settings.accepts(&self.step.error) {
                break;
            }
        }
        let mut clamped = self.apply(command);
        clamped.bound = self.step.bound;
        let ramped = self.active && self.ramp >= self.settings.ramp_ticks;
        let mut tick = self.report(if ramped { Status::On } else { Status::Ramping });
        tick.steps = steps;
        tick.step_error = self.step.error.linear.into();
        tick.damping = self.step.solution.damping;
        tick.clamped = clamped;
        tick.covered = self.arm.covers(command);
        if !(ramped && clamped.is_empty() && tick.damping == T::ZERO) {
            let left = self.left();
            tick.position_error = left.linear.into();
            if self.rule.pose {
                tick.rotation_error = left.angular.into();
            }
        }
        tick
    }

    /// Linearises at the correction and solves for the one that leaves no
    /// error; false if that is not finite.
    // Not inlined: with the loop around it the optimiser would compute every
    // address ahead.
    #[inline(never)]
    fn step(&mut self, command: &[T; N], target: &Pose<T>, state: &State<T, N>) -> bool {
        let mut q = *command;
        for (q, c) in q.iter_mut().zip(&self.correction) {
            *q += *c;
        }
        let real = self.arm.real_jacobian(&q, state, &mut self.columns);
        let step = &mut self.step;
        step.error = error_at(&real, target);
        step.solution = damped::solve(&self.columns, &step.error, &self.correction, &self.rule);
        step.bound = Joints::default();
        // A number times zero is zero; an infinity or a NaN is NaN.
        let mut zero = T::ZERO;
        let corrections = self.correction.iter_mut().zip(&self.settings.max_correction);
        for (i, (x, (correction, most))) in step.solution.joints.iter().zip(corrections).enumerate()
        {
            zero += *x * T::ZERO;
            *correction = *x;
            if x.abs() > *most {
                *correction = step.bound.hold(i, *x, *most);
            }
        }
        zero == T::ZERO
    }

    /// Switched off: the joints are the command, if that is finite.
    fn pass(&mut self, command: &[T; N]) -> Tick<T, N> {
        if !finite(command) {
            return self.hold(command);
        }
        self.correction = [T::ZERO; N];
        self.joints = *command;
        self.report(Status::Off)
    }

    /// Repeats the joints of the last tick, as the command is not finite.
    fn hold(&self, command: &[T; N]) -> Tick<T, N> {
        let joint = command.iter().position(|q| !q.is_finite()).unwrap_or(N);
        self.report(Status::Refused(Refusal::CommandNotFinite { joint }))
    }

    /// Goes back to the command.
    #[inline(never)]
    fn refuse(&mut self, command: &[T; N], state: &State<T, N>) -> Tick<T, N> {
        if !finite(command) {
            return self.hold(command);
        }
        let known = finite(&[state.payload, state.temperature]);
        let refusal = if known { Refusal::OutOfRange } else { Refusal::StateNotFinite };
        self.correction = [T::ZERO; N];
        let clamped = self.apply(command);
        Tick { clamped, ..self.report(Status::Refused(refusal)) }
    }

    /// Moves what is applied towards the ramped correction, within all bounds;
    /// the joints follow.
    #[inline]
    fn apply(&mut self, command: &[T; N]) -> Clamped {
        let ticks = self.settings.ramp_ticks;
        if self.active {
            self.ramp = if self.ramp < ticks { self.ramp + 1 } else { ticks };
        } else {
            self.ramp = self.ramp.saturating_sub(1);
        }
        let share = if self.active && self.ramp >= ticks {
            T::ONE
        } else if self.ramp == 0 {
            T::ZERO
        } else {
            smooth(self.ramp, ticks)
        };
        let mut clamped = Clamped::default();
        let corrections = self.correction.iter().zip(&self.settings.max_change);
        let commands = command.iter().zip(&self.limits);
        let joints = self.joints.iter_mut().zip(&mut self.applied);
        for (i, (((joint, applied), (q, [low, high])), (correction, change))) in
            joints.zip(commands).zip(corrections).enumerate()
        {
            let mut moved = *correction * share - *applied;
            if moved.abs() > *change {
                moved = clamped.change.hold(i, moved, *change);
            }
            *applied += moved;
            *joint = *q + *applied;
            if *joint < *low || *joint > *high {
                *joint = clamped.limit.stop(i, *q, *joint, [*low, *high]);
                *applied = *joint - *q;
            }
        }
        clamped
    }

    /// What the applied correction leaves of the error, to first order.
    #[inline(never)]
    fn left(&self) -> Twist<T> {
        let solution = &self.step.solution;
        let Twist { mut linear, mut angular } = solution.left;
        let missing = solution.joints.iter().zip(&self.applied);
        for (column, (full, applied)) in self.columns.iter().zip(missing) {
            linear += column.linear * (*full - *applied);
            angular += column.angular * (*full - *applied);
        }
        Twist { linear, angular }
    }

    fn report(&self, status: Status) -> Tick<T, N> {
        Tick {
            joints: self.joints,
            status,
            steps: 0,
            step_error: [T::ZERO; 3],
            position_error: [T::ZERO; 3],
            rotation_error: [T::ZERO; 3],
            damping: T::ZERO,
            clamped: Clamped::default(),
            covered: false,
            orientation_identified: self.arm.orientation_identified(),
        }
    }
}

/// Joint limits, those of the number type where there are none.
fn limits<T: Scalar, const N: usize>(arm: &Arm<T, N>) -> [[T; 2]; N] {
    arm.limits().map(|limit| limit.unwrap_or([-T::MAX, T::MAX]))
}

fn finite<T: Scalar, const M: usize>(values: &[T; M]) -> bool {
    values.iter().all(|value| value.is_finite())
}

/// From the real to the nominal pose. The rotation vector is half the sum of the
/// cross products of the axes, short of the angle by a sixth of its cube.
#[inline]
fn error_at<T: Scalar>(real: &Pose<T>, nominal: &Pose<T>) -> Twist<T> {
    let ([a, b, c], [x, y, z]) = (axes(&real.rotation), axes(&nominal.rotation));
    Twist {
        linear: nominal.translation - real.translation,
        angular: (cross(&a, &x) + cross(&b, &y) + cross(&c, &z)) * T::from_f32(0.5),
    }
}

/// From 0 to 1 without a step in velocity or acceleration at the ends:
/// `x^3 (10 - 15 x + 6 x^2)`.
#[inline]
fn smooth<T: Scalar>(tick: u32, ticks: u32) -> T {
    // Both below 2^24, or the ramp is hours long.
    let x = T::from_f32(tick as f32 / ticks as f32);
    let c = |c: f32| T::from_f32(c);
    x * x * x * (c(10.0) + x * (x * c(6.0) - c(15.0)))
}
