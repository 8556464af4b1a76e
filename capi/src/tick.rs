//! Ticks, and the state of the arm that they are told.

use core::mem::MaybeUninit;

use truearm::{Compensator, Scalar, State};

use crate::convert::state_from;
use crate::pointer::{handle, input, writable};
use crate::poses::state_or_neutral;
use crate::types::{TRUEARM_JOINTS, TruearmError, TruearmState, TruearmStatus, TruearmTick};
use crate::{Result, Truearm, code};

type Joints = [f32; TRUEARM_JOINTS];

/// The state to begin with: no payload, at the reference temperature of the parameters,
/// approach unknown, no torques read. What is known of the arm is then written over it.
///
/// # Safety
/// Every pointer is NULL or as typed.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_default_state(
    arm: *mut Truearm,
    state: *mut TruearmState,
) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let this = unsafe { handle(arm)? };
        writable(state)?;
        let neutral = state_from(&this.arm()?.state());
        // SAFETY: the caller's promise; not NULL and aligned.
        unsafe { state.write(neutral) };
        Ok(())
    })())
}

/// The temperature of the arm for `temperature_c` of a state, degrees Celsius, at a
/// reading of its thermometer that was taken `dt_s` seconds after the one before: the
/// reading itself, unless the arm was found to follow it late. The first reading after
/// `truearm_init` is where the arm begins, as nothing is known of what was before. Call
/// it with every reading, once a second or in every tick; one that is no number lets
/// time pass.
///
/// # Safety
/// Every pointer is NULL or as typed.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_arm_temperature(
    arm: *mut Truearm,
    dt_s: f32,
    reading_c: f32,
    temperature_c: *mut f32,
) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let this = unsafe { handle(arm)? };
        writable(temperature_c)?;
        this.arm()?;
        let arm = this.lag.step(dt_s, reading_c);
        // SAFETY: the caller's promise; not NULL and aligned.
        unsafe { temperature_c.write(arm) };
        Ok(())
    })())
}

/// One control tick: the joints, rad, at which the real tool is where the
/// nominal model has it at `command`, rad. Without a state (NULL) as for
/// `truearm_real_pose`. TRUEARM_ERROR_OK whatever the numbers: `tick` then holds
/// finite joints, and its status says whether they are compensated.
///
/// On an error stop, as on a status from TRUEARM_STATUS_COMMAND_NOT_FINITE on. `tick` is
/// written all the same, so that what is sent until the arm stands is no garbage:
///
/// - TRUEARM_ERROR_NULL, TRUEARM_ERROR_ALIGNMENT: a pointer is bad. That of `command`: the
///   joints of the last tick, TRUEARM_STATUS_COMMAND_NOT_FINITE. That of `state`, not aligned:
///   as for a bad state. That of `arm`: as without an arm. That of `tick`: nothing happens.
/// - TRUEARM_ERROR_BAD_STATE, TRUEARM_ERROR_BAD_APPROACH: a field of the state is none of its
///   values. The correction of the last good state fades, as if switched off for this tick, without
///   a step: TRUEARM_STATUS_STATE_NOT_FINITE.
/// - TRUEARM_ERROR_NOT_INITIALISED, TRUEARM_ERROR_NOT_LOADED: there is no arm, or it has no
///   parameters. The command as it is, uncorrected, however far that is from the joints of the
///   last tick: TRUEARM_STATUS_NO_ARM.
///
/// # Safety
/// Every pointer is NULL or as typed; `command` points to 6 floats.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_tick(
    arm: *mut Truearm,
    command: *const f32,
    state: *const TruearmState,
    tick: *mut TruearmTick,
) -> TruearmError {
    code((|| {
        writable(tick)?;
        // SAFETY: the caller's promise.
        let (command, this) = unsafe { (input(command.cast::<Joints>()), handle(arm)) };
        let compensator = this.and_then(Truearm::ticking).inspect_err(|_| {
            // SAFETY: the caller's promise; not NULL and aligned.
            unsafe { uncorrected(command, tick) }
        })?;
        // SAFETY: the caller's promise.
        let state = unsafe { state_or_neutral(compensator.arm(), state) };
        let done = step(compensator, command, &state);
        // SAFETY: the caller's promise; not NULL and aligned.
        unsafe { tick.write(done) };
        command.and(state.map(|_| ()))
    })())
}

/// A tick, also of what could not be read.
fn step(
    compensator: &mut Compensator<'_, f32, TRUEARM_JOINTS>,
    command: Result<Joints>,
    state: &Result<State<f32, TRUEARM_JOINTS>>,
) -> TruearmTick {
    // Of a command that is no number the last joints are repeated.
    let command = command.unwrap_or([f32::NAN; TRUEARM_JOINTS]);
    let Ok(state) = state else {
        let done = TruearmTick::from(&compensator.tick_without_state(&command));
        // Also while it is off: the caller is told of an error.
        let off = done.status == TruearmStatus::Off;
        let status = if off { TruearmStatus::StateNotFinite } else { done.status };
        return TruearmTick { status, ..done };
    };
    TruearmTick::from(&compensator.tick(&command, state))
}

/// The tick of no arm: the command, or whatever joints lie there if it cannot be sent.
///
/// # Safety
/// `tick` is writable and aligned.
#[cold]
unsafe fn uncorrected(command: Result<Joints>, tick: *mut TruearmTick) {
    let finite = command.ok().filter(|q| q.iter().all(|q| Scalar::is_finite(*q)));
    // SAFETY: the caller's promise; nothing is made of what may not be initialised.
    unsafe {
        let joints = (&raw mut (*tick).joints).cast::<MaybeUninit<Joints>>();
        let kept = finite.map_or(joints.read(), MaybeUninit::new);
        tick.write(TruearmTick::refused([0.0; TRUEARM_JOINTS], TruearmStatus::NoArm));
        joints.write(kept);
    }
}
