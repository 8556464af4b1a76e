//! Where the tool is at given joints, and how sure that is.

use truearm::{Arm6, Pose, Scalar, State};

use crate::convert::state_of;
use crate::pointer::{handle, input, optional, writable};
use crate::types::{TRUEARM_JOINTS, TruearmError, TruearmPose, TruearmState};
use crate::{Result, Truearm, code};

/// Where the tool really is at encoder readings, rad. Without a state (NULL):
/// no payload, at the reference temperature, approach unknown.
///
/// # Safety
/// Every pointer is NULL or as typed; `encoders` points to 6 floats.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_real_pose(
    arm: *mut Truearm,
    encoders: *const f32,
    state: *const TruearmState,
    pose: *mut TruearmPose,
) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let (this, q) = unsafe { asked(arm, encoders, pose)? };
        let arm = this.arm()?;
        // SAFETY: the caller's promise.
        let state = unsafe { state_or_neutral(arm, state)? };
        finish(pose, &arm.real_pose_in(&q, &state), arm.covers(&q))
    })())
}

/// Where the tool is by the nominal model, which is the controller's own.
///
/// # Safety
/// Every pointer is NULL or as typed; `joints` points to 6 floats.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_nominal_pose(
    arm: *mut Truearm,
    joints: *const f32,
    pose: *mut TruearmPose,
) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let (this, q) = unsafe { asked(arm, joints, pose)? };
        let arm = this.arm()?;
        #[cfg(feature = "negative_control")]
        let q = [q[q[0] as usize]; TRUEARM_JOINTS];
        finish(pose, &arm.nominal().forward(&q), arm.covers(&q))
    })())
}

/// One standard deviation of where the tool really is at encoder readings, rad,
/// along x, y and z of the nominal base frame, m: of the identification, within
/// the joint ranges that it covered. Without a state (NULL) as for
/// `truearm_real_pose`. A tool of `truearm_set_tool` counts as exact. Takes some
/// ten thousand instructions: for a check point, not for every tick.
///
/// # Safety
/// Every pointer is NULL or as typed; `encoders` points to 6 floats, `sigma` to 3.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_point_sigma(
    arm: *mut Truearm,
    encoders: *const f32,
    state: *const TruearmState,
    sigma: *mut f32,
) -> TruearmError {
    code((|| {
        let place = sigma.cast::<[f32; 3]>();
        // SAFETY: the caller's promise.
        let (this, q) = unsafe { asked(arm, encoders, place)? };
        let arm = this.arm()?;
        // SAFETY: the caller's promise.
        let state = unsafe { state_or_neutral(arm, state)? };
        let covariance = this.covariance.ok_or(TruearmError::NoCovariance)?;
        // It came with this arm's parameters.
        let sigma =
            covariance.point_sigma(arm, &q, &state).map_err(|_| TruearmError::NoCovariance)?;
        if !sigma.iter().all(|value| Scalar::is_finite(*value)) {
            return Err(TruearmError::NotFinite);
        }
        // SAFETY: the caller's promise; not NULL and aligned.
        unsafe { place.write(sigma) };
        Ok(())
    })())
}

/// What every question of a place needs: an arm, joints, and where the answer goes.
///
/// # Safety
/// Every pointer is NULL or as typed; `joints` points to 6 floats.
unsafe fn asked<'a, P>(
    arm: *mut Truearm,
    joints: *const f32,
    place: *mut P,
) -> Result<(&'a Truearm, [f32; TRUEARM_JOINTS])> {
    // SAFETY: the caller's promise.
    let all = unsafe { (&*handle(arm)?, input(joints.cast())?) };
    writable(place)?;
    Ok(all)
}

/// # Safety
/// `state` is NULL or as typed.
pub unsafe fn state_or_neutral(
    arm: &Arm6<'_, f32>,
    state: *const TruearmState,
) -> Result<State<f32, TRUEARM_JOINTS>> {
    // SAFETY: the caller's promise.
    match unsafe { optional(state)? } {
        Some(state) => state_of(&state),
        None => Ok(arm.state()),
    }
}

fn finish(place: *mut TruearmPose, pose: &Pose<f32>, covered: bool) -> Result {
    let pose = TruearmPose::new(pose, covered);
    if !pose.matrix.iter().flatten().all(|value| Scalar::is_finite(*value)) {
        return Err(TruearmError::NotFinite);
    }
    // SAFETY: `writable` has checked it and the caller promised the rest.
    unsafe { place.write(pose) };
    Ok(())
}
