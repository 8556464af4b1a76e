//! The compensator against the arm it compensates: where the tool is, what is
//! held back, what happens to bad input.

mod common;

use common::{puma, scara, ur10};
use nalgebra::Vector3;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::compensate::{Refusal, SettingError, Status};
use truearm::effects::{Effect, Masses, Term};
use truearm::{
    Approach, Arm, ArmParameters, Compensator, JointKind, Link, MdhParameters, Pose, Scalar,
    Settings, State, Tables, Task, Tick,
};

/// An arm that misses by millimetres: geometry, compliance, a gear error, play
/// and temperature.
fn parameters<T: Scalar, const N: usize>(links: &[Link<f64>; N]) -> ArmParameters<'static, T, N> {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut number = |most: f64| T::from_f64(rng.random_range(-most..most));
    let nominal = links.map(|link| Link {
        kind: link.kind,
        parameters: MdhParameters::from_array(link.parameters.to_array().map(T::from_f64)),
    });
    let corrections = [(); N].map(|()| MdhParameters::from_array([(); 5].map(|()| number(5e-4))));
    let mut vector = |most: f64| Vector3::new(number(most), number(most), number(most));
    let masses = Masses {
        gravity: Vector3::new(T::ZERO, T::ZERO, T::from_f64(-9.81)),
        mass: [T::from_f64(6.0); N],
        com: [(); N].map(|()| vector(0.2)),
        payload_com: vector(0.1),
    };
    let term = |effect, joint, order: f64, coefficient: f64| Term {
        effect,
        joint,
        source: 0,
        component: 0,
        order: T::from_f64(order),
        coefficient: T::from_f64(coefficient),
    };
    let terms = [
        term(Effect::JointCompliance, 1, 0.0, 2e-5),
        term(Effect::JointPeriodicError, 2, 20.0, 2e-4),
        term(Effect::Backlash, 0, 0.0, 1e-4),
        term(Effect::BaseCompliance, 0, 0.0, 1e-6),
        term(Effect::ThermalExpansion, Term::<f64>::ALL, 0.0, 2e-5),
    ];
    ArmParameters {
        robot_id: 1,
        sequence: 1,
        created: 0,
        nominal,
        corrections,
        base_translation: vector(1e-3),
        base_rotation: vector(1e-3),
        tool: vector(0.2),
        terms: heapless::Vec::from_slice(&terms).unwrap(),
        tables: Tables::NONE,
        masses: Some(masses),
        reference_temperature: T::from_f64(20.0),
        limits: [None; N],
        covered: [Some([-T::ONE, T::ONE]); N],
        rms_before: T::ZERO,
        rms_after: T::ZERO,
        orientation_identified: true,
    }
}

fn state<T: Scalar, const N: usize>() -> State<T, N> {
    State {
        approach: [Approach::Positive; N],
        payload: T::from_f64(3.0),
        temperature: T::from_f64(27.0),
    }
}

/// Without ramp or bounds on the change, so that a tick goes all the way.
fn at_once<T: Scalar, const N: usize>(task: Task) -> Settings<T, N> {
    Settings {
        ramp_ticks: 1,
        steps: 3,
        tolerance: T::ZERO,
        max_change: [T::from_f64(0.1); N],
        ..Settings::new(task)
    }
}

fn compensator<T: Scalar, const N: usize>(
    p: &ArmParameters<'static, T, N>,
    settings: Settings<T, N>,
) -> Compensator<'static, T, N> {
    let mut out = Compensator::new(Arm::new(p), settings, &[T::ZERO; N]).unwrap();
    out.set_active(true);
    out
}

/// Position and orientation error of the real tool, m and rad.
fn errors<T: Scalar, const N: usize>(
    arm: &Arm<T, N>,
    command: &[T; N],
    joints: &[T; N],
    state: &State<T, N>,
) -> [f64; 2] {
    let (nominal, real) = (arm.nominal().forward(command), arm.real_pose_in(joints, state));
    let to_f64 =
        |pose: &Pose<T>| (pose.translation.map(Scalar::to_f64), pose.rotation.map(Scalar::to_f64));
    let ((p, r), (q, s)) = (to_f64(&nominal), to_f64(&real));
    [(p - q).norm(), (r - s).norm() / 2.0_f64.sqrt()]
}

fn random<const N: usize>(rng: &mut ChaCha8Rng, links: &[Link<f64>; N]) -> [f64; N] {
    links.map(|link| match link.kind {
        JointKind::Revolute => rng.random_range(-3.0..3.0),
        JointKind::Prismatic => rng.random_range(-0.2..0.3),
    })
}

/// Worst errors over random targets where nothing is damped: without and with
/// compensation, and how many there were.
fn accuracy<T: Scalar, const N: usize>(
    links: &[Link<f64>; N],
    task: Task,
) -> ([f64; 2], [f64; 2], usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let p = parameters::<T, N>(links);
    let mut compensator = compensator(&p, at_once(task));
    let state = state();
    let (mut before, mut after, mut count) = ([0.0_f64; 2], [0.0_f64; 2], 0);
    for _ in 0..1000 {
        let command = random(&mut rng, links).map(T::from_f64);
        // From one random target to the next a correction changes by more than
        // a tick allows; the last of these is a steady one.
        let tick = (0..4).map(|_| compensator.tick(&command, &state)).last().unwrap();
        assert_eq!(tick.status, Status::On);
        if tick.damping > T::ZERO || !tick.clamped.is_empty() {
            continue;
        }
        assert_eq!(tick.position_error, [T::ZERO; 3]);
        count += 1;
        let arm = compensator.arm();
        for (worst, error) in [
            (&mut before, errors(arm, &command, &command, &state)),
            (&mut after, errors(arm, &command, &tick.joints, &state)),
        ] {
            for (worst, error) in worst.iter_mut().zip(error) {
                *worst = worst.max(error);
            }
        }
    }
    (before, after, count)
}

#[test]
fn the_real_tool_is_where_the_nominal_model_says() {
    for (name, (before, after, count)) in [
        ("UR10, pose", accuracy::<f64, 6>(&ur10(), Task::Pose)),
        ("spherical wrist, pose", accuracy::<f64, 6>(&puma(), Task::Pose)),
    ] {
        println!("{name}: {before:?} -> {after:?} m, rad over {count} targets");
        assert!(count > 300 && before[0] > 2e-3, "{name}");
        assert!(after[0] < 1e-9 && after[1] < 1e-9, "{name}: {after:?}");
    }
    for (name, (before, after, count)) in [
        ("UR10, position", accuracy::<f64, 6>(&ur10(), Task::Position)),
        ("SCARA, position", accuracy::<f64, 4>(&scara(), Task::Position)),
    ] {
        println!("{name}: {:.1e} -> {:.1e} m over {count} targets", before[0], after[0]);
        assert!(count > 300 && after[0] < 1e-9, "{name}: {after:?}");
    }
    let (_, after, count) = accuracy::<f32, 6>(&ur10(), Task::Pose);
    println!("UR10, pose, f32: {after:?} m, rad over {count} targets");
    assert!(count > 300 && after[0] < 5e-6 && after[1] < 5e-6, "{after:?}");
}

/// A seven-joint arm has many corrections; the smallest does not depend on the
/// way to the command.
#[test]
fn a_redundant_arm_forgets_its_way() {
    let mut links = [Link::revolute(0.0, 0.0, 0.0, 0.3, 0.0); 7];
    for (i, link) in links.iter_mut().enumerate() {
        link.parameters.alpha = if i % 2 == 1 { 1.57 } else { -1.57 };
    }
    let p = parameters::<f64, 7>(&links);
    let goal = [0.3, 0.9, -0.5, 1.2, 0.4, -0.9, 0.2];
    let state = state();
    let joints: Vec<_> = [[0.0; 7], [1.5; 7]]
        .map(|start| {
            let mut compensator = compensator(&p, at_once(Task::Pose));
            let _ = compensator.tick(&start, &state);
            (0..5).map(|_| compensator.tick(&goal, &state)).last().unwrap().joints
        })
        .to_vec();
    for (a, b) in joints[0].iter().zip(&joints[1]) {
        assert!((a - b).abs() < 1e-10, "{joints:?}");
    }
}

/// Puma at a stretched elbow and wrist: the bounds hold, and what is left is
/// what the tick says.
#[test]
fn near_singular_poses_no_joint_exceeds_its_bound_and_the_rest_is_reported() {
    let p = parameters::<f64, 6>(&puma());
    let settings = Settings { ramp_ticks: 1, ..Settings::new(Task::Pose) };
    let mut compensator = compensator(&p, settings);
    let state = state();
    let (mut damped, mut largest) = (0, 0.0_f64);
    for i in 0..=2000 {
        // Through the wrist singularity q5 = 0, slowly.
        let q5 = -0.2 + 0.0002 * f64::from(i);
        let command = [0.3, -0.8, 0.5, 0.4, q5, 0.2];
        let tick = compensator.tick(&command, &state);
        for (joint, q) in tick.joints.iter().zip(command) {
            largest = largest.max((joint - q).abs());
            assert!((joint - q).abs() <= 0.03);
        }
        if tick.damping > 0.0 && i > 100 {
            damped += 1;
            let real = compensator.arm().real_pose_in(&tick.joints, &state).translation;
            let left = compensator.arm().nominal().forward(&command).translation - real;
            let said = Vector3::from(tick.position_error);
            // To first order in a correction of hundredths.
            assert!((left - said).norm() < 2e-5, "{i}: {left} {said}");
        }
    }
    println!("{damped} damped ticks, largest correction {largest:.4} rad");
    assert!(damped > 100);
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
    let p = parameters::<f64, 6>(&ur10());
    let mut compensator =
        Compensator::new(Arm::new(&p), Settings::new(Task::Pose), &[0.0; 6]).unwrap();
    let mut all = along(&mut compensator, 0..50);
    assert!(all.iter().all(|(a, tick)| tick.status == Status::Off && *a == [0.0; 6]));
    compensator.set_active(true);
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
    let p = parameters::<f64, 6>(&ur10());
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
    let p = parameters::<f64, 6>(&ur10());
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

#[test]
fn joint_limits_hold_for_the_correction_and_not_for_the_command() {
    let mut p = parameters::<f64, 6>(&ur10());
    let command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.0];
    let free = compensator(&p, at_once(Task::Pose)).tick(&command, &state()).joints;
    let joint = (0..6)
        .max_by(|a, b| (free[*a] - command[*a]).abs().total_cmp(&(free[*b] - command[*b]).abs()));
    let joint = joint.unwrap();
    let outwards = (free[joint] - command[joint]).signum();
    let limit = |at: f64| if outwards > 0.0 { [-9.0, at] } else { [at, 9.0] };
    // At the limit: the command stays.
    p.limits[joint] = Some(limit(command[joint]));
    let tick = compensator(&p, at_once(Task::Pose)).tick(&command, &state());
    assert_eq!(tick.joints[joint], command[joint]);
    assert!(tick.clamped.limit.contains(joint));
    assert_ne!(tick.position_error, [0.0; 3]);
    // Beyond it: the correction does not lead further out.
    p.limits[joint] = Some(limit(command[joint] - 0.1 * outwards));
    let tick = compensator(&p, at_once(Task::Pose)).tick(&command, &state());
    assert_eq!(tick.joints[joint], command[joint]);
    // Inwards it is free.
    p.limits[joint] = Some(if outwards > 0.0 {
        [command[joint] + 0.1, 9.0]
    } else {
        [-9.0, command[joint] - 0.1]
    });
    let tick = compensator(&p, at_once(Task::Pose)).tick(&command, &state());
    assert_eq!(tick.joints, free);
    assert!(tick.clamped.limit.is_empty());
}

#[test]
fn bad_settings_are_named() {
    let arm = Arm::new(&parameters::<f64, 6>(&ur10()));
    let good = Settings::<f64, 6>::new(Task::Pose);
    let refused = |settings| Compensator::new(arm.clone(), settings, &[0.0; 6]).unwrap_err();
    assert_eq!(refused(Settings { steps: 0, ..good }), SettingError::Steps(0));
    let nan = Settings { rotation_length: f64::NAN, ..good };
    assert_eq!(refused(nan), SettingError::NotPositive("rotation_length"));
    let mut bound = good;
    bound.max_change[3] = 0.0;
    let error = refused(bound);
    assert_eq!(error.to_string(), "max_change of joint 4 must be a positive number");
    let start = Compensator::new(arm.clone(), good, &[f64::INFINITY; 6]).unwrap_err();
    assert_eq!(start, SettingError::Start { joint: 0 });
}

#[test]
fn bad_input_is_an_error_value_and_the_arm_goes_back_without_a_step() {
    let p = parameters::<f64, 6>(&ur10());
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
             any_number(), any_number(), any::<bool>()), 1..30),
        pose in any::<bool>(),
    ) {
        let task = if pose { Task::Pose } else { Task::Position };
        let arm = Arm::new(&parameters::<f32, 6>(&ur10()));
        let mut compensator =
            Compensator::new(arm, Settings { ramp_ticks: 3, ..Settings::new(task) }, &[0.0; 6]).unwrap();
        for (command, motion, payload, temperature, active) in ticks {
            compensator.set_active(active);
            let state = State { approach: motion.map(Approach::of_motion), payload, temperature };
            let tick = compensator.tick(&command, &state);
            prop_assert!(tick.joints.iter().all(|q| q.is_finite()));
            prop_assert!(tick.position_error.iter().chain(&tick.rotation_error).all(|e| e.is_finite()));
            prop_assert!(tick.damping.is_finite());
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
