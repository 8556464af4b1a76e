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
    out.ramp_ticks = if rng.random_range(0..4) > 0 { rng.random_range(0..8) } else { 200 };
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
    stood: usize,
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
    // Joints that an arm with narrower limits may have left beyond, and that are not yet in.
    let mut left_out = [false; N];
    for tick_number in 0..40 {
        if rng.random_range(0..6) == 0 {
            compensator.set_active(rng.random());
        }
        if rng.random_range(0..15) == 0 {
            compensator.set_arm(arms[rng.random_range(0..2)].clone()).unwrap();
            left_out = [true; N];
        }
        match rng.random_range(0..4) {
            0 => q = [(); N].map(|()| T::from_f32(number(rng, 6.0))),
            1 => q[rng.random_range(0..N)] += T::from_f32(number(rng, 0.01)),
            // Where a limit comes within reach of a correction.
            2 => {
                let i = rng.random_range(0..N);
                let near = settings.max_correction[i] * T::from_f32(rng.random_range(0..3) as f32);
                match compensator.arm().limits()[i] {
                    Some([low, _]) if rng.random() => q[i] = low + near,
                    Some([_, high]) => q[i] = high - near,
                    None => (),
                }
            }
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
            let bound = most * (1.0 + 4.0 * eps);
            assert!(now.abs() <= bound, "{at}: joint {i}, {now} of {bound}");
            if !idle && let Some([low, high]) = compensator.arm().limits()[i] {
                // Beyond a limit is only what was commanded there, or what an arm with narrower
                // limits found there by its correction, and that comes in tick by tick.
                let [command, stood, joint] = [command[i], last.1[i], tick.joints[i]];
                let (was, change) = (before[i], settings.max_change[i]);
                let comes = [stood > high && was > T::ZERO, stood < low && was < T::ZERO];
                let comes = comes.map(|comes| comes && left_out[i]);
                let above = joint > high && joint > command;
                let out = above && (!comes[0] || joint > stood - change);
                assert!(!out, "{at}: joint {i}, {joint:?} of {command:?} beyond {high:?}");
                let below = joint < low && joint < command;
                let out = below && (!comes[1] || joint < stood + change);
                assert!(!out, "{at}: joint {i}, {joint:?} of {command:?} beyond {low:?}");
                left_out[i] &= above || below;
            } else {
                left_out[i] = false;
            }
            if let (Ok(law), Some([low, high])) = (law, compensator.arm().limits()[i]) {
                // The law itself, whatever is applied.
                let (command, to) = (command[i], command[i] + law[i]);
                let out = (to > high && to > command) || (to < low && to < command);
                assert!(!out, "{at}: joint {i}, {to:?} of {command:?} beyond {low:?} {high:?}");
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
        last = (command, tick.joints);
    }
    stands(rng, &mut compensator, counts);
}

/// Where commands stop, what is applied stops as well, and when it was said to: at the
/// correction, or at none once it is switched off.
fn stands<T: Scalar, const N: usize>(
    rng: &mut ChaCha8Rng,
    compensator: &mut Compensator<'_, T, N>,
    counts: &mut Counts,
) {
    let settings = *compensator.settings();
    let state = State { payload: T::ONE, torque: Some([T::ONE; N]), ..State::at(T::ZERO) };
    for active in [true, false, rng.random()] {
        compensator.set_active(active);
        // Anywhere, often near a limit or beyond.
        let command = compensator.arm().limits().map(|limits| match limits {
            Some(ends) if rng.random() => {
                ends[rng.random_range(0..2)] + T::from_f32(number(rng, 0.2))
            }
            _ => T::from_f32(number(rng, 6.0)),
        });
        for _ in 0..=settings.ramp_ticks {
            let _ = compensator.tick(&command, &state);
        }
        let law = compensator.correction(&command, &state).unwrap_or([T::ZERO; N]);
        let goal = if active { law } else { [T::ZERO; N] };
        let ways = goal.iter().zip(compensator.applied()).zip(&settings.max_change);
        let ticks = ways.map(|((c, a), change)| ((*c - *a).abs() / *change).to_f64().ceil());
        let ticks = ticks.fold(0.0, f64::max) * (1.0 + 1.0 / 32.0) + 1.0;
        if ticks > 3000.0 {
            continue;
        }
        counts.stood += usize::from(ticks > 1.0);
        let mut last = None;
        for _ in 0..ticks as usize {
            last = Some(compensator.tick(&command, &state));
        }
        assert_eq!(active, !compensator.is_idle(), "{settings:?}");
        let Some(tick) = last else { continue };
        for i in 0..N {
            let at = (command[i], tick.joints[i], compensator.arm().limits()[i], settings);
            let applied = compensator.applied()[i];
            assert!(applied == goal[i], "{applied:?} for {:?}, {at:?}", goal[i]);
        }
        assert_eq!(tick.joints, compensator.tick(&command, &state).joints, "it stands");
    }
}

/// As found: applied took on the roundings of a joint beyond its limit, which were more than
/// a tick could take back.
#[test]
fn switched_off_beyond_a_limit_nothing_is_left() {
    let mut arm = blobs::parameters();
    arm.nominal = [
        Link::revolute(0.0, 0.0, 0.0, 0.3, 0.0),
        Link::revolute(1.570_796_4, 0.0, 0.0, 0.0, 0.0),
        Link::revolute(0.0, 0.5, 0.0, 0.0, 0.0),
    ];
    (arm.base_translation, arm.base_rotation) = (Vector3::zeros(), Vector3::zeros());
    (arm.tool, arm.masses) = (Vector3::new(0.5, 0.0, 0.0), None);
    arm.terms.clear();
    arm.corrections = [MdhParameters::from_array([0.0; 5]); 3];
    arm.corrections[0].theta = 0.005;
    arm.limits = [Some([-2.0, 2.0]), None, None];
    for change in [5e-8_f32, 1e-7, 1.1e-7] {
        let mut settings = Settings::new(Task::Position);
        (settings.max_correction, settings.max_change) = ([0.01; 3], [change; 3]);
        let mut compensator = Compensator::new(Arm::new(&arm), settings, &[1.9; 3]).unwrap();
        compensator.set_active(true);
        let state = State::at(20.0);
        for _ in 0..200_000 {
            let _ = compensator.tick(&[1.95, 0.3, 0.6], &state);
        }
        let left = compensator.applied()[0].abs();
        assert!(left > 0.004, "{left}");
        compensator.set_active(false);
        for _ in 0..500 + (left / change * (1.0 + 1.0 / 32.0)) as u32 + 2 {
            let _ = compensator.tick(&[2.002, 0.3, 0.6], &state);
        }
        assert!(compensator.is_idle(), "{change}: {:?}", compensator.applied());
    }
}

#[test]
fn what_every_tick_of_every_arm_keeps() {
    let mut counts = Counts::default();
    // Others are asked for as of the properties that proptest draws.
    let asked = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let first = asked("PROPTEST_RNG_SEED").unwrap_or(1).wrapping_mul(1 << 32);
    let many = asked("PROPTEST_CASES").unwrap_or(0).max(150);
    for seed in (0..many).map(|seed| first.wrapping_add(seed)) {
        promises::<f32, 1>(seed, &mut counts);
        promises::<f64, 2>(seed, &mut counts);
        promises::<f32, 3>(seed, &mut counts);
        promises::<f32, 6>(seed, &mut counts);
        promises::<f64, 6>(seed, &mut counts);
        promises::<f64, 4>(seed, &mut counts);
        promises::<f32, 5>(seed, &mut counts);
        promises::<f32, 7>(seed, &mut counts);
        promises::<f32, 11>(seed, &mut counts);
        promises::<f32, 16>(seed, &mut counts);
        promises::<f64, 16>(seed, &mut counts);
    }
    let Counts { off, ramping, on, refused, damped, bound, changed, limited, stood } = counts;
    let all = [off, ramping, on, refused, damped, bound, changed, limited, stood];
    assert!(all.iter().all(|count| *count > 500), "each comes about: {counts:?}");
}
