//! Arms that a blob may hold, of any number of joints and of sizes that no robot has, under
//! any settings that are taken: what is promised of every tick.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::{Blob, encode};
use truearm::compensate::{Refusal, Status};
use truearm::effects::{ActsOn, Effect, MAX_TERMS, Masses, Order, Term};
use truearm::{
    Approach, Arm, ArmParameters, Compensator, Curves, Link, MdhParameters, Scalar, Settings,
    State, Task,
};

use super::blobs;

/// Of any size up to `most`, either sign, now and then 0 or all of it.
fn number(rng: &mut ChaCha8Rng, most: f64) -> f32 {
    let size = match rng.random_range(0..8) {
        0 => 0.0,
        1 => most,
        _ => most * f64::exp(rng.random_range(-14.0..0.0)),
    };
    (if rng.random() { size } else { -size }) as f32
}

fn vector(rng: &mut ChaCha8Rng, most: f64) -> Vector3<f32> {
    Vector3::from_fn(|_, _| number(rng, most))
}

fn term(rng: &mut ChaCha8Rng, joints: usize) -> Term<f32> {
    let effect = Effect::ALL[rng.random_range(0..Effect::ALL.len())];
    let joint = rng.random_range(0..joints);
    let lengths = effect.acts_on() == ActsOn::Lengths;
    Term {
        effect,
        joint: if lengths && rng.random() { Term::<f32>::ALL } else { joint as u8 },
        source: ((joint + 1) % joints) as u8,
        component: rng.random_range(0..effect.components().len().max(1)) as u8,
        order: match effect.order() {
            Order::None => 0.0,
            Order::Harmonic => rng.random_range(1..3) as f32,
            Order::Cycles => f32::from(rng.random_range(1..1000_u16)),
            Order::Friction => f32::from(rng.random_range(0..50_u8)),
            Order::TimeConstant => 1500.0,
        },
        coefficient: number(rng, f64::from(effect.usual()) * 10.0),
    }
}

/// Anything that can be written: what cannot is tried again.
fn any_arm<const N: usize>(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = vec![0; 4096];
    // Of joints 2 and 5, which then turn.
    let (tables, curved) = match N {
        5.. if rng.random() => (blobs::curve_bytes(), true),
        _ => (Vec::new(), false),
    };
    for _ in 0..100 {
        let link = |rng: &mut ChaCha8Rng, joint: usize| {
            let [alpha, theta, beta] = [6.3, 6.3, 0.1].map(|most| number(rng, most));
            let [a, d] = [10.0, 10.0].map(|most| number(rng, most));
            match rng.random_range(0..4) {
                0 if !curved || ![1, 4].contains(&joint) => {
                    Link::prismatic(alpha, a, theta, d, beta)
                }
                _ => Link::revolute(alpha, a, theta, d, beta),
            }
        };
        // As large as a blob lets them be, or as real ones are.
        let most = if rng.random() { 0.2 } else { 2e-3 };
        let limits = |rng: &mut ChaCha8Rng| {
            let ends = [number(rng, 7.0), number(rng, 7.0)];
            let [a, b] = ends;
            rng.random::<bool>().then_some([a.min(b), a.max(b)])
        };
        let mut terms = truearm::heapless::Vec::new();
        for _ in 0..rng.random_range(0..=MAX_TERMS) {
            terms.push(term(rng, N)).unwrap();
        }
        let parameters = ArmParameters::<f32, N> {
            robot_id: 1,
            sequence: 1,
            created: 0,
            nominal: core::array::from_fn(|joint| link(rng, joint)),
            corrections: [(); N]
                .map(|()| MdhParameters::from_array([(); 5].map(|()| number(rng, most)))),
            base_translation: vector(rng, 1.0),
            base_rotation: vector(rng, 1.0),
            tool: vector(rng, 10.0),
            terms,
            curves: Curves::of(&tables).unwrap(),
            masses: rng.random::<bool>().then(|| Masses {
                gravity: vector(rng, 20.0),
                mass: [(); N].map(|()| number(rng, 100.0).abs()),
                com: [(); N].map(|()| vector(rng, 1.0)),
                payload_com: vector(rng, 1.0),
            }),
            reference_temperature: number(rng, 50.0),
            limits: [(); N].map(|()| limits(rng)),
            covered: [(); N].map(|()| limits(rng)),
            rms_before: 0.0,
            rms_after: 0.0,
            orientation_identified: rng.random(),
        };
        if let Ok(size) = encode(&parameters, &mut bytes) {
            bytes.truncate(size);
            return bytes;
        }
    }
    panic!("hardly any can be written");
}

/// Any that are taken.
fn any_settings<T: Scalar, const N: usize>(rng: &mut ChaCha8Rng) -> Settings<T, N> {
    let log =
        |rng: &mut ChaCha8Rng, low: f64, high: f64| f64::exp(rng.random_range(low.ln()..high.ln()));
    let most = [(); N].map(|()| log(rng, 1e-6, 0.2));
    let least = 16.01 * T::EPSILON.to_f64();
    let change = most.map(|most| log(rng, most * least, 0.2));
    let mut out = Settings::new(if rng.random() { Task::Pose } else { Task::Position });
    out.trust_nominal_orientation = true;
    out.refinements = rng.random_range(1..=4);
    out.ramp_ticks = rng.random_range(0..8);
    out.rotation_length = T::from_f64(log(rng, 1.001e-3, 9.99));
    out.singular = T::from_f64(log(rng, 1.001e-3, 0.999));
    out.max_correction = most.map(T::from_f64);
    out.max_change = change.map(T::from_f64);
    out
}

fn any_state<T: Scalar, const N: usize>(rng: &mut ChaCha8Rng) -> State<T, N> {
    let approach = |rng: &mut ChaCha8Rng| match rng.random_range(0..3) {
        0 => Approach::Positive,
        1 => Approach::Negative,
        _ => Approach::Unknown,
    };
    let odd = |rng: &mut ChaCha8Rng, most: f64| match rng.random_range(0..40) {
        0 => T::from_f32(f32::NAN),
        1 => T::from_f32(f32::MAX),
        _ => T::from_f32(number(rng, most)),
    };
    State {
        approach: [(); N].map(|()| approach(rng)),
        payload: odd(rng, 20.0),
        temperature: odd(rng, 60.0),
        torque: (rng.random_range(0..4) > 0).then(|| [(); N].map(|()| odd(rng, 500.0))),
    }
}

/// What ended how: each must come about.
#[derive(Debug, Default)]
struct Counts {
    off: usize,
    ramping: usize,
    on: usize,
    refused: usize,
    damped: usize,
    bound: usize,
    changed: usize,
    limited: usize,
}

fn promises<T: Scalar, const N: usize>(seed: u64, counts: &mut Counts) {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let blobs = [any_arm::<N>(rng), any_arm::<N>(rng)];
    let arms = blobs.each_ref().map(|bytes| {
        let parameters: ArmParameters<T, N> = Blob::check(bytes).unwrap().parameters().unwrap();
        Arm::new(&parameters)
    });
    let settings = any_settings::<T, N>(rng);
    let start = [(); N].map(|()| T::from_f32(number(rng, 6.0)));
    let mut compensator = Compensator::new(arms[0].clone(), settings, &start).unwrap();
    let eps = T::EPSILON.to_f64();
    let mut q = start;
    let mut last = (start, start);
    let mut slack = [0.0_f64; N];
    // A joint that a limit stops is told from where it stood at the arm before.
    let mut same_arm = false;
    for tick_number in 0..40 {
        if rng.random_range(0..6) == 0 {
            compensator.set_active(rng.random());
        }
        let other = rng.random_range(0..15) == 0;
        if other {
            compensator.set_arm(arms[rng.random_range(0..2)].clone()).unwrap();
        }
        same_arm = same_arm && !other;
        match rng.random_range(0..4) {
            0 => q = [(); N].map(|()| T::from_f32(number(rng, 6.0))),
            1 => q[rng.random_range(0..N)] += T::from_f32(number(rng, 0.01)),
            2 => (),
            _ if rng.random_range(0..4) > 0 => (),
            _ => q[rng.random_range(0..N)] = T::from_f32(number(rng, 1e5)),
        }
        let mut command = q;
        if rng.random_range(0..20) == 0 {
            command[rng.random_range(0..N)] = T::from_f32(f32::INFINITY);
        }
        let state = any_state::<T, N>(rng);
        let at = format!("seed {seed}, {N} joints, tick {tick_number}");
        let (idle, before) = (compensator.is_idle(), *compensator.applied());
        let law = compensator.correction(&command, &state);
        let fresh = Compensator::new(compensator.arm().clone(), settings, &start).unwrap();
        let again = fresh.correction(&command, &state);
        assert_eq!(law, again, "{at}: of the command and the state alone");
        let tick = compensator.tick(&command, &state);
        assert!(tick.joints.iter().all(|q| q.is_finite()), "{at}: {tick:?}");
        assert!(tick.damping.is_none_or(T::is_finite), "{at}: {tick:?}");
        if let Some(left) = tick.left {
            assert!(left.position.iter().chain(&left.rotation).all(|e| e.is_finite()), "{at}");
        }
        if let Some(joint) = command.iter().position(|q| !q.is_finite()) {
            assert_eq!(tick.status, Status::Refused(Refusal::CommandNotFinite { joint }), "{at}");
            assert_eq!(before, *compensator.applied(), "{at}: it holds");
            continue;
        }
        match tick.status {
            Status::Off => counts.off += 1,
            Status::Ramping => counts.ramping += 1,
            Status::On => counts.on += 1,
            _ => counts.refused += 1,
        }
        assert_eq!(idle, tick.status == Status::Off, "{at}");
        if idle {
            assert_eq!(tick.joints, command, "{at}: switched off");
        } else if let (Err(why), Status::Refused(said)) = (law, tick.status) {
            assert_eq!(why, said, "{at}");
        } else {
            assert!(law.is_ok() && !matches!(tick.status, Status::Refused(_)), "{at}");
        }
        let applied = compensator.applied();
        counts.damped += usize::from(tick.damping.is_some_and(|mu| mu > T::ZERO));
        counts.bound += usize::from(!tick.clamped.bound.is_empty());
        counts.changed += usize::from(!tick.clamped.change.is_empty());
        counts.limited += usize::from(!tick.clamped.limit.is_empty());
        for i in 0..N {
            let [q, joint, now, was] =
                [command[i], tick.joints[i], applied[i], before[i]].map(T::to_f64);
            let most = settings.max_correction[i].to_f64();
            let change = settings.max_change[i].to_f64();
            let rounded = eps * (q.abs() + most);
            assert!((joint - q - now).abs() <= rounded, "{at}: joint {i}, {joint} {q} {now}");
            let stopped = tick.clamped.limit.contains(i);
            // What a limit stops is a difference of two joint values, from which it goes on.
            if stopped {
                slack[i] = slack[i].max(rounded);
            }
            if !stopped || same_arm {
                let most = most * (1.0 + 4.0 * eps) + slack[i];
                assert!(now.abs() <= most, "{at}: joint {i}, {now} of {most}");
            }
            let step = (now - was).abs();
            // A joint that a limit stops moves less than its command.
            let [from, stood] = [last.0[i], last.1[i]].map(T::to_f64);
            let far = (q - from).abs() + change * (1.0 + 1.0 / 32.0);
            let wide = 2.0 * eps * (q.abs() + from.abs() + most);
            assert!((joint - stood).abs() <= far + wide, "{at}: joint {i}, {stood} to {joint}");
            assert!(
                stopped || step <= change * (1.0 + 1.0 / 32.0) + eps * most,
                "{at}: joint {i}, {was} to {now}, {change} a tick"
            );
        }
        same_arm = true;
        last = (command, tick.joints);
    }
}

#[test]
fn what_every_tick_of_every_arm_keeps() {
    let mut counts = Counts::default();
    for seed in 0..150 {
        promises::<f32, 1>(seed, &mut counts);
        promises::<f64, 2>(seed, &mut counts);
        promises::<f32, 3>(seed, &mut counts);
        promises::<f32, 6>(seed, &mut counts);
        promises::<f64, 6>(seed, &mut counts);
        promises::<f32, 7>(seed, &mut counts);
        promises::<f32, 16>(seed, &mut counts);
        promises::<f64, 16>(seed, &mut counts);
    }
    let Counts { off, ramping, on, refused, damped, bound, changed, limited } = counts;
    let all = [off, ramping, on, refused, damped, bound, changed, limited];
    assert!(all.iter().all(|count| *count > 500), "each comes about: {counts:?}");
}
