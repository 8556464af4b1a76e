//! The promises along paths: random ways through the whole joint space, tick by
//! tick at a kilohertz, with rests. A small part in every test run; the long
//! form is `cargo xtask study ticks`.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::compensate::Status;
use truearm::{Arm, ArmParameters, Compensator, Scalar, Settings, Task};

use super::arms::{
    Terms, UR10, UR10_TERMS, anywhere, miss, parameters, rail, seven, shipped, state,
};
use super::common::puma;

/// What was seen.
#[derive(Debug, Default)]
struct Seen {
    ticks: usize,
    incomplete: usize,
    rests: usize,
    restless: usize,
    late: usize,
    farther: usize,
    /// A correction that turned back by more than 0.5 mrad from tick to tick.
    reversals: usize,
    before: f64,
    after: f64,
}

impl Seen {
    fn row(&self, name: &str) {
        let rms = |sum: f64| 1e3 * (sum / self.ticks as f64).sqrt();
        println!(
            "| {name} | {} | {:.3} | {:.4} | {:.1} | {} | {} | {} | {} | {} |",
            self.ticks,
            rms(self.before),
            rms(self.after),
            100.0 * self.incomplete as f64 / self.ticks as f64,
            self.farther,
            self.reversals,
            self.rests,
            self.restless,
            self.late
        );
    }
}

/// Ways at up to 2 rad/s (m/s on a rail) towards anywhere, a rest at each end.
fn travel<T: Scalar, const N: usize>(
    p: &ArmParameters<'_, T, N>,
    task: Task,
    ticks: usize,
) -> Seen {
    let settings = Settings::new(task);
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let arm = Arm::new(p);
    let mut at = anywhere(&mut rng, &arm);
    let mut compensator = Compensator::new(arm, settings, &at).unwrap();
    compensator.set_active(true);
    let state = state();
    for _ in 0..settings.ramp_ticks {
        let _ = compensator.tick(&at, &state);
    }
    let mut seen = Seen::default();
    let mut last: [Option<[f64; N]>; 2] = [None; 2];
    while seen.ticks < ticks {
        let goal = anywhere(&mut rng, compensator.arm());
        let leg = T::from_f64(rng.random_range(0.02..0.3));
        let to: [T; N] = core::array::from_fn(|i| at[i] + (goal[i] - at[i]) * leg);
        let way = to.iter().zip(at).map(|(a, b)| (*a - b).abs().to_f64()).fold(0.0, f64::max);
        let steps = (way / rng.random_range(0.2e-3..2e-3)).ceil();
        let mut applied = [T::ZERO; N];
        for step in 1..=steps as usize {
            let share = T::from_f64(step as f64 / steps);
            let q: [T; N] = core::array::from_fn(|i| at[i] + (to[i] - at[i]) * share);
            let tick = compensator.tick(&q, &state);
            assert_eq!(tick.status, Status::On);
            seen.ticks += 1;
            seen.incomplete += usize::from(!tick.is_complete());
            applied = core::array::from_fn(|i| tick.joints[i] - q[i]);
            let c = compensator.correction(&q, &state).unwrap();
            let corrected: [T; N] = core::array::from_fn(|i| q[i] + c[i]);
            let [a, b] =
                [&q, &corrected].map(|at| miss(compensator.arm(), &q, at, &state, &settings));
            (seen.before, seen.after) = (seen.before + a * a, seen.after + b * b);
            seen.farther += usize::from(b > a * 1.02 + 2e-6);
            let c = c.map(Scalar::to_f64);
            if let [Some(first), Some(second)] = last {
                let turned = |i: &usize| {
                    let (a, b) = (second[*i] - first[*i], c[*i] - second[*i]);
                    a * b < 0.0 && a.abs().min(b.abs()) > 0.5e-3
                };
                seen.reversals += usize::from((0..N).any(|i| turned(&i)));
            }
            last = [last[1], Some(c)];
        }
        at = to;
        let c = compensator.correction(&at, &state).unwrap();
        let stands: [T; N] = core::array::from_fn(|i| at[i] + c[i]);
        let far = c.iter().zip(applied).map(|(c, a)| (*c - a).abs().to_f64()).fold(0.0, f64::max);
        // One more than the steps make, where their sum is rounded.
        let most = (far / 1e-3).ceil() as usize + 1;
        let rest: Vec<_> = (0..most + 5).map(|_| compensator.tick(&at, &state).joints).collect();
        seen.rests += 1;
        seen.late += usize::from(rest[most - 1] != stands);
        seen.restless += usize::from(rest[most..].iter().any(|joints| *joints != stands));
    }
    seen
}

fn all(ticks: usize) {
    println!(
        "| arm, task | ticks | without, mm RMS | the law, mm RMS | damped or held, % | farther | \
         reversals | rests | restless | late |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut rows = Vec::new();
    for task in [Task::Position, Task::Pose] {
        let name = |arm: &str| format!("{arm}, {task:?}");
        rows.push((name("UR10, f32"), travel(&shipped::<f32>(UR10), task, ticks)));
        rows.push((name("UR10, 24 terms, f32"), travel(&shipped::<f32>(UR10_TERMS), task, ticks)));
        let wrist = parameters::<f64, 6>(&puma(), 5e-4, Terms::All);
        rows.push((name("spherical wrist, f64"), travel(&wrist, task, ticks)));
        let redundant = parameters::<f32, 7>(&seven(), 5e-4, Terms::All);
        rows.push((name("seven joints, f32"), travel(&redundant, task, ticks)));
        let on_rail = parameters::<f32, 7>(&rail(), 5e-4, Terms::All);
        rows.push((name("UR10 on a rail, f32"), travel(&on_rail, task, ticks)));
    }
    let mut total = 0;
    for (name, seen) in &rows {
        seen.row(name);
        total += seen.ticks;
    }
    println!("{total} ticks");
    for (name, seen) in &rows {
        let wrong = [seen.farther, seen.reversals, seen.restless, seen.late];
        assert_eq!(wrong, [0; 4], "{name}");
        assert!(seen.rests > 2 && seen.after < seen.before / 4.0, "{name}");
    }
}

#[test]
fn along_paths_every_promise_holds() {
    all(10_000);
}

#[test]
#[ignore = "the long form: cargo xtask study ticks"]
fn along_a_million_ticks_every_promise_holds() {
    all(100_000);
}
