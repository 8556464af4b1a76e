//! What the law promises, over the whole joint space: of arms with six and seven
//! joints, one of them a rail, with and without terms, in f32 and f64.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{Approach, Arm, ArmParameters, Compensator, Link, Scalar, Settings, State, Task};

use super::arms::{
    Terms, UR10, UR10_TERMS, anywhere, miss, parameters, rail, seven, shipped, state,
};
use super::common::{puma, scara, ur10};

fn compensator<'t, T: Scalar, const N: usize>(
    p: &ArmParameters<'t, T, N>,
    task: Task,
) -> Compensator<'t, T, N> {
    Compensator::new(Arm::new(p), Settings::new(task), &[T::ZERO; N]).unwrap()
}

fn plus<T: Scalar, const N: usize>(q: &[T; N], c: &[T; N]) -> [T; N] {
    core::array::from_fn(|i| q[i] + c[i])
}

/// Any state that a controller may report.
fn any_state<T: Scalar, const N: usize>(rng: &mut ChaCha8Rng) -> State<T, N> {
    State {
        approach: [(); N].map(|()| {
            [Approach::Positive, Approach::Negative, Approach::Unknown][rng.random_range(0..3)]
        }),
        payload: T::from_f64(rng.random_range(0.0..10.0)),
        temperature: T::from_f64(rng.random_range(5.0..45.0)),
        torque: rng
            .random_bool(0.3)
            .then(|| [(); N].map(|()| T::from_f64(rng.random_range(-150.0..150.0)))),
    }
}

/// Farther from its target at q + c than at q: how often, and by how much, m.
fn farther<T: Scalar, const N: usize>(name: &str, p: &ArmParameters<T, N>, count: usize) {
    farther_by(name, p, count, Settings::new);
}

fn farther_by<T: Scalar, const N: usize>(
    name: &str,
    p: &ArmParameters<T, N>,
    count: usize,
    settings: impl Fn(Task) -> Settings<T, N>,
) {
    for task in [Task::Position, Task::Pose] {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let settings = settings(task);
        let compensator = Compensator::new(Arm::new(p), settings, &[T::ZERO; N]).unwrap();
        let arm = compensator.arm();
        let (mut before, mut after, mut worst) = (0.0, 0.0, 0.0_f64);
        for _ in 0..count {
            let q = anywhere(&mut rng, arm);
            let state = any_state(&mut rng);
            let c = compensator.correction(&q, &state).unwrap();
            let [a, b] = [q, plus(&q, &c)].map(|at| miss(arm, &q, &at, &state, &settings));
            assert!(b <= a * 1.02 + 2e-6, "{name}, {task:?}: {a:.2e} -> {b:.2e} m at {q:?}");
            (before, after, worst) = (before + a * a, after + b * b, worst.max(b));
        }
        let rms = |sum: f64| 1e3 * (sum / count as f64).sqrt();
        println!(
            "{name}, {task:?}: {:.3} -> {:.4} mm RMS, worst {:.2} mm",
            rms(before),
            rms(after),
            1e3 * worst
        );
        assert!(after < before / 4.0, "{name}");
    }
}

/// Every arm of these tests, by name.
fn each_arm<T: Scalar>(
    mut six: impl FnMut(&str, &ArmParameters<T, 6>),
    mut seven_joints: impl FnMut(&str, &ArmParameters<T, 7>),
) {
    six("UR10", &shipped(UR10));
    six("UR10 with 24 terms", &shipped(UR10_TERMS));
    for terms in [Terms::None, Terms::All] {
        let of = |name: &str| format!("{name}, {terms:?} terms");
        six(&of("spherical wrist"), &parameters(&puma(), 5e-4, terms));
        seven_joints(&of("seven joints"), &parameters(&seven(), 5e-4, terms));
        seven_joints(&of("UR10 on a rail"), &parameters(&rail(), 5e-4, terms));
    }
    six("UR10, off by centimetres", &parameters(&ur10(), 5e-3, Terms::Smooth));
}

#[test]
fn the_tool_is_never_farther_from_its_target_than_without() {
    each_arm::<f64>(|name, p| farther(name, p, 4000), |name, p| farther(name, p, 4000));
    each_arm::<f32>(|name, p| farther(name, p, 4000), |name, p| farther(name, p, 4000));
}

/// An arm of the same shape and of so many times the size, with its errors.
fn sized<T: Scalar, const N: usize>(
    mut p: ArmParameters<'static, T, N>,
    times: f64,
) -> ArmParameters<'static, T, N> {
    let times = T::from_f64(times);
    let links = p.nominal.iter_mut().map(|link| &mut link.parameters);
    for parameters in links.chain(&mut p.corrections) {
        parameters.a *= times;
        parameters.d *= times;
    }
    p.base_translation *= times;
    p.tool *= times;
    p
}

#[test]
fn of_arms_of_other_sizes_it_is_not_either() {
    for times in [0.05, 0.3, 2.0, 5.0] {
        let settings = |task| Settings::new(task).for_reach(1.3 * times);
        let name = |which: &str| format!("{which} times {times}");
        let ur10 = sized(parameters::<f64, 6>(&ur10(), 5e-4, Terms::None), times);
        farther_by(&name("UR10"), &ur10, 4000, settings);
        let puma = sized(parameters::<f32, 6>(&puma(), 5e-4, Terms::None), times);
        let settings = |task| Settings::new(task).for_reach(1.3 * times as f32);
        farther_by(&name("spherical wrist"), &puma, 4000, settings);
    }
    // As of an arm of no size.
    for reach in [0.0, -1.0, f64::NAN, 40.0] {
        let settings = Settings::new(Task::Position).for_reach(reach);
        let p = shipped::<f64>(UR10);
        assert!(Compensator::new(Arm::new(&p), settings, &[0.0; 6]).is_err(), "{reach}");
    }
}

/// The poses at which the correction fed its own damping, and where clamps of
/// single joints led elsewhere.
#[test]
fn poses_that_were_restless_or_led_away() {
    let restless =
        [0.026_882_574, -2.556_506_2, 2.237_665, 0.836_837_35, 0.533_446_6, 0.837_274_97];
    let away = [1.548_129_4, -2.659_431_2, 0.039_282_884, -0.493_561_15, -1.399_555_4, 1.173_041_7];
    let p = shipped::<f32>(UR10);
    for task in [Task::Pose, Task::Position] {
        for q in [restless, away] {
            let mut compensator = compensator(&p, task);
            compensator.set_active(true);
            let state = State::at(20.0);
            let ticks: Vec<_> = (0..1000).map(|_| compensator.tick(&q, &state)).collect();
            assert!(ticks[600..].iter().all(|tick| tick.joints == ticks[999].joints));
            let settings = Settings::new(task);
            let [a, b] = [q, ticks[999].joints]
                .map(|at| miss(compensator.arm(), &q, &at, &state, &settings));
            println!("{task:?}: {:.3} -> {:.4} mm", a * 1e3, b * 1e3);
            assert!(b <= a, "{task:?}: {a} -> {b}");
        }
    }
}

fn continuous<const N: usize>(p: &ArmParameters<f64, N>, steepest: f64) {
    let mut p = p.clone();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for (i, limits) in p.limits.iter_mut().enumerate() {
        // Limits that lines go through.
        *limits = Some([-2.0 + 0.1 * i as f64, 2.0 + 0.1 * i as f64]);
    }
    for task in [Task::Position, Task::Pose] {
        let compensator = compensator(&p, task);
        let (mut largest, mut steep) = (0.0_f64, 0.0_f64);
        for _ in 0..60 {
            // A line of 0.4 rad through the joint space, payload, temperature and torques with it.
            let from = anywhere(&mut rng, compensator.arm()).map(|q| q / 2.0);
            let way: [f64; N] = [(); N].map(|()| rng.random_range(-0.2..0.2));
            let read = rng.random_bool(0.3);
            let at = |share: f64| {
                let q = core::array::from_fn(|i| from[i] + way[i] * share);
                let state = State {
                    payload: 5.0 + 5.0 * share,
                    temperature: 25.0 + 10.0 * share,
                    torque: read.then(|| core::array::from_fn(|i| 80.0 * share - 9.0 * i as f64)),
                    ..state()
                };
                compensator.correction(&q, &state).unwrap()
            };
            let change = |a: &[f64; N], b: &[f64; N]| {
                a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            // Where a step changes most, it is halved again and again: a jump stays.
            let steps: Vec<_> = (0..=400).map(|i| at(f64::from(i) / 400.0)).collect();
            let jump = |i: &usize| change(&steps[*i], &steps[i + 1]);
            let (mut low, mut high) = (0..400)
                .max_by(|a, b| jump(a).total_cmp(&jump(b)))
                .map(|i| (i as f64 / 400.0, (i + 1) as f64 / 400.0))
                .unwrap();
            largest = largest.max(change(&at(low), &at(high)));
            for _ in 0..20 {
                let middle = 0.5 * (low + high);
                let first = change(&at(low), &at(middle)) > change(&at(middle), &at(high));
                if first { high = middle } else { low = middle }
            }
            steep = steep.max(change(&at(low), &at(high)) / (high - low));
        }
        println!(
            "{task:?}: largest step {largest:.1e} rad in 1 mrad, steepest {:.2} rad per rad",
            steep / 0.2
        );
        assert!(steep < 0.2 * steepest, "{task:?}: a jump, or {} rad per rad", steep / 0.2);
    }
}

#[test]
fn it_is_continuous_in_command_payload_temperature_and_torques() {
    continuous(&parameters::<f64, 6>(&ur10(), 5e-4, Terms::Smooth), 100.0);
    continuous(&parameters::<f64, 6>(&puma(), 5e-4, Terms::Smooth), 100.0);
    continuous(&parameters::<f64, 7>(&rail(), 5e-4, Terms::Smooth), 100.0);
}

/// How far the correction of any joint is from that a trifle further from a limit, rad or m:
/// where the limit is the command itself, and at any share of the largest correction before it.
fn jump_at_a_limit<const N: usize>(p: &ArmParameters<f64, N>, task: Task, most: f64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut largest = 0.0_f64;
    for k in 0..1500 {
        let mut p = p.clone();
        let q = anywhere(&mut rng, &Arm::new(&p));
        let joint = rng.random_range(0..N);
        let share = if k % 2 == 0 { 0.0 } else { rng.random_range(0.0..1.0) };
        p.limits[joint] = Some([q[joint] - share * most, q[joint] + 2.0]);
        let mut settings = Settings::new(task);
        (settings.max_correction, settings.max_change) = ([most; N], [most.min(1e-3); N]);
        let compensator = Compensator::new(Arm::new(&p), settings, &q).unwrap();
        let mut inside = q;
        inside[joint] += 1e-12;
        let state = State { payload: 8.0, ..state() };
        let [a, b] = [q, inside].map(|q| compensator.correction(&q, &state).unwrap());
        let jump = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        largest = largest.max(jump);
    }
    largest
}

/// Also of joints that bend by more than they may be corrected by: of what is taken back more is
/// left out at a limit than the bound leaves.
#[test]
fn no_joint_jumps_at_a_limit_however_little_it_may_be_corrected() {
    let bending = shipped::<f64>(UR10_TERMS);
    let rail = parameters::<f64, 7>(&rail(), 3e-3, Terms::Smooth);
    for most in [0.03, 3e-3, 2e-3, 1e-3, 3e-4] {
        for task in [Task::Position, Task::Pose] {
            for jump in [jump_at_a_limit(&bending, task, most), jump_at_a_limit(&rail, task, most)]
            {
                assert!(jump < 1e-8, "{task:?}, at most {most}: {jump}");
            }
        }
    }
}

/// What is applied, tick by tick, turns back and forth no more than the law
/// itself, sampled finer.
#[test]
fn along_a_path_what_is_applied_varies_no_more_than_the_law() {
    let p = shipped::<f64>(UR10_TERMS);
    for task in [Task::Position, Task::Pose] {
        let settings = Settings { ramp_ticks: 0, ..Settings::new(task) };
        let mut compensator = Compensator::new(Arm::new(&p), settings, &[0.0; 6]).unwrap();
        compensator.set_active(true);
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for _ in 0..4 {
            let ends = [(); 2].map(|()| anywhere(&mut rng, compensator.arm()));
            let at = |share: f64| -> [f64; 6] {
                core::array::from_fn(|j| ends[0][j] + share * (ends[1][j] - ends[0][j]))
            };
            for _ in 0..100 {
                let _ = compensator.tick(&at(0.0), &state());
            }
            let (mut applied, mut law) = (Variation::default(), Variation::default());
            const TICKS: u32 = 3000;
            for i in 0..=TICKS {
                let q = at(f64::from(i) / f64::from(TICKS));
                let tick = compensator.tick(&q, &state());
                applied.to(core::array::from_fn(|j| tick.joints[j] - q[j]));
                for k in 0..100 * u32::from(i < TICKS) {
                    let share = (f64::from(i) + f64::from(k) / 100.0) / f64::from(TICKS);
                    law.to(compensator.correction(&at(share), &state()).unwrap());
                }
            }
            for (applied, law) in applied.sum.iter().zip(law.sum) {
                assert!(*applied <= 1.05 * law + 1e-9, "{task:?}: {applied} > {law}");
            }
        }
    }
}

/// Total variation of each joint.
#[derive(Default)]
struct Variation {
    sum: [f64; 6],
    last: Option<[f64; 6]>,
}

impl Variation {
    fn to(&mut self, now: [f64; 6]) {
        if let Some(last) = self.last.replace(now) {
            for ((sum, a), b) in self.sum.iter_mut().zip(now).zip(last) {
                *sum += (a - b).abs();
            }
        }
    }
}

/// Error left where nothing is damped or held: median, 99 % and worst, m.
fn left<T: Scalar, const N: usize>(
    p: &ArmParameters<T, N>,
    task: Task,
    refinements: u8,
) -> [f64; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let settings = Settings {
        refinements,
        ramp_ticks: 0,
        max_change: [T::from_f64(0.2); N],
        ..Settings::new(task)
    };
    let mut compensator = Compensator::new(Arm::new(p), settings, &[T::ZERO; N]).unwrap();
    compensator.set_active(true);
    let mut all = Vec::new();
    for _ in 0..2000 {
        let q = anywhere(&mut rng, compensator.arm());
        let tick = compensator.tick(&q, &state());
        if tick.is_complete() {
            assert!(tick.left.is_none());
            all.push(miss(compensator.arm(), &q, &tick.joints, &state(), &settings));
        }
    }
    assert!(all.len() > 500);
    all.sort_by(f64::total_cmp);
    [all[all.len() / 2], all[all.len() * 99 / 100], all[all.len() - 1]]
}

#[test]
fn what_a_complete_tick_leaves() {
    for (name, p) in [("UR10", shipped::<f64>(UR10)), ("with 24 terms", shipped(UR10_TERMS))] {
        for task in [Task::Position, Task::Pose] {
            let by: Vec<_> = (1..=4).map(|refinements| left(&p, task, refinements)).collect();
            for (refinements, [median, most, worst]) in (1..).zip(&by) {
                println!(
                    "{name}, {task:?}, {refinements}: median {:.3}, 99 % {:.3}, worst {:.3} um",
                    median * 1e6,
                    most * 1e6,
                    worst * 1e6
                );
            }
            // What bends is known to first order only until it is looked at again.
            let rule = if p.terms.is_empty() { 2e-8 } else { 4e-6 };
            assert!(by[0][0] < rule, "{name}: {:?}", by[0]);
            // Gravity's side of a gap may change on the last nanometre.
            assert!(by[3][0] < 1e-9 && by[3][1] < 1e-8, "refined it goes to zero");
        }
    }
    let [median, _, _] = left(&shipped::<f32>(UR10), Task::Pose, 1);
    assert!(median < 1e-6, "f32: {median}");
    let [median, most, _] =
        left(&parameters::<f64, 4>(&scara(), 5e-4, Terms::None), Task::Position, 4);
    assert!(median < 1e-10 && most < 1e-8, "SCARA: {median} {most}");
}

#[test]
fn no_joint_is_corrected_beyond_its_bound_or_a_limit() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let mut p = parameters::<f64, 6>(&ur10(), 5e-3, Terms::All);
    let mut near = 0;
    for _ in 0..3000 {
        let arm = Arm::new(&p);
        let q = anywhere(&mut rng, &arm);
        for (limits, q) in p.limits.iter_mut().zip(q) {
            // Often near: within, at, or beyond.
            *limits = match rng.random_range(0..6) {
                0 => Some([q - rng.random_range(0.0..0.02), q + 1.0]),
                1 => Some([q - 1.0, q + rng.random_range(0.0..0.02)]),
                2 => Some([q, q + 1.0]),
                3 => Some([q + 0.1, q + 1.0]),
                _ => None,
            };
        }
        let task = if rng.random_range(0..2) == 0 { Task::Pose } else { Task::Position };
        let compensator = compensator(&p, task);
        let state = any_state(&mut rng);
        let c = compensator.correction(&q, &state).unwrap();
        for ((c, q), limits) in c.iter().zip(q).zip(&p.limits) {
            assert!(c.abs() <= 0.03 * (1.0 + 1e-12));
            let [low, high] = limits.unwrap_or([-1e9, 1e9]);
            if q < low || q > high {
                assert_eq!(*c, 0.0, "a command beyond a limit stays");
            } else {
                assert!(low - 1e-12 <= q + c && q + c <= high + 1e-12, "{q} {c} {limits:?}");
                near += usize::from(*c != 0.0 && (q - low < 0.02 || high - q < 0.02));
            }
        }
        let settings = Settings::new(task);
        let [a, b] = [q, plus(&q, &c)].map(|at| miss(&Arm::new(&p), &q, &at, &state, &settings));
        assert!(b <= a * 1.02 + 2e-6, "{task:?}: {a:.2e} -> {b:.2e} m");
    }
    assert!(near > 500);
}

/// The bound of the smallest singular value is one: wherever that is below the
/// setting the solution is damped, and nowhere where it is above sqrt(6) times.
#[test]
fn it_is_damped_wherever_a_singular_value_is_below_the_setting() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let p = shipped::<f64>(UR10);
    let mut counts = [0; 3];
    for task in [Task::Position, Task::Pose] {
        let settings = Settings::<f64, 6>::new(task);
        let mut compensator = Compensator::new(Arm::new(&p), settings, &[0.0; 6]).unwrap();
        compensator.set_active(true);
        for _ in 0..4000 {
            let q = anywhere(&mut rng, compensator.arm());
            let damping = compensator.tick(&q, &state()).damping.unwrap();
            let columns = compensator.arm().nominal().jacobian(&q).columns;
            let rows = if task == Task::Pose { 6 } else { 3 };
            let jacobian = nalgebra::DMatrix::from_fn(rows, 6, |i, j| match i {
                0..3 => columns[j].linear[i],
                _ => columns[j].angular[i - 3] * settings.rotation_length,
            });
            let smallest = jacobian.singular_values().min();
            if smallest < settings.singular {
                assert!(damping > 0.0, "{smallest}");
                counts[0] += 1;
            } else if smallest > settings.singular * (rows as f64).sqrt() {
                assert_eq!(damping, 0.0, "{smallest}");
                counts[1] += 1;
            } else {
                counts[2] += 1;
            }
        }
    }
    println!("below, above, between: {counts:?}");
    assert!(counts.iter().all(|count| *count > 100));
}

#[test]
fn a_redundant_arm_takes_the_smallest_correction() {
    let p = parameters::<f64, 7>(&seven(), 5e-4, Terms::None);
    let compensator = compensator(&p, Task::Pose);
    let goal = [0.3, 0.9, -0.5, 1.2, 0.4, -0.9, 0.2];
    let c = nalgebra::SVector::<f64, 7>::from(compensator.correction(&goal, &state()).unwrap());
    let columns = compensator.arm().nominal().jacobian(&goal).columns;
    let jacobian = nalgebra::SMatrix::<f64, 6, 7>::from_fn(|i, j| match i {
        0..3 => columns[j].linear[i],
        _ => columns[j].angular[i - 3],
    });
    // The motion that leaves the tool where it is: no part of the correction.
    let gram = jacobian.transpose() * jacobian;
    let still = gram.symmetric_eigen();
    let (least, _) = still.eigenvalues.argmin();
    assert!(still.eigenvalues[least] < 1e-12);
    assert!(c.dot(&still.eigenvectors.column(least)).abs() < 1e-9);
}

/// Arms whose Jacobian lacks several ranks at a pose: pivots of mixed sign had
/// cancelled in the trace, the step was rounding noise, and the tool went by centimetres.
#[test]
fn a_jacobian_that_lacks_several_ranks_is_damped() {
    const H: f64 = core::f64::consts::FRAC_PI_2;
    let r = |alpha: f64, a, theta: f64, d| Link::revolute(alpha * H, a, theta * H, d, 0.0);
    let p = |alpha: f64, a, theta: f64, d| Link::prismatic(alpha * H, a, theta * H, d, 0.0);
    fn check<const N: usize>(links: [Link<f64>; N], q: [f64; N]) {
        let tool = nalgebra::Vector3::new(0.1, 0.0, 0.2);
        let p = ArmParameters { tool, ..parameters::<f64, N>(&links, 5e-4, Terms::None) };
        let compensator = compensator(&p, Task::Pose);
        let c = compensator.correction(&q, &state()).unwrap();
        let settings = Settings::new(Task::Pose);
        let [a, b] =
            [q, plus(&q, &c)].map(|at| miss(compensator.arm(), &q, &at, &state(), &settings));
        assert!(b <= a * 1.02 + 2e-6, "{N} joints: {a:.2e} -> {b:.2e} m");
    }
    check(
        [
            r(-1.0, 0.3, 1.0, 0.2),
            p(0.0, 0.3, 0.0, 0.2),
            r(0.0, 0.3, 0.0, 0.2),
            r(0.0, 0.3, 1.0, 0.2),
            r(0.0, 0.0, 0.0, 0.0),
            p(1.0, 0.3, 1.0, 0.0),
        ],
        [-0.7, 1.0, 0.3, 0.3, 0.0, 0.0],
    );
    check(
        [
            r(0.0, 0.0, 0.0, 0.0),
            r(0.0, 0.0, 0.0, 0.2),
            r(1.0, 0.3, 1.0, 0.2),
            r(0.0, 0.0, 0.0, 0.0),
        ],
        [1.2, 0.3, 0.3, 1.0],
    );
    check(
        [
            r(0.0, 0.3, 0.0, 0.2),
            r(0.0, 0.0, 1.0, 0.2),
            r(0.0, 0.0, 1.0, 0.0),
            r(0.0, 0.0, 0.0, 0.2),
            r(1.0, 0.0, 1.0, 0.0),
        ],
        [-0.7, 1.0, 0.5, 1.0, 0.3],
    );
}
