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

mod errors;
mod pointers;
mod start;

const BLOB: &[u8] = include_bytes!("../../../tests/data/firmware/ur10-terms.blob");
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
    convert::usual(TruearmTask::Position as u8).unwrap()
}

/// Faded in within few ticks, of which each is long under Miri.
fn quick() -> TruearmSettings {
    TruearmSettings { ramp_ticks: 8, max_change: [1e-3; 6], ..usual() }
}

/// Enough of them to be faded in or out wholly.
const QUICK: u32 = 24;

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
