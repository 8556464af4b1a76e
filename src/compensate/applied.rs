//! What is applied of a correction: its ramp, its bounds, and how it goes where there is none.

use super::Compensator;
use super::outcome::{Clamped, Joints, Refusal, Status, Tick};
use crate::arm::State;
use crate::scalar::Scalar;

impl<T: Scalar, const N: usize> Compensator<'_, T, N> {
    /// Goes back to the command: along the ramp where it is the state that is not known, in one
    /// whose missing readings are what they were last.
    #[cold]
    #[inline(never)]
    pub(super) fn refuse(&mut self, command: &[T; N], state: Option<&State<T, N>>) -> Tick<T, N> {
        let refusal = self.why(command, state);
        // Repeats the joints of the last tick.
        if matches!(refusal, Refusal::CommandNotFinite { .. }) {
            return self.report(Status::Refused(refusal));
        }
        let (active, mut limited) = (self.active, Joints::default());
        let mut corrected = false;
        if refusal != Refusal::OutOfRange {
            let known = self.known.get_or_insert(self.arm.state());
            if let Some(state) = state {
                known.learn(state);
            }
            self.law.correct(&self.arm, command, known, &mut self.correction);
            corrected = self.correction.is_finite();
            limited = self.correction.limited;
            self.active = false;
        }
        let mut clamped = self.apply(command, corrected);
        self.active = active;
        clamped.limit.join(limited);
        Tick { clamped, ..self.report(Status::Refused(refusal)) }
    }

    /// Moves what is applied towards the ramped correction, within all bounds;
    /// the joints follow.
    #[inline(never)]
    pub(super) fn apply(&mut self, command: &[T; N], corrected: bool) -> Clamped {
        let ticks = self.settings.ramp_ticks;
        if self.active {
            self.ramp = if self.ramp < ticks { self.ramp + 1 } else { ticks };
        } else {
            self.ramp = self.ramp.saturating_sub(1);
        }
        let share = if !corrected {
            self.correction.joints = [T::ZERO; N];
            T::ZERO
        } else if self.active && self.ramp >= ticks {
            T::ONE
        } else if self.ramp == 0 {
            T::ZERO
        } else {
            smooth(self.ramp, ticks)
        };
        let mut clamped = Clamped::default();
        let near = self.correction.near_limit;
        let was = near.then_some((self.joints, self.applied));
        let corrections = self.correction.joints.iter().zip(&self.settings.max_change);
        let places = self.joints.iter_mut().zip(&mut self.applied);
        for (i, (((joint, applied), q), (correction, change))) in
            places.zip(command).zip(corrections).enumerate()
        {
            let wanted = *correction * share;
            let moved = wanted - *applied;
            *applied = if moved.abs() > *change {
                clamped.change.hold(i, *applied, moved, *change)
            } else {
                wanted
            };
            *joint = *q + *applied;
        }
        // Elsewhere no correction reaches a limit.
        if let Some((before, had)) = was {
            self.stop(command, [&before, &had], &mut clamped.limit);
        }
        clamped
    }

    /// Stops joints at their limits.
    #[cold]
    #[inline(never)]
    fn stop(&mut self, command: &[T; N], [before, had]: [&[T; N]; 2], stopped: &mut Joints) {
        let was = before.iter().zip(had);
        let joints = self.joints.iter_mut().zip(&mut self.applied).zip(command.iter().zip(was));
        let bounds = self.law.limits.iter().zip(&self.settings.max_change);
        for (i, (((joint, applied), (q, (before, had))), (limits, change))) in
            joints.zip(bounds).enumerate()
        {
            let [low, high] = *limits;
            if *joint < low || *joint > high {
                let stop = stopped.stop(i, [*q, *joint], [*before, *had], *change, *limits);
                let outward = if *joint < low { *applied < T::ZERO } else { *applied > T::ZERO };
                // Only what a limit takes away is told from a joint value: where nothing is,
                // its rounding could undo a step. At a command so far beyond that it swallows
                // its correction that one must go all the same, or it would be there at the next.
                if stop != *joint || (stop == *q && outward) {
                    (*joint, *applied) = (stop, stop - *q);
                }
            }
        }
    }
}

/// From 0 to 1 without a step in velocity or acceleration at the ends:
/// `x^3 (10 - 15 x + 6 x^2)`.
#[inline]
fn smooth<T: Scalar>(tick: u32, ticks: u32) -> T {
    // Both at most 2^24, see the settings: exact.
    let x = T::from_f32(tick as f32 / ticks as f32);
    let c = |c: f32| T::from_f32(c);
    x * x * x * (c(10.0) + x * (x * c(6.0) - c(15.0)))
}
