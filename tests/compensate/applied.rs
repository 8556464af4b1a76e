//! What is applied of the law, tick by tick.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::compensate::{Refusal, SettingError, Status};
use truearm::{
    Approach, Arm, ArmParameters, Compensator, Curves, Pose, Scalar, Settings, State, Task, Tick,
};

use super::arms::{Terms, UR10, UR10_TERMS, anywhere, miss, parameters, rail, shipped, state};
use super::common::ur10;

fn arm() -> ArmParameters<'static, f64, 6> {
    parameters(&ur10(), 5e-4, Terms::All)
}

/// Without ramp or bounds on the change, so that a tick goes all the way.
fn at_once<T: Scalar, const N: usize>(task: Task) -> Settings<T, N> {
    Settings { ramp_ticks: 1, max_change: [T::from_f64(0.1); N], ..Settings::new(task) }
}

fn compensator<'t, T: Scalar, const N: usize>(
    p: &ArmParameters<'t, T, N>,
    settings: Settings<T, N>,
) -> Compensator<'t, T, N> {
    let mut out = Compensator::new(Arm::new(p), settings, &[T::ZERO; N]).unwrap();
    out.set_active(true);
    out
}

/// Applied corrections along a motion, with what the ticks say.
fn along(
    compensator: &mut Compensator<f64, 6>,
    ticks: std::ops::Range<i32>,
) -> Vec<([f64; 6], Tick<f64, 6>)> {
    ticks
        .map(|i| {
            // 1 rad/s at 1 kHz.
            let t = 0.001 * f64::from(i);
            let command = [t, -1.2 + 0.3 * t, 1.6 - 0.2 * t, -1.2, -1.57 + 0.1 * t, t];
            let tick = compensator.tick(&command, &state());
            let mut applied = tick.joints;
            for (a, q) in applied.iter_mut().zip(command) {
                *a -= q;
            }
            (applied, tick)
        })
        .collect()
}

#[test]
fn switching_on_while_moving_makes_no_step() {
    let p = arm();
    let mut compensator =
        Compensator::new(Arm::new(&p), Settings::new(Task::Pose), &[0.0; 6]).unwrap();
    let mut all = along(&mut compensator, 0..50);
    assert!(all.iter().all(|(a, tick)| tick.status == Status::Off && *a == [0.0; 6]));
    assert!(!compensator.is_active() && compensator.is_idle());
    compensator.set_active(true);
    // Switched on, however little is applied yet.
    assert!(compensator.is_active() && !compensator.is_idle());
    all.extend(along(&mut compensator, 50..700));
    assert!(all[400].1.status == Status::Ramping && all[699].1.status == Status::On);
    compensator.set_active(false);
    all.extend(along(&mut compensator, 700..1300));
    assert!(all[1299].1.status == Status::Off && all[1299].0 == [0.0; 6]);
    assert!(all.iter().all(|(_, tick)| tick.clamped.is_empty()));
    // The full correction of a joint, its natural change aside, is faded by
    // x^3 (10 - 15 x + 6 x^2): slope at most 1.875 / n, second difference at
    // most 5.78 / n^2.
    for j in 0..6 {
        let size = all.iter().map(|(a, _)| a[j].abs()).fold(0.0, f64::max);
        let (ramp, curve) = (1.875 / 500.0, 5.78 / 500.0_f64.powi(2));
        for window in all.windows(3) {
            let [a, b, c] = [0, 1, 2].map(|k| window[k].0[j]);
            // Of the gear error, 20 cycles a turn at 0.2 rad/s and 0.2 mrad.
            let (natural, natural_curve) = (2e-6, 1e-8);
            assert!((b - a).abs() < size * ramp * 1.2 + natural, "joint {j}");
            assert!((c - 2.0 * b + a).abs() < size * curve * 1.2 + natural_curve, "joint {j}");
        }
    }
}

#[test]
fn without_a_ramp_it_is_on_and_off_at_once() {
    let p = arm();
    let mut compensator = compensator(&p, Settings { ramp_ticks: 0, ..at_once(Task::Pose) });
    let command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.0];
    let on = compensator.tick(&command, &state());
    assert_eq!(on.status, Status::On);
    assert_ne!(on.joints, command);
    compensator.set_active(false);
    let off = compensator.tick(&command, &state());
    assert_eq!(off.joints, command);
    assert_eq!(compensator.tick(&command, &state()).status, Status::Off);
}

#[test]
fn a_jump_of_the_state_is_spread_over_ticks() {
    let p = arm();
    let mut settings = at_once(Task::Pose);
    settings.max_change = [1e-5; 6];
    let mut compensator = compensator(&p, settings);
    let command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.0];
    let mut state = state();
    for _ in 0..1000 {
        let _ = compensator.tick(&command, &state);
    }
    let settled = compensator.tick(&command, &state);
    state.payload += 20.0;
    let mut before = settled.joints;
    let mut held = 0;
    for _ in 0..1000 {
        let tick = compensator.tick(&command, &state);
        held += usize::from(tick.clamped.change.contains(1));
        for (a, b) in tick.joints.iter().zip(before) {
            assert!((a - b).abs() <= 1.000001e-5);
        }
        before = tick.joints;
    }
    assert!(held > 10, "joint 2 bends by more than a step: {held}");
    assert!(compensator.tick(&command, &state).clamped.is_empty());
}

/// A tool that is set between two ticks is the tool of another arm, to the last bit.
#[test]
fn a_tool_that_is_set_is_that_of_another_arm() {
    let p = arm();
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for task in [Task::Position, Task::Pose] {
        let [mut placed, mut replaced] = [(); 2].map(|()| compensator(&p, at_once(task)));
        for _ in 0..300 {
            let command = anywhere(&mut rng, placed.arm());
            assert_eq!(placed.tick(&command, &state()), replaced.tick(&command, &state()));
            let at = [(); 3].map(|()| rng.random_range(-0.3..0.3));
            let turn = [(); 3].map(|()| rng.random_range(-2.0..2.0));
            let tool = Pose::from_rotation_vector(at.into(), turn.into());
            placed.set_tool(&tool);
            replaced.set_arm(replaced.arm().with_tool(tool)).unwrap();
            assert_eq!(placed, replaced);
        }
    }
}

/// Ticks until the joints stand: `max_change` a tick, and not one more.
fn arrives<T: Scalar, const N: usize>(p: &ArmParameters<T, N>, task: Task) {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let settings = Settings { ramp_ticks: 5, ..Settings::new(task) };
    let mut compensator = compensator(p, settings);
    let mut applied = [T::ZERO; N];
    for _ in 0..5 {
        applied = compensator.tick(&[T::ZERO; N], &state()).joints;
    }
    for _ in 0..300 {
        // Somewhere else by any way: a few commands anywhere, now and then none at all.
        for _ in 0..rng.random_range(0..4) {
            let mut q = anywhere(&mut rng, compensator.arm());
            if rng.random_range(0..3) == 0 {
                q[rng.random_range(0..N)] = T::from_f32(f32::NAN);
            }
            let tick = compensator.tick(&q, &state());
            if let Status::On = tick.status {
                applied = core::array::from_fn(|i| tick.joints[i] - q[i]);
            }
        }
        let q = anywhere(&mut rng, compensator.arm());
        let c = compensator.correction(&q, &state()).unwrap();
        let wanted: [T; N] = core::array::from_fn(|i| q[i] + c[i]);
        let way = c.iter().zip(applied).map(|(c, a)| (*c - a).abs().to_f64()).fold(0.0, f64::max);
        // One more than the steps make, where their sum is rounded.
        let ticks = (way / 1e-3).ceil() as usize + 1;
        for _ in 0..ticks {
            let _ = compensator.tick(&q, &state());
        }
        for _ in 0..3 {
            let tick = compensator.tick(&q, &state());
            assert_eq!(tick.joints, wanted, "exactly");
            assert!(tick.clamped.change.is_empty());
        }
        applied = c;
    }
}

/// Of any `max_change` that is accepted, from the smallest on.
fn arrives_by_any_step<T: Scalar, const N: usize>(p: &ArmParameters<T, N>) {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let most = 0.03;
    let least = 16.001 * T::EPSILON.to_f64() * most;
    for _ in 0..40 {
        // Not so small that a run takes minutes.
        let step = f64::exp(rng.random_range(least.max(1e-7).ln()..0.1_f64.ln()));
        let change = [T::from_f64(step); N];
        let settings =
            Settings { ramp_ticks: 0, max_change: change, ..Settings::new(Task::Position) };
        let mut compensator = compensator(p, settings);
        let q = anywhere(&mut rng, compensator.arm());
        let c = compensator.correction(&q, &state()).unwrap();
        let way = c.iter().map(|c| c.abs().to_f64()).fold(0.0, f64::max);
        let lost = 0.5 * T::EPSILON.to_f64() * most / step;
        assert!(lost <= 1.0 / 32.0);
        let ticks = ((way / step) / (1.0 - lost)).ceil() as usize + 1;
        let mut before = [0.0; N];
        for _ in 0..ticks {
            let joints = compensator.tick(&q, &state()).joints;
            let applied: [f64; N] = core::array::from_fn(|i| (joints[i] - q[i]).to_f64());
            for (now, before) in applied.iter().zip(before) {
                // The joint itself is rounded, to what its own angle is.
                let rounded = 2.0 * T::EPSILON.to_f64() * 8.0;
                assert!((now - before).abs() <= step * (1.0 + lost) + rounded);
            }
            before = applied;
        }
        let wanted: [T; N] = core::array::from_fn(|i| q[i] + c[i]);
        assert_eq!(compensator.tick(&q, &state()).joints, wanted, "{step:e}");
    }
}

#[test]
fn steps_of_any_size_arrive_in_the_stated_number_of_ticks() {
    arrives_by_any_step(&shipped::<f32>(UR10));
    arrives_by_any_step(&parameters::<f32, 7>(&rail(), 5e-4, Terms::All));
    arrives_by_any_step(&shipped::<f64>(UR10_TERMS));
}

#[test]
fn a_standing_command_is_reached_exactly_in_the_stated_number_of_ticks() {
    for task in [Task::Position, Task::Pose] {
        arrives(&shipped::<f32>(UR10), task);
        arrives(&shipped::<f64>(UR10_TERMS), task);
        arrives(&parameters::<f32, 7>(&rail(), 5e-4, Terms::All), task);
    }
}

#[test]
fn what_is_reported_is_the_error_of_the_joints_returned() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let p = shipped::<f64>(UR10_TERMS);
    let mut counts = [0; 2];
    for task in [Task::Position, Task::Pose] {
        let settings = Settings { ramp_ticks: 50, ..at_once(task) };
        let mut compensator = compensator(&p, settings);
        for _ in 0..1000 {
            let q = anywhere(&mut rng, compensator.arm());
            let tick = compensator.tick(&q, &state());
            let is = miss(compensator.arm(), &q, &tick.joints, &state(), &settings);
            let Some(left) = tick.left else {
                assert!(tick.is_complete());
                counts[0] += 1;
                continue;
            };
            assert!(!tick.is_complete());
            let size = |v: [f64; 3]| nalgebra::Vector3::from(v).norm();
            let mut said = size(left.position);
            if task == Task::Pose {
                said = said.hypot(settings.rotation_length * size(left.rotation));
            }
            assert!((said - is).abs() < 2e-3 * is + 1e-12, "{said} {is}");
            let exact = compensator.error(&q, &tick.joints, &state());
            let pairs = left.position.iter().zip(exact.position);
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
            // To first order in the angle.
            let angle = nalgebra::Vector3::from(exact.rotation).norm();
            let pairs = left.rotation.iter().zip(exact.rotation);
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < angle * angle + 1e-12));
            counts[1] += 1;
        }
    }
    println!("complete, not: {counts:?}");
    assert!(counts.iter().all(|count| *count > 20));
}

/// The rotation that is named takes the real tool into the nominal one, however far off
/// it is: with the wrist turned by a right angle, and upside down.
fn error_is_the_whole_rotation<T: Scalar, const N: usize>(p: &ArmParameters<T, N>, exact: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let compensator = compensator(p, Settings::new(Task::Pose));
    let arm = compensator.arm();
    let mut largest = 0.0_f64;
    for turn in [0.0, 1e-4, 1.0, -1.57, 3.13, 3.2, 6.0].repeat(40) {
        let command = anywhere(&mut rng, arm);
        let mut joints = command;
        joints[N - 1] += T::from_f64(turn);
        let error = compensator.error(&command, &joints, &state());
        let rotation = nalgebra::Vector3::from(error.rotation);
        let none = nalgebra::Vector3::from([T::ZERO; 3]);
        let back = Pose::from_rotation_vector(none, rotation);
        let (real, nominal) =
            (arm.real_pose_in(&joints, &state()), arm.nominal().forward(&command));
        let off = back.compose(&real).rotation - nominal.rotation;
        assert!(off.iter().all(|e| e.to_f64().abs() < exact), "{turn}: {off}");
        let off = nominal.translation - real.translation - nalgebra::Vector3::from(error.position);
        assert!(off.iter().all(|e| e.to_f64().abs() < exact), "{turn}: {off}");
        let angle = rotation.map(T::to_f64).norm();
        assert!(angle < core::f64::consts::PI + exact);
        largest = largest.max(angle);
    }
    assert!(largest > 3.1, "{largest}");
}

#[test]
fn an_error_of_any_angle_is_the_whole_rotation() {
    error_is_the_whole_rotation(&shipped::<f64>(UR10_TERMS), 1e-9);
    error_is_the_whole_rotation(&shipped::<f32>(UR10), 3e-6);
    error_is_the_whole_rotation(&parameters::<f64, 7>(&rail(), 5e-4, Terms::All), 1e-9);
}

#[test]
fn a_tick_changes_no_correction_by_more_than_its_bound() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let mut compensator = compensator(&arm(), Settings::new(Task::Pose));
    let mut last = ([0.0; 6], [0.0; 6]);
    let mut counts = [0; 2];
    for tick in 0..20_000 {
        if tick % 500 == 0 {
            // Another tool, other limits: what was allowed may be outside now.
            let mut p = arm();
            for (limits, q) in p.limits.iter_mut().zip(last.0) {
                *limits = Some([q - 3.0, q + rng.random_range(0.0..0.01)]);
            }
            compensator.set_arm(Arm::new(&p)).unwrap();
            compensator.set_active(tick % 1000 == 0);
        }
        let q: [f64; 6] =
            core::array::from_fn(|i| last.0[i] + rng.random_range(-2e-3..0.5e-3 + 1.5e-3));
        let tick = compensator.tick(&q, &state());
        let joints = tick.joints.iter().zip(q).zip(last.1.iter().zip(last.0));
        for (i, ((joint, q), (before, was))) in joints.enumerate() {
            // A joint that a limit stops moves less than its command.
            let moved = joint - before;
            assert!(moved.abs() <= (q - was).abs() + 1.000_001e-3, "{moved} {}", q - was);
            let stopped = tick.clamped.limit.contains(i);
            counts[usize::from(stopped)] += 1;
            let changed = moved - (q - was);
            assert!(stopped || changed.abs() <= 1.000_001e-3, "{changed}");
        }
        last = (q, tick.joints);
    }
    assert!(counts.iter().all(|count| *count > 1000), "{counts:?}");
}

#[test]
fn narrower_limits_are_gone_into_without_a_step() {
    let mut p = arm();
    let command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.0];
    let mut compensator = compensator(&p, at_once(Task::Pose));
    compensator.set_arm(Arm::new(&p)).unwrap();
    let stands = compensator.tick(&command, &state()).joints;
    let joint = (0..6).max_by(|a, b| stands[*a].abs().total_cmp(&stands[*b].abs())).unwrap();
    let out = stands[joint] - command[joint];
    let middle = command[joint] + 0.1 * out;
    p.limits[joint] = Some(if out > 0.0 { [-9.0, middle] } else { [middle, 9.0] });
    let mut slow = Compensator::new(
        Arm::new(&arm()),
        Settings { max_change: [1e-4; 6], ramp_ticks: 0, ..Settings::new(Task::Pose) },
        &command,
    )
    .unwrap();
    slow.set_active(true);
    for _ in 0..1000 {
        let _ = slow.tick(&command, &state());
    }
    let mut before = slow.tick(&command, &state()).joints;
    slow.set_arm(Arm::new(&p)).unwrap();
    for _ in 0..1000 {
        let tick = slow.tick(&command, &state());
        for (a, b) in tick.joints.iter().zip(before) {
            assert!((a - b).abs() < 1.000_001e-4);
        }
        before = tick.joints;
    }
    let inside = if out > 0.0 { before[joint] <= middle } else { before[joint] >= middle };
    assert!(inside, "{} {middle}", before[joint]);
}

/// One bad command, and the next good one is as if nothing had been.
#[test]
fn a_command_that_is_not_a_number_spoils_no_other_tick() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for task in [Task::Position, Task::Pose] {
        let p = shipped::<f32>(UR10_TERMS);
        let [mut spoilt, mut whole] =
            [(); 2].map(|()| compensator(&p, Settings { ramp_ticks: 0, ..Settings::new(task) }));
        for _ in 0..200 {
            let q = anywhere(&mut rng, whole.arm());
            let good = whole.tick(&q, &state());
            assert_eq!(spoilt.tick(&q, &state()), good);
            let mut bad = q;
            bad[rng.random_range(0..6)] =
                [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][rng.random_range(0..3)];
            let tick = spoilt.tick(&bad, &state());
            assert!(matches!(tick.status, Status::Refused(Refusal::CommandNotFinite { .. })));
            assert_eq!(tick.joints, good.joints);
            assert_eq!(
                [tick.left.is_none(), tick.damping.is_none(), tick.covered.is_none()],
                [true; 3]
            );
        }
    }
}

#[test]
fn a_tick_that_is_off_claims_nothing() {
    let mut compensator =
        Compensator::new(Arm::new(&arm()), Settings::new(Task::Pose), &[0.0; 6]).unwrap();
    let tick = compensator.tick(&[0.1; 6], &state());
    assert_eq!(tick.status, Status::Off);
    assert!(tick.left.is_none() && tick.damping.is_none() && tick.covered.is_none());
    assert!(!tick.is_complete());
}

/// Below, the last steps to a correction would be no steps.
#[test]
fn a_step_that_rounding_takes_away_is_refused() {
    let p = shipped::<f32>(UR10);
    let good = Settings::<f32, 6>::new(Task::Position);
    let least = 16.0 * f32::EPSILON * good.max_correction[0];
    for (step, taken) in [(5e-10, false), (0.999 * least, false), (least, true), (1e-6, true)] {
        let settings = Settings { max_change: [step; 6], ..good };
        let made = Compensator::new(Arm::new(&p), settings, &[0.0; 6]);
        assert_eq!(made.is_ok(), taken, "{step:e}");
    }
}

#[test]
fn bad_settings_are_named() {
    let arm = Arm::new(&arm());
    let good = Settings::<f64, 6>::new(Task::Pose);
    let refused = |settings| Compensator::new(arm.clone(), settings, &[0.0; 6]).unwrap_err();
    for refinements in [0, 5] {
        let error = refused(Settings { refinements, ..good });
        assert_eq!(error, SettingError::Refinements(refinements));
    }
    for settings in
        [Settings { singular: 0.001, ..good }, Settings { rotation_length: 0.001, ..good }]
    {
        assert!(
            Compensator::new(arm.clone(), settings, &[0.0; 6]).is_ok(),
            "the bounds belong to it"
        );
    }
    for value in [f64::NAN, 0.0, -1.0, 1e-4, f64::INFINITY, f64::MAX, f64::from(f32::MAX)] {
        assert_eq!(refused(Settings { singular: value, ..good }), SettingError::Singular);
        let error = refused(Settings { rotation_length: value, ..good });
        assert_eq!(error, SettingError::RotationLength);
        if value == 1e-4 {
            continue;
        }
        let (mut change, mut correction) = (good, good);
        change.max_change[3] = value;
        correction.max_correction[5] = value;
        assert_eq!(refused(change), SettingError::MaxChange { joint: 3 });
        assert_eq!(refused(correction), SettingError::MaxCorrection { joint: 5 });
    }
    let error = refused(Settings { ramp_ticks: u32::MAX, ..good });
    assert_eq!(error, SettingError::RampTicks(u32::MAX));
    let start = Compensator::new(arm.clone(), good, &[f64::INFINITY; 6]).unwrap_err();
    assert_eq!(start, SettingError::Start { joint: 0 });
    assert_eq!(start.to_string(), "joint 1 starts at a value that is not finite");
}

#[test]
fn an_orientation_that_was_not_identified_must_be_answered_for() {
    let identified = arm();
    let p = ArmParameters { orientation_identified: false, ..arm() };
    let of = |settings| Compensator::new(Arm::new(&p), settings, &[0.0; 6]);
    let error = of(Settings::new(Task::Pose)).unwrap_err();
    assert_eq!(error, SettingError::OrientationNotIdentified);
    assert!(of(Settings::new(Task::Position)).is_ok());
    assert!(of(Settings::new(Task::Pose).trusting_nominal_orientation()).is_ok());
    let settings = Settings::new(Task::Pose);
    let mut compensator = Compensator::new(Arm::new(&identified), settings, &[0.0; 6]).unwrap();
    assert_eq!(compensator.set_arm(Arm::new(&p)), Err(SettingError::OrientationNotIdentified));
    assert!(compensator.arm().orientation_identified(), "the arm is the one before");
}

#[test]
fn bad_input_is_an_error_value_and_the_arm_goes_back_without_a_step() {
    let p = arm();
    let mut compensator = compensator(&p, at_once(Task::Pose));
    let command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.0];
    let good = compensator.tick(&command, &state());
    let mut bad = command;
    bad[4] = f64::NAN;
    let tick = compensator.tick(&bad, &state());
    assert_eq!(tick.status, Status::Refused(Refusal::CommandNotFinite { joint: 4 }));
    assert_eq!(tick.joints, good.joints, "holds the joints of the tick before");
    let hot = State { temperature: f64::NAN, ..state() };
    let tick = compensator.tick(&command, &hot);
    assert_eq!(tick.status, Status::Refused(Refusal::StateNotFinite));
    assert_eq!(tick.joints, command, "a step of the correction is allowed here");
    assert_eq!(compensator.tick(&command, &state()).status, Status::On);
}

/// What of a state is dead.
#[derive(Clone, Copy)]
enum Need {
    Warmth,
    Load,
    Torque,
}

/// A thermometer, a scale or a torque sensor that is dead stops the arms that need it and no other.
#[test]
fn what_no_term_depends_on_is_not_looked_at() {
    let all = parameters::<f32, 6>(&ur10(), 5e-4, Terms::All);
    let command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.0];
    let beyond_the_sine = [1e5, -1.2, 1.6, -1.2, -1.57, 0.0];
    let dead = |value| {
        let warm = State { temperature: value, ..state() };
        let heavy = State { payload: value, ..state() };
        let read = State { torque: Some([0.0, 0.0, value, 0.0, 0.0, 0.0]), ..state() };
        [(warm, Need::Warmth), (heavy, Need::Load), (read, Need::Torque)]
    };
    let mut counts = [0; 2];
    for term in all.terms.iter().map(Some).chain([None]) {
        let terms = term.copied().into_iter().collect();
        let p = ArmParameters { terms, curves: Curves::NONE, ..all.clone() };
        for (bad, need) in [f32::NAN, f32::INFINITY].into_iter().flat_map(dead) {
            let mut compensator = compensator(&p, at_once(Task::Pose));
            let good = compensator.tick(&command, &state());
            let tick = compensator.tick(&command, &bad);
            let needed = term.is_some_and(|term| match need {
                Need::Warmth => term.effect.needs_warmth(),
                Need::Load => term.needs_load(),
                Need::Torque => term.needs_torque(),
            });
            counts[usize::from(needed)] += 1;
            let pose = compensator.arm().real_pose_in(&command, &bad);
            if needed {
                assert_eq!(tick.status, Status::Refused(Refusal::StateNotFinite), "{term:?}");
                assert_eq!(compensator.correction(&command, &bad), Err(Refusal::StateNotFinite));
            } else {
                assert_eq!(tick, good, "{term:?}");
                assert_eq!(pose, compensator.arm().real_pose_in(&command, &state()));
                // Nor is it to blame for anything.
                assert_eq!(
                    compensator.correction(&beyond_the_sine, &bad),
                    Err(Refusal::OutOfRange)
                );
            }
        }
    }
    assert_eq!(counts, [36, 12]);
}

/// Any number, the extreme ones often.
fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -7.0_f32..7.0,
        1 => any::<f32>(),
        1 => proptest::sample::select(vec![
            f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 0.0, -0.0, 1e-45, 8191.9, 8192.0,
        ]),
    ]
}

proptest! {
    #[test]
    fn whatever_comes_in_what_goes_out_is_finite(
        ticks in proptest::collection::vec(
            (proptest::array::uniform6(any_number()), proptest::array::uniform6(any_number()),
             any_number(), any_number(), proptest::option::of(proptest::array::uniform6(any_number())),
             any::<bool>()), 1..30),
        pose in any::<bool>(),
    ) {
        let task = if pose { Task::Pose } else { Task::Position };
        let arm = Arm::new(&parameters::<f32, 6>(&ur10(), 5e-4, Terms::All));
        let mut compensator =
            Compensator::new(arm, Settings { ramp_ticks: 3, ..Settings::new(task) }, &[0.0; 6]).unwrap();
        for (command, motion, payload, temperature, torque, active) in ticks {
            compensator.set_active(active);
            let approach = motion.map(Approach::of_motion);
            let state = State { approach, payload, temperature, torque };
            let tick = compensator.tick(&command, &state);
            prop_assert!(tick.joints.iter().all(|q| q.is_finite()));
            if let Some(left) = tick.left {
                prop_assert!(left.position.iter().chain(&left.rotation).all(|e| e.is_finite()));
            }
            prop_assert!(tick.damping.is_none_or(f32::is_finite));
            if let Some(joint) = command.iter().position(|q| !q.is_finite()) {
                prop_assert_eq!(tick.status, Status::Refused(Refusal::CommandNotFinite { joint }));
            } else {
                for (q, joint) in command.iter().zip(&tick.joints) {
                    // The sum rounds to the larger of the two.
                    prop_assert!((joint - q).abs() <= 0.030_001 + q.abs() * f32::EPSILON);
                }
            }
        }
    }
}
