//! Pointers to nothing, crooked ones, and memory without an arm.

use super::*;

#[test]
fn null_is_refused_everywhere() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    let (q, blob, size) = (Q.as_ptr(), BLOB.as_ptr(), BLOB.len());
    let (mut settings, mut state) = (usual(), NEUTRAL);
    let (mut place, mut tick) = (null_mut(), MaybeUninit::uninit());
    let (mut pose, mut sigma) = (MaybeUninit::uninit(), [0.0; 3]);
    let (tick, pose, sigma) = (tick.as_mut_ptr(), pose.as_mut_ptr(), sigma.as_mut_ptr());
    let mut other = self::memory();
    let other = (&raw mut *other).cast();
    let (none, tool) = (null_mut(), [0.0_f32; 12].as_ptr());
    // SAFETY: every pointer is NULL or as typed.
    let errors = unsafe {
        [
            truearm_init(TRUEARM_VERSION, null_mut(), TRUEARM_MEMORY_SIZE, &mut place),
            truearm_init(TRUEARM_VERSION, other, TRUEARM_MEMORY_SIZE, null_mut()),
            truearm_load(none, blob, size, robot(), &settings, q),
            truearm_load(arm, null(), size, robot(), &settings, q),
            truearm_load(arm, blob, size, robot(), null(), q),
            truearm_load(arm, blob, size, robot(), &settings, null()),
            truearm_default_settings(0, null_mut()),
            truearm_set_settings(none, &settings, q),
            truearm_set_settings(arm, null(), q),
            truearm_set_settings(arm, &settings, null()),
            truearm_set_tool(none, tool),
            truearm_set_tool(arm, null()),
            truearm_set_active(none, 1),
            truearm_default_state(none, &mut state),
            truearm_default_state(arm, null_mut()),
            truearm_arm_temperature(none, 0.0, 20.0, sigma),
            truearm_arm_temperature(arm, 0.0, 20.0, null_mut()),
            truearm_tick(none, q, &NEUTRAL, tick),
            truearm_tick(arm, null(), &NEUTRAL, tick),
            truearm_tick(arm, q, &NEUTRAL, null_mut()),
            truearm_real_pose(none, q, &NEUTRAL, pose),
            truearm_real_pose(arm, null(), &NEUTRAL, pose),
            truearm_real_pose(arm, q, &NEUTRAL, null_mut()),
            truearm_nominal_pose(none, q, pose),
            truearm_nominal_pose(arm, null(), pose),
            truearm_nominal_pose(arm, q, null_mut()),
            truearm_point_sigma(none, q, &NEUTRAL, sigma),
            truearm_point_sigma(arm, null(), &NEUTRAL, sigma),
            truearm_point_sigma(arm, q, &NEUTRAL, null_mut()),
        ]
    };
    for (index, error) in errors.into_iter().enumerate() {
        assert_eq!(error, TruearmError::Null, "call {index}");
    }
    // SAFETY: as the function wants it.
    assert_eq!(unsafe { truearm_default_settings(1, &mut settings) }, TruearmError::Ok);
}

#[test]
fn a_misaligned_pointer_is_refused_everywhere() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    let (q, crooked) = (Q.as_ptr(), beyond(Q.as_ptr()));
    let (mut settings, mut state) = (usual(), NEUTRAL);
    let (mut tick, mut pose) = (MaybeUninit::uninit(), MaybeUninit::uninit());
    let (tick, pose, mut sigma) = (tick.as_mut_ptr(), pose.as_mut_ptr(), [0.0; 3]);
    let mut other = self::memory();
    let other: *mut c_void = (&raw mut *other).cast();
    let mut place = null_mut();
    let none = beyond_mut(arm);
    let (wrong_state, wrong) = (beyond(&NEUTRAL), beyond(&raw const settings));
    // SAFETY: every pointer is as typed or not aligned, which is seen before it is used.
    let errors = unsafe {
        [
            truearm_init(TRUEARM_VERSION, beyond_mut(other), TRUEARM_MEMORY_SIZE, &mut place),
            truearm_init(TRUEARM_VERSION, other, TRUEARM_MEMORY_SIZE, beyond_mut(&mut place)),
            truearm_load(none, BLOB.as_ptr(), BLOB.len(), robot(), &settings, q),
            truearm_load(arm, BLOB.as_ptr(), BLOB.len(), robot(), wrong, q),
            truearm_load(arm, BLOB.as_ptr(), BLOB.len(), robot(), &settings, crooked),
            truearm_default_settings(0, beyond_mut(&mut settings)),
            truearm_set_settings(none, &settings, q),
            truearm_set_settings(arm, wrong, q),
            truearm_set_settings(arm, &settings, crooked),
            truearm_set_tool(none, q),
            truearm_set_tool(arm, crooked),
            truearm_set_active(none, 1),
            truearm_default_state(none, &mut state),
            truearm_default_state(arm, beyond_mut(&mut state)),
            truearm_tick(none, q, &NEUTRAL, tick),
            truearm_tick(arm, crooked, &NEUTRAL, tick),
            truearm_tick(arm, q, wrong_state, tick),
            truearm_tick(arm, q, &NEUTRAL, beyond_mut(tick)),
            truearm_real_pose(none, q, &NEUTRAL, pose),
            truearm_real_pose(arm, crooked, &NEUTRAL, pose),
            truearm_real_pose(arm, q, wrong_state, pose),
            truearm_real_pose(arm, q, &NEUTRAL, beyond_mut(pose)),
            truearm_nominal_pose(none, q, pose),
            truearm_nominal_pose(arm, crooked, pose),
            truearm_nominal_pose(arm, q, beyond_mut(pose)),
            truearm_point_sigma(none, q, &NEUTRAL, sigma.as_mut_ptr()),
            truearm_point_sigma(arm, crooked, &NEUTRAL, sigma.as_mut_ptr()),
            truearm_point_sigma(arm, q, wrong_state, sigma.as_mut_ptr()),
            truearm_point_sigma(arm, q, &NEUTRAL, beyond_mut(sigma.as_mut_ptr())),
        ]
    };
    for (index, error) in errors.into_iter().enumerate() {
        assert_eq!(error, TruearmError::Alignment, "call {index}");
    }
}

#[test]
fn memory_that_is_short_or_unprepared_is_refused() {
    let mut short = vec![0_u64; TRUEARM_MEMORY_SIZE / 8 - 1];
    let (place, size) = (short.as_mut_ptr().cast(), 8 * short.len());
    let mut arm = null_mut();
    let mut unprepared = memory();
    let unprepared = (&raw mut *unprepared).cast();
    // SAFETY: as the functions want it.
    let errors = unsafe {
        [
            truearm_init(TRUEARM_VERSION, place, size, &mut arm),
            truearm_init(TRUEARM_VERSION - 1, place, size, &mut arm),
            truearm_set_active(unprepared, 1),
            truearm_set_tool(unprepared, [0.0; 12].as_ptr()),
        ]
    };
    assert!(arm.is_null());
    use TruearmError::{MemorySize, NotInitialised, Version};
    assert_eq!(errors, [MemorySize, Version, NotInitialised, NotInitialised]);
}

#[test]
fn without_parameters_there_is_no_arm() {
    let mut memory = memory();
    let arm = initialised(&mut memory);
    let (mut tick, mut pose) = (MaybeUninit::uninit(), MaybeUninit::uninit());
    let (tick, pose, mut sigma) = (tick.as_mut_ptr(), pose.as_mut_ptr(), [0.0; 3]);
    let q = Q.as_ptr();
    let tool = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32];
    // SAFETY: as the functions want it.
    let errors = unsafe {
        [
            truearm_set_settings(arm, &usual(), q),
            truearm_set_tool(arm, tool.as_ptr()),
            truearm_set_active(arm, 1),
            truearm_tick(arm, q, &NEUTRAL, tick),
            truearm_real_pose(arm, q, null(), pose),
            truearm_nominal_pose(arm, q, pose),
            truearm_point_sigma(arm, q, null(), sigma.as_mut_ptr()),
        ]
    };
    assert_eq!(errors, [TruearmError::NotLoaded; 7]);
}
