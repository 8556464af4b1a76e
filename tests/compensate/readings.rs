//! Readings that are missing: for a tick, or for good.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::compensate::{Refusal, Status};
use truearm::{Approach, Arm, ArmParameters, Compensator, Scalar, Settings, State, Task};

use super::arms::{Terms, UR10, UR10_TERMS, parameters, shipped, state};
use super::common::ur10;

const Q: [f32; 6] = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];

fn running(settings: Settings<f32, 6>) -> Compensator<'static, f32, 6> {
    let mut compensator = Compensator::new(Arm::new(&shipped(UR10_TERMS)), settings, &Q).unwrap();
    compensator.set_active(true);
    compensator
}

/// What may be missing of a state.
fn without(state: State<f32, 6>) -> [State<f32, 6>; 3] {
    let mut torque = [12.0; 6];
    torque[1] = f32::NAN;
    [
        State { temperature: f32::NAN, ..state },
        State { payload: f32::INFINITY, ..state },
        State { torque: Some(torque), ..state },
    ]
}

/// As found: one temperature that was no number made every joint jump by `max_change` to and fro,
/// 2,000 rad/s^2 at 1 kHz; for good the correction was gone in two ticks.
#[test]
fn one_that_is_missed_is_no_step_and_one_that_stays_away_fades_the_correction() {
    let loaded = State { payload: 3.0, temperature: 31.0, ..state() };
    for bad in without(loaded) {
        for many in [1, 3, 1000] {
            let mut compensator = running(Settings::new(Task::Position));
            for _ in 0..1200 {
                let _ = compensator.tick(&Q, &loaded);
            }
            let whole = *compensator.applied();
            let (mut last, mut speed) = (whole, [0.0_f32; 6]);
            let mut largest = [0.0_f32; 2];
            for number in 0..many + 600 {
                let missing = number < many;
                let tick = compensator.tick(&Q, if missing { &bad } else { &loaded });
                let refused = Status::Refused(Refusal::StateNotFinite);
                assert_eq!(tick.status == refused, missing, "{number}: {tick:?}");
                for ((now, last), speed) in compensator.applied().iter().zip(&last).zip(&mut speed)
                {
                    let step = now - last;
                    largest = [largest[0].max(step.abs()), largest[1].max((step - *speed).abs())];
                    *speed = step;
                }
                last = *compensator.applied();
                // Gone with the ramp, and not before.
                let gone = last.iter().all(|a| *a == 0.0);
                assert_eq!(missing && number >= 499, gone, "{number}");
            }
            assert_eq!(last, whole);
            // 1.7 mrad over half a second: 1.875 / 500 of it a tick, and a curve of that.
            assert!(largest[0] < 1e-5 && largest[1] < 3e-7, "{many}: {largest:?}");
        }
    }
}

/// What is there of a state counts, whatever else is missing.
#[test]
fn the_other_readings_go_on_counting() {
    let mut compensator = running(Settings { ramp_ticks: 100_000, ..Settings::new(Task::Pose) });
    let before = State { payload: 3.0, temperature: 31.0, ..state() };
    for _ in 0..100_100 {
        let _ = compensator.tick(&Q, &before);
    }
    let gripped = State { payload: 6.0, temperature: f32::NAN, ..before };
    for _ in 0..10 {
        let _ = compensator.tick(&Q, &gripped);
    }
    let expected = compensator.correction(&Q, &State { payload: 6.0, ..before }).unwrap();
    for (applied, expected) in compensator.applied().iter().zip(&expected) {
        assert!((applied - expected).abs() < 1e-7, "{applied} {expected}");
    }
    // Then the payload is missing, too: it is the last one.
    let nothing = State { payload: f32::NAN, ..gripped };
    let tick = compensator.tick(&Q, &nothing);
    assert_eq!(tick.status, Status::Refused(Refusal::StateNotFinite));
    for (applied, expected) in compensator.applied().iter().zip(&expected) {
        assert!((applied - expected).abs() < 1e-7, "{applied} {expected}");
    }
}

/// A bus that is lost: no state at all.
#[test]
fn a_tick_without_a_state_fades_that_of_the_last() {
    let loaded =
        State { payload: 3.0, temperature: 31.0, approach: [Approach::Positive; 6], ..state() };
    let settings = Settings { ramp_ticks: 50, ..Settings::new(Task::Pose) };
    let [mut without, mut off] = [(); 2].map(|()| running(settings));
    for _ in 0..200 {
        assert_eq!(without.tick(&Q, &loaded), off.tick(&Q, &loaded));
    }
    off.set_active(false);
    for number in 0..50 {
        let tick = without.tick_without_state(&Q);
        assert_eq!(tick.status, Status::Refused(Refusal::StateNotFinite), "{number}");
        assert_eq!(tick.joints, off.tick(&Q, &loaded).joints, "{number}");
    }
    assert_eq!(without.tick_without_state(&Q).joints, Q);
    assert!(without.is_active() && !without.is_idle());
    let mut bad = Q;
    bad[2] = f32::NAN;
    let tick = without.tick_without_state(&bad);
    assert_eq!(tick.status, Status::Refused(Refusal::CommandNotFinite { joint: 2 }));
    // A rigid arm needs none, and is told all the same.
    let mut rigid =
        Compensator::new(Arm::new(&shipped(UR10)), Settings { ramp_ticks: 0, ..settings }, &Q)
            .unwrap();
    assert_eq!(rigid.tick_without_state(&Q).status, Status::Off);
    rigid.set_active(true);
    let refused = Status::Refused(Refusal::StateNotFinite);
    assert_eq!(rigid.tick_without_state(&Q).status, refused);
}

/// A state with some of its numbers missing, and the same with them as they were last.
fn spoilt<T: Scalar, const N: usize>(
    rng: &mut ChaCha8Rng,
    good: State<T, N>,
    last: &State<T, N>,
) -> (State<T, N>, State<T, N>) {
    let none = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(T::from_f32);
    let (mut bad, mut known) = (good, good);
    if rng.random() {
        (bad.payload, known.payload) = (none[rng.random_range(0..3)], last.payload);
    }
    if rng.random() {
        (bad.temperature, known.temperature) = (none[rng.random_range(0..3)], last.temperature);
    }
    for i in 0..N {
        let all = [&mut bad.torque, &mut known.torque];
        if let ([Some(bad), Some(known)], Some(last), 0) =
            (all, last.torque, rng.random_range(0..4))
        {
            (bad[i], known[i]) = (none[rng.random_range(0..3)], last[i]);
        }
    }
    (bad, known)
}

/// Whatever is missing: as if it were what it was last, and compensation switched off for the tick.
fn as_if_switched_off<T: Scalar>(seed: u64, arm: &ArmParameters<'static, T, 6>) {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let start = [T::ZERO; 6];
    let settings = Settings {
        ramp_ticks: rng.random_range(0..30),
        trust_nominal_orientation: true,
        ..Settings::new(if rng.random() { Task::Pose } else { Task::Position })
    };
    let [mut one, mut twin] =
        [(); 2].map(|()| Compensator::new(Arm::new(arm), settings, &start).unwrap());
    let mut known = one.arm().state();
    if one.arm().reads_torques() {
        known.torque = Some([T::ONE; 6]);
    }
    let mut active = true;
    for number in 0..200 {
        if rng.random_range(0..20) == 0 {
            active = !active;
        }
        let q = [(); 6].map(|()| T::from_f64(rng.random_range(-3.0..3.0)));
        let read = [(); 6].map(|()| T::from_f64(rng.random_range(-50.0..50.0)));
        let mut good = State {
            payload: T::from_f64(rng.random_range(0.0..5.0)),
            temperature: T::from_f64(rng.random_range(10.0..40.0)),
            torque: one.arm().reads_torques().then_some(read),
            ..known
        };
        good.approach[number % 6] = Approach::of_motion(rng.random_range(-1.0..1.0_f32));
        let (bad, whole) = spoilt(rng, good, &known);
        // The first is good, so that there is something to go on with.
        let (bad, whole) = if number == 0 { (good, good) } else { (bad, whole) };
        one.set_active(active);
        let refused = one.correction(&q, &bad).is_err();
        twin.set_active(active && !refused);
        let (a, b) = (one.tick(&q, &bad), twin.tick(&q, &whole));
        assert_eq!(a.joints, b.joints, "seed {seed}, {number}: {a:?} {b:?}");
        assert!(one.applied() == twin.applied());
        let told = Status::Refused(Refusal::StateNotFinite);
        assert!(a.status == b.status || (refused && a.status == told), "{a:?} {b:?}");
        known = if number == 0 || !matches!(a.status, Status::Off) { whole } else { known };
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn whatever_is_missing_is_what_it_was_last(seed in any::<u64>()) {
        as_if_switched_off(seed, &parameters::<f32, 6>(&ur10(), 5e-4, Terms::All));
        as_if_switched_off(seed, &parameters::<f64, 6>(&ur10(), 5e-4, Terms::All));
        let all = parameters::<f32, 6>(&ur10(), 5e-4, Terms::All);
        let terms = all.terms.iter().filter(|term| !term.needs_masses()).copied().collect();
        as_if_switched_off(seed, &ArmParameters { terms, masses: None, ..all });
    }
}
