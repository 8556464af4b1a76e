//! What is in a tick that returned an error: joints that may be sent, and a status that says
//! that they are not compensated.

use super::*;

type Ticked = (TruearmError, TruearmTick);

/// Garbage of the tick before.
fn garbage() -> TruearmTick {
    TruearmTick {
        complete: 1,
        has_error: 1,
        ..TruearmTick::refused([f32::INFINITY; 6], TruearmStatus::On)
    }
}

fn tick(arm: *mut Truearm, command: *const f32, state: *const TruearmState) -> Ticked {
    let mut tick = garbage();
    // SAFETY: every pointer is as the function wants it or one that it refuses.
    let error = unsafe { truearm_tick(arm, command, state, &mut tick) };
    (error, tick)
}

/// Faded in wholly.
fn on(memory: &mut Memory) -> (*mut Truearm, [f32; 6]) {
    let arm = loaded(memory);
    // SAFETY: as the functions want it.
    unsafe {
        assert_eq!(truearm_set_settings(arm, &quick(), Q.as_ptr()), TruearmError::Ok);
        assert_eq!(truearm_set_active(arm, 1), TruearmError::Ok);
    }
    for _ in 0..QUICK {
        assert_eq!(tick(arm, Q.as_ptr(), &NEUTRAL).0, TruearmError::Ok);
    }
    let (_, last) = tick(arm, Q.as_ptr(), &NEUTRAL);
    assert_eq!((last.status, last.complete), (TruearmStatus::On, 1));
    assert_ne!(last.joints, Q);
    (arm, last.joints)
}

/// No step between two ticks of a standing command is larger than the settings allow.
fn assert_near(a: &[f32; 6], b: &[f32; 6]) {
    for ((a, b), change) in a.iter().zip(b).zip(&quick().max_change) {
        assert!((a - b).abs() <= change + 1e-6, "{a} {b}");
    }
}

fn bad_states() -> [(TruearmState, TruearmError); 3] {
    [
        (TruearmState { has_torque: 7, ..NEUTRAL }, TruearmError::BadState),
        (TruearmState { approach: [0, 0, 5, 0, 0, 0], ..NEUTRAL }, TruearmError::BadApproach),
        (
            TruearmState { approach: [-86; 6], has_torque: 0xaa, ..NEUTRAL },
            TruearmError::BadApproach,
        ),
    ]
}

#[test]
fn of_a_bad_state_the_joints_fade_back_to_the_command() {
    for (bad, expected) in bad_states() {
        let mut memory = memory();
        let (arm, mut last) = on(&mut memory);
        for _ in 0..QUICK {
            let (error, done) = tick(arm, Q.as_ptr(), &bad);
            assert_eq!((error, done.status), (expected, TruearmStatus::StateNotFinite));
            assert_eq!([done.complete, done.has_error, done.covered], [0; 3]);
            assert_near(&last, &done.joints);
            last = done.joints;
        }
        assert_eq!(last, Q);
        // It is still switched on, and fades in again.
        let (error, done) = tick(arm, Q.as_ptr(), &NEUTRAL);
        assert_eq!((error, done.status), (TruearmError::Ok, TruearmStatus::Ramping));
    }
}

/// Under a load and warm, where the correction is another than in the neutral state: as if it was
/// switched off for that tick.
#[test]
fn of_a_bad_state_what_fades_is_the_correction_that_was() {
    let state = TruearmState { payload_kg: 10.0, temperature_c: 35.0, ..NEUTRAL };
    let (mut memory, mut memory_of_twin) = (memory(), memory());
    let (arm, twin) = (on(&mut memory).0, on(&mut memory_of_twin).0);
    for _ in 0..4 * QUICK {
        let joints = [arm, twin].map(|arm| tick(arm, Q.as_ptr(), &state).1.joints);
        assert_eq!(joints[0], joints[1]);
    }
    // One that is no number has no correction.
    let nan = TruearmState { payload_kg: f32::NAN, ..state };
    for (bad, _) in bad_states().iter().cycle().take(12) {
        let refused = [arm, twin].map(|arm| tick(arm, Q.as_ptr(), &nan).1);
        assert_eq!(refused.map(|tick| tick.status), [TruearmStatus::StateNotFinite; 2]);
        // SAFETY: as the function wants it.
        let switched = |on| unsafe { truearm_set_active(twin, on) };
        assert_eq!(switched(0), TruearmError::Ok);
        let (_, off) = tick(twin, Q.as_ptr(), &state);
        assert_eq!(switched(1), TruearmError::Ok);
        assert_eq!(tick(arm, Q.as_ptr(), bad).1.joints, off.joints);
        let good = [arm, twin].map(|arm| tick(arm, Q.as_ptr(), &state).1.joints);
        assert_eq!(good[0], good[1]);
    }
}

/// A sensor that is gone is no worse than a caller that is wrong: one reading that is missed is no
/// step, and the correction fades as it does of a bad field.
#[test]
fn a_reading_that_is_no_number_fades_the_correction_as_a_bad_state_does() {
    let warm = TruearmState { payload_kg: 3.0, temperature_c: 31.0, ..NEUTRAL };
    let none = [
        TruearmState { temperature_c: f32::NAN, ..warm },
        TruearmState { payload_kg: f32::INFINITY, ..warm },
        TruearmState { has_torque: 1, torque: [f32::NAN; 6], ..warm },
    ];
    for missing in none {
        let (mut memory, mut memory_of_twin) = (memory(), memory());
        let (arm, twin) = (on(&mut memory).0, on(&mut memory_of_twin).0);
        for _ in 0..4 * QUICK {
            let joints = [arm, twin].map(|arm| tick(arm, Q.as_ptr(), &warm).1.joints);
            assert_eq!(joints[0], joints[1]);
        }
        for _ in 0..QUICK {
            let (error, done) = tick(arm, Q.as_ptr(), &missing);
            assert_eq!((error, done.status), (TruearmError::Ok, TruearmStatus::StateNotFinite));
            let (_, bad) = tick(twin, Q.as_ptr(), &bad_states()[1].0);
            assert_eq!(done.joints, bad.joints);
        }
        assert_eq!(tick(arm, Q.as_ptr(), &missing).1.joints, Q);
    }
}

/// A state at a pointer that is none is as bad.
#[test]
fn a_state_that_cannot_be_read_is_a_bad_one() {
    let mut memory = memory();
    let (arm, last) = on(&mut memory);
    let (error, done) = tick(arm, Q.as_ptr(), beyond(&NEUTRAL));
    assert_eq!((error, done.status), (TruearmError::Alignment, TruearmStatus::StateNotFinite));
    assert_near(&last, &done.joints);
}

#[test]
fn of_a_command_that_cannot_be_read_the_last_joints_are_held() {
    let mut memory = memory();
    let (arm, last) = on(&mut memory);
    let bad = bad_states()[0].0;
    for state in [&NEUTRAL, &bad] {
        for (command, expected) in
            [(null(), TruearmError::Null), (beyond(Q.as_ptr()), TruearmError::Alignment)]
        {
            let (error, done) = tick(arm, command, state);
            assert_eq!((error, done.status), (expected, TruearmStatus::CommandNotFinite));
            assert_eq!((done.joints, done.complete), (last, 0));
        }
    }
    let (error, done) = tick(arm, Q.as_ptr(), &NEUTRAL);
    assert_eq!((error, done.joints, done.complete), (TruearmError::Ok, last, 1));
}

/// Switched off, an error gives the command, too, and says what it is.
#[test]
fn an_error_while_it_is_off_gives_the_command() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    for (bad, expected) in bad_states() {
        let (error, done) = tick(arm, Q.as_ptr(), &bad);
        assert_eq!((error, done.status), (expected, TruearmStatus::StateNotFinite));
        assert_eq!(done.joints, Q);
    }
    // It is idle still.
    assert_eq!(load(arm, BLOB), TruearmError::Ok);
}

#[test]
fn without_an_arm_it_is_the_command() {
    let (mut memory, mut unprepared) = (memory(), memory());
    let unprepared: *mut Truearm = (&raw mut *unprepared).cast();
    let empty = initialised(&mut memory);
    let cases = [
        (null_mut(), TruearmError::Null),
        (beyond_mut(empty), TruearmError::Alignment),
        (unprepared, TruearmError::NotInitialised),
        (empty, TruearmError::NotLoaded),
    ];
    for (arm, expected) in cases {
        let (error, done) = tick(arm, Q.as_ptr(), null());
        assert_eq!((error, done.status), (expected, TruearmStatus::NoArm));
        assert_eq!((done.joints, done.complete, done.has_error), (Q, 0, 0));
        // Nothing better is known than what lies there.
        for command in [null(), [f32::NAN; 6].as_ptr()] {
            let (error, done) = tick(arm, command, null());
            assert_eq!((error, done.status), (expected, TruearmStatus::NoArm));
            assert_eq!(done.joints, garbage().joints);
        }
        // Also of memory that nobody has written to.
        let mut unset = MaybeUninit::<TruearmTick>::uninit();
        // SAFETY: as the function wants it.
        let error = unsafe { truearm_tick(arm, null(), null(), unset.as_mut_ptr()) };
        assert_eq!(error, expected);
    }
}

/// What is neither 0 nor 1 was not set, in settings as in a state.
#[test]
fn a_flag_that_was_not_set_is_refused() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    for flag in [2, 77, 0xaa, 0xff] {
        let settings = TruearmSettings { trust_nominal_orientation: flag, ..usual() };
        // SAFETY: as the function wants it.
        let error = unsafe { truearm_set_settings(arm, &settings, Q.as_ptr()) };
        assert_eq!(error, TruearmError::BadSetting);
    }
}

/// A C compiler is told to warn of every error that is not looked at; `c/ignored.c` is what it
/// warns of.
#[test]
fn every_function_of_the_header_says_that_its_error_counts() {
    let header = include_str!("../../include/truearm.h");
    let header = header.split_whitespace().collect::<Vec<_>>().join(" ");
    let ignored = include_str!("../../c/ignored.c");
    let mut prototypes = header.split(" TruearmError truearm_");
    let mut before = prototypes.next().unwrap();
    let mut count = 0;
    for prototype in prototypes {
        let (name, _) = prototype.split_once('(').unwrap();
        assert!(before.ends_with("TRUEARM_NODISCARD"), "{name}");
        assert!(ignored.contains(&format!("\n    truearm_{name}(")), "{name}");
        before = prototype;
        count += 1;
    }
    assert_eq!(count, ignored.matches("\n    truearm_").count());
}
