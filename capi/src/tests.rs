//! Every function with good and with bad pointers, for Miri: what C may get
//! wrong and a function can see is an error that touches nothing.

use core::mem::MaybeUninit;
use core::ptr::{null, null_mut};
use std::boxed::Box;
use std::sync::OnceLock;
use std::vec;
use std::vec::Vec;

use truearm::blob::{Blob, encode_with, encoded_len, factor_len};
use truearm::effects::{Effect, Term};
use truearm::{ArmParameters6, State};

use super::*;

const BLOB: &[u8] = include_bytes!("../../tests/data/firmware/ur10-terms.blob");
const Q: [f32; 6] = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
const NEUTRAL: TruearmState = TruearmState {
    approach: [0; 6],
    payload_kg: 0.0,
    temperature_c: 20.0,
    has_torque: 0,
    torque: [0.0; 6],
};

#[repr(C, align(8))]
struct Memory([u8; TRUEARM_MEMORY_SIZE]);

/// An arm in memory of its own, which the test keeps.
fn initialised(memory: &mut Memory) -> *mut Truearm {
    let mut arm = null_mut();
    let place = (&raw mut *memory).cast();
    // SAFETY: as the function wants it.
    let error = unsafe { truearm_init(TRUEARM_VERSION, place, TRUEARM_MEMORY_SIZE, &mut arm) };
    assert_eq!(error, TruearmError::Ok);
    arm
}

fn memory() -> Box<Memory> {
    Box::new(Memory([0; TRUEARM_MEMORY_SIZE]))
}

fn usual() -> TruearmSettings {
    types::usual(TruearmTask::Position as u8).unwrap()
}

fn robot() -> u64 {
    Blob::check(BLOB).unwrap().robot_id()
}

fn load(arm: *mut Truearm, blob: &'static [u8]) -> TruearmError {
    // SAFETY: as the function wants it.
    unsafe { truearm_load(arm, blob.as_ptr(), blob.len(), robot(), &usual(), Q.as_ptr()) }
}

fn loaded(memory: &mut Memory) -> *mut Truearm {
    let arm = initialised(memory);
    assert_eq!(load(arm, BLOB), TruearmError::Ok);
    arm
}

/// The blob with a covariance: a factor of 0.1 mm, 0.1 mrad on its diagonal.
fn with_covariance() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let parameters: ArmParameters6<f32> = Blob::check(BLOB).unwrap().parameters().unwrap();
        let terms = parameters.terms.len();
        let size = 9 + 5 * 6 + terms;
        let column = |rows| (0..rows).map(|row| if row == 0 { 1e-4 } else { 0.0 });
        let factor: Vec<f32> = (1..=size).rev().flat_map(column).collect();
        assert_eq!(factor.len(), factor_len(6, terms));
        let mut bytes = vec![0; encoded_len(6, terms) + 4 * factor.len()];
        encode_with(&parameters, Some(&factor), &mut bytes).unwrap();
        bytes
    })
}

/// One byte beyond something, which no type but bytes can begin at.
fn beyond<T>(pointer: *const T) -> *const T {
    pointer.cast::<u8>().wrapping_add(1).cast()
}

fn beyond_mut<T>(pointer: *mut T) -> *mut T {
    beyond(pointer).cast_mut()
}

#[test]
fn an_arm_works_as_in_rust() {
    let mut memory = memory();
    let arm = initialised(&mut memory);
    assert_eq!(load(arm, with_covariance()), TruearmError::Ok);
    let mut real = MaybeUninit::uninit();
    let mut nominal = MaybeUninit::uninit();
    let mut tick = MaybeUninit::uninit();
    let mut sigma = [f32::NAN; 3];
    // SAFETY: as the functions want it; what they return Ok for they have written.
    let (real, nominal, tick) = unsafe {
        assert_eq!(truearm_real_pose(arm, Q.as_ptr(), null(), real.as_mut_ptr()), TruearmError::Ok);
        assert_eq!(truearm_nominal_pose(arm, Q.as_ptr(), nominal.as_mut_ptr()), TruearmError::Ok);
        assert_eq!(
            truearm_point_sigma(arm, Q.as_ptr(), &NEUTRAL, sigma.as_mut_ptr()),
            TruearmError::Ok
        );
        assert_eq!(truearm_set_active(arm, 1), TruearmError::Ok);
        assert_eq!(truearm_tick(arm, Q.as_ptr(), &NEUTRAL, tick.as_mut_ptr()), TruearmError::Ok);
        (real.assume_init(), nominal.assume_init(), tick.assume_init())
    };
    let parameters: ArmParameters6<f32> = Blob::check(BLOB).unwrap().parameters().unwrap();
    let same = Arm6::new(&parameters);
    assert_eq!(real.matrix, TruearmPose::new(&same.real_pose(&Q), true).matrix);
    assert_eq!(nominal.matrix, TruearmPose::new(&same.nominal().forward(&Q), true).matrix);
    let blob = Blob::check(with_covariance()).unwrap();
    let state = State { temperature: NEUTRAL.temperature_c, ..same.state() };
    assert_eq!(Ok(sigma), blob.covariance().unwrap().point_sigma(&same, &Q, &state));
    assert!(sigma.iter().all(|s| *s > 0.0), "{sigma:?}");
    assert_eq!(tick.status, TruearmStatus::Ramping);
}

/// The blob with an arm that grows 25 minutes late in place of what it has beside geometry.
fn late() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let mut parameters: ArmParameters6<f32> = Blob::check(BLOB).unwrap().parameters().unwrap();
        parameters.terms.clear();
        let term = Term {
            effect: Effect::ThermalExpansion,
            joint: Term::<f32>::ALL,
            source: 0,
            component: 0,
            order: 1500.0,
            coefficient: 1.2e-5,
        };
        parameters.terms.push(term).unwrap();
        let mut bytes = vec![0; encoded_len(6, 1) + parameters.curves.as_bytes().len()];
        encode_with(&parameters, None, &mut bytes).unwrap();
        bytes
    })
}

#[test]
fn readings_become_the_temperature_of_the_arm() {
    let mut memory = memory();
    let arm = initialised(&mut memory);
    let read = |dt, reading| {
        let mut out = f32::NAN;
        // SAFETY: as the function wants it.
        let error = unsafe { truearm_arm_temperature(arm, dt, reading, &mut out) };
        (error, out)
    };
    assert_eq!(read(0.0, 20.0).0, TruearmError::NotLoaded);
    assert_eq!(load(arm, BLOB), TruearmError::Ok);
    assert_eq!(read(0.0, 20.0), (TruearmError::Ok, 20.0));
    assert_eq!(read(1.0, 30.0), (TruearmError::Ok, 30.0));
    assert_eq!(load(arm, late()), TruearmError::Ok);
    let mut same = ThermalLag::new(1500.0);
    for (dt, reading) in [(0.0, 20.0), (300.0, 30.0), (300.0, 31.0)] {
        assert_eq!(read(dt, reading), (TruearmError::Ok, same.step(dt, reading)));
    }
    // Parameters that say the same of it leave it as warm as it was.
    assert_eq!(load(arm, late()), TruearmError::Ok);
    assert_eq!(read(300.0, 31.0), (TruearmError::Ok, same.step(300.0, 31.0)));
}

#[test]
fn null_is_refused_everywhere() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    let (q, blob, size) = (Q.as_ptr(), BLOB.as_ptr(), BLOB.len());
    let mut settings = usual();
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
            truearm_arm_temperature(none, 0.0, 20.0, sigma),
            truearm_arm_temperature(arm, 0.0, 20.0, null_mut()),
            truearm_tick(none, q, &NEUTRAL, tick),
            truearm_tick(arm, null(), &NEUTRAL, tick),
            truearm_tick(arm, q, null(), tick),
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
    let mut settings = usual();
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

/// Each in memory of exactly its length, so that a byte beyond would be seen.
#[test]
fn a_blob_that_is_cut_is_refused() {
    let mut memory = memory();
    let arm = initialised(&mut memory);
    let (robot, settings) = (robot(), usual());
    for size in 0..BLOB.len() {
        let cut: Box<[u8]> = BLOB.iter().copied().take(size).collect();
        // SAFETY: as the function wants it; nothing of a refused blob is kept.
        let error = unsafe { truearm_load(arm, cut.as_ptr(), size, robot, &settings, Q.as_ptr()) };
        assert_eq!(error, TruearmError::BadBlob, "{size} bytes");
    }
}

#[test]
fn numbers_that_name_nothing_are_refused() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    let mut settings = usual();
    let (mut tick, mut pose) = (MaybeUninit::uninit(), MaybeUninit::uninit());
    for wrong in [2, 17, u8::MAX] {
        // SAFETY: as the functions want it.
        unsafe {
            let error = truearm_default_settings(wrong, &mut settings);
            assert_eq!(error, TruearmError::BadSetting);
            let settings = TruearmSettings { task: wrong, ..usual() };
            let error = truearm_set_settings(arm, &settings, Q.as_ptr());
            assert_eq!(error, TruearmError::BadSetting);
        }
    }
    for wrong in [i8::MIN, -2, 2, i8::MAX] {
        let state = TruearmState { approach: [0, 0, wrong, 0, 0, 0], ..NEUTRAL };
        // SAFETY: as the functions want it.
        let errors = unsafe {
            [
                truearm_tick(arm, Q.as_ptr(), &state, tick.as_mut_ptr()),
                truearm_real_pose(arm, Q.as_ptr(), &state, pose.as_mut_ptr()),
                truearm_point_sigma(arm, Q.as_ptr(), &state, [0.0; 3].as_mut_ptr()),
            ]
        };
        assert_eq!(errors, [TruearmError::BadApproach; 3]);
    }
    // SAFETY: as the function wants it.
    let error = unsafe { truearm_set_tool(arm, [2.0; 12].as_ptr()) };
    assert_eq!(error, TruearmError::BadTool);
}

#[test]
fn an_arm_that_works_is_not_started_over() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    // SAFETY: as the functions want it.
    unsafe {
        assert_eq!(truearm_set_active(arm, 1), TruearmError::Ok);
        assert_eq!(load(arm, BLOB), TruearmError::Active);
        let error = truearm_set_settings(arm, &usual(), Q.as_ptr());
        assert_eq!(error, TruearmError::Active);
    }
}

/// A command that is no number, before compensation was ever on, is no reason to refuse a
/// load.
#[test]
fn an_arm_that_refuses_while_it_is_off_is_still_off() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    let status = |command: f32| {
        let mut done = MaybeUninit::uninit();
        // SAFETY: as the function wants it, which fills what it takes.
        unsafe {
            let error = truearm_tick(arm, [command; 6].as_ptr(), &NEUTRAL, done.as_mut_ptr());
            assert_eq!(error, TruearmError::Ok);
            done.assume_init().status
        }
    };
    assert_eq!(status(f32::NAN), TruearmStatus::CommandNotFinite);
    // SAFETY: as the functions want it.
    unsafe {
        assert_eq!(load(arm, BLOB), TruearmError::Ok);
        assert_eq!(truearm_set_active(arm, 1), TruearmError::Ok);
    }
    assert_eq!(status(f32::NAN), TruearmStatus::CommandNotFinite);
    assert_eq!(load(arm, BLOB), TruearmError::Active);
}

#[test]
fn a_blob_without_a_covariance_has_no_sigma() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    let mut sigma = [7.0; 3];
    // SAFETY: as the function wants it.
    let error = unsafe { truearm_point_sigma(arm, Q.as_ptr(), null(), sigma.as_mut_ptr()) };
    assert_eq!((error, sigma), (TruearmError::NoCovariance, [7.0; 3]));
}

/// Torques that are read count in the place of computed ones.
#[test]
fn torques_of_the_state_count() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    let pose = |state: &TruearmState| {
        let mut pose = MaybeUninit::<TruearmPose>::uninit();
        // SAFETY: as the function wants it.
        let error = unsafe { truearm_real_pose(arm, Q.as_ptr(), state, pose.as_mut_ptr()) };
        assert_eq!(error, TruearmError::Ok);
        // SAFETY: written where there was no error.
        unsafe { pose.assume_init() }.matrix
    };
    let heavy = TruearmState { torque: [100.0; 6], ..NEUTRAL };
    assert_eq!(pose(&heavy), pose(&NEUTRAL), "without has_torque it is not looked at");
    assert_ne!(pose(&TruearmState { has_torque: 1, ..heavy }), pose(&NEUTRAL));
    let mut unset = MaybeUninit::<TruearmPose>::uninit();
    let state = TruearmState { has_torque: 0xaa, ..heavy };
    // SAFETY: as the function wants it.
    let error = unsafe { truearm_real_pose(arm, Q.as_ptr(), &state, unset.as_mut_ptr()) };
    assert_eq!(error, TruearmError::BadState);
}
