//! The drift watch: how often it cries wolf, how soon it sees a shift, and
//! whom it suspects.

use crate::arms::{Tracker, stored, vector};
use crate::common::{puma, ur10};
use nalgebra::Vector3;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::check_point::CheckPoint;
use truearm::drift::{DriftError, DriftWatch, FalseAlarms, Group, Verdict};
use truearm::solve::SolveError;
use truearm::{Arm, ArmParameters, Scalar};

const SIGMA: f64 = 2e-5;

fn parameters() -> ArmParameters<'static, f64, 6> {
    stored(ur10(), [0.06, -0.025, 0.11])
}

struct Shop {
    arm: Arm<'static, f64, 6>,
    /// What the arm is by now.
    real: Arm<'static, f64, 6>,
    rng: ChaCha8Rng,
}

impl Shop {
    fn new(seed: u64, shifted: impl Fn(&mut ArmParameters<f64, 6>)) -> Self {
        let mut real = parameters();
        shifted(&mut real);
        let (arm, real) = (Arm::new(&parameters()), Arm::new(&real));
        Self { arm, real, rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    fn normal(&mut self) -> f64 {
        let (a, b): (f64, f64) =
            (self.rng.random_range(1e-12..1.0), self.rng.random_range(0.0..1.0));
        (-2.0 * a.ln()).sqrt() * (core::f64::consts::TAU * b).cos()
    }

    fn point(&mut self) -> CheckPoint<f64, 6> {
        let q = core::array::from_fn(|_| self.rng.random_range(-2.5..2.5));
        let noise = Vector3::from_fn(|_, _| self.normal()) * SIGMA;
        CheckPoint::plain(q, self.real.real_pose(&q).translation + noise, 20.0)
    }

    fn push(&mut self, watch: &mut DriftWatch<f64, 6>) -> Verdict<f64> {
        let point = self.point();
        watch.push(&self.arm, &point, &Vector3::zeros()).unwrap()
    }

    /// Points until the alarm, and the watch at that moment.
    fn until_alarm(&mut self, alarms: FalseAlarms) -> (u32, DriftWatch<f64, 6>) {
        let mut watch = DriftWatch::new(SIGMA, alarms).unwrap();
        let mut points = 1;
        while !self.push(&mut watch).recalibrate {
            points += 1;
        }
        (points, watch)
    }
}

/// Mean run length while nothing moves; its standard deviation is its mean
/// over the square root of the runs.
#[test]
fn false_alarms_are_as_rare_as_stated() {
    for (alarms, runs) in
        [(FalseAlarms::OneIn100, 900), (FalseAlarms::OneIn1000, 400), (FalseAlarms::OneIn10000, 60)]
    {
        let mut shop = Shop::new(11, |_| ());
        let total: u32 = (0..runs).map(|_| shop.until_alarm(alarms).0).sum();
        let mean = f64::from(total) / f64::from(runs);
        let stated = f64::from(alarms.points());
        println!("{alarms:?}: mean of {runs} run lengths {mean:.0}");
        let bound = 3.0 / f64::from(runs).sqrt();
        assert!((mean / stated - 1.0).abs() < bound, "{alarms:?}: {mean}");
    }
}

fn delay(seed: u64, shifted: impl Fn(&mut ArmParameters<f64, 6>)) -> f64 {
    let mut shop = Shop::new(seed, shifted);
    let runs = 200;
    let total: u32 = (0..runs).map(|_| shop.until_alarm(FalseAlarms::OneIn1000).0).sum();
    f64::from(total) / f64::from(runs)
}

/// Shifts of 20 um and more at the tool, at one false alarm in 1,000 points.
#[test]
fn shifts_are_seen_soon() {
    let joint =
        |j: usize, by: f64| move |p: &mut ArmParameters<f64, 6>| p.corrections[j].theta += by;
    let tool = |by: f64| move |p: &mut ArmParameters<f64, 6>| p.tool.x += by;
    for (name, delay, at_most) in [
        ("joint 2 by 0.05 mrad", delay(1, joint(1, 5e-5)), 15.0),
        ("joint 2 by 0.1 mrad", delay(2, joint(1, 1e-4)), 6.0),
        ("joint 2 by 0.5 mrad", delay(3, joint(1, 5e-4)), 1.5),
        ("tool by 0.03 mm", delay(4, tool(3e-5)), 25.0),
        ("tool by 0.05 mm", delay(5, tool(5e-5)), 8.0),
        ("tool by 0.2 mm", delay(6, tool(2e-4)), 1.5),
    ] {
        println!("{name}: {delay:.1} points");
        assert!(delay < at_most, "{name}: {delay}");
    }
}

/// Named right at the fifth point after the alarm.
#[test]
fn the_group_that_moved_is_suspected() {
    type Shift = fn(&mut ArmParameters<f64, 6>);
    let shifts: [(Group, Shift); 7] = [
        (Group::JointOffset(0), |p| p.corrections[0].theta += 3e-4),
        (Group::JointOffset(1), |p| p.corrections[1].theta -= 3e-4),
        (Group::JointOffset(2), |p| p.corrections[2].theta += 3e-4),
        (Group::JointOffset(3), |p| p.corrections[3].theta += 5e-4),
        (Group::JointOffset(4), |p| p.corrections[4].theta -= 5e-4),
        (Group::Tool, |p| p.tool += Vector3::new(1e-4, 1e-4, -1e-4)),
        (Group::Base, |p| {
            p.base_translation = Vector3::new(1e-4, -1e-4, 1e-4);
            p.base_rotation = Vector3::new(1e-4, 1e-4, 0.0);
        }),
    ];
    for (group, shifted) in shifts {
        let mut shop = Shop::new(21, shifted);
        let right = (0..100).filter(|_| {
            let (_, mut watch) = shop.until_alarm(FalseAlarms::OneIn1000);
            (0..5).for_each(|_| assert!(shop.push(&mut watch).recalibrate));
            watch.suspect().is_some_and(|s| s.group == group)
        });
        let right = right.count();
        println!("{group:?}: {right} of 100");
        assert!(right >= 90, "{group:?}: {right}");
    }
}

#[test]
fn the_shift_is_measured_and_a_baseline_hides_what_was_always_there() {
    let mut shop = Shop::new(31, |p| p.corrections[2].theta += 1e-3);
    let (_, mut watch) = shop.until_alarm(FalseAlarms::OneIn10000);
    (0..20).for_each(|_| assert!(shop.push(&mut watch).recalibrate));
    let suspect = watch.suspect().unwrap();
    assert_eq!(suspect.group, Group::JointOffset(2));
    assert!((suspect.shift - 1e-3).abs() < 5e-5, "{suspect:?}");
    assert!(suspect.explained > 0.9 * suspect.total && suspect.degrees == 1);
    // An alarm stays until restart.
    assert!(shop.push(&mut watch).recalibrate);
    watch.restart();
    assert_eq!(watch, DriftWatch::new(SIGMA, FalseAlarms::OneIn10000).unwrap());
    assert_eq!(watch.suspect(), None);
    // The same arm with its error known: innovations of noise alone.
    let mut alarms = 0;
    for _ in 0..500 {
        let point = shop.point();
        let baseline = (shop.real.real_pose(&point.q).translation
            - shop.arm.real_pose(&point.q).translation)
            .into_owned();
        let verdict = watch.push(&shop.arm, &point, &baseline).unwrap();
        alarms += u32::from(verdict.recalibrate);
    }
    assert_eq!(alarms, 0);
}

/// The tool lies on the last axis: an offset of joint 6 moves no point, and what
/// rounding makes of its column is no reason to suspect it. Not even when an alarm was
/// false and any direction does as well as another.
fn a_joint_that_moves_no_point_is_not_suspected<T: Scalar>() {
    let tool = [0.0, 0.0, 0.12];
    let arm = Arm::new(&stored::<T, 6>(puma(), tool));
    let mut named = 0;
    for seed in 0..300 {
        let mut moved = stored(puma(), tool);
        if seed % 2 == 0 {
            moved.corrections[4].theta += 2e-4;
        }
        let mut tracker = Tracker::<T, 6>::new(&moved, SIGMA, seed);
        let mut watch = DriftWatch::new(T::from_f64(SIGMA), FalseAlarms::OneIn100).unwrap();
        let none = vector([0.0; 3]);
        while !watch.push(&arm, &tracker.point(), &none).unwrap().recalibrate {}
        let explained = |watch: &DriftWatch<T, 6>| watch.explanations().nth(5).unwrap().explained;
        assert!(explained(&watch).to_f64() < 1e-3, "seed {seed}");
        let suspect = watch.suspect();
        assert_ne!(suspect.map(|s| s.group), Some(Group::JointOffset(5)), "{suspect:?}");
        named += usize::from(suspect.is_some());
    }
    assert!(named > 150, "{named}");
}

#[test]
fn a_column_of_rounding_noise_names_no_joint() {
    a_joint_that_moves_no_point_is_not_suspected::<f64>();
    a_joint_that_moves_no_point_is_not_suspected::<f32>();
}

#[test]
fn errors_say_where_they_come_from() {
    let mut shop = Shop::new(43, |_| ());
    let mut watch = DriftWatch::new(SIGMA, FalseAlarms::default()).unwrap();
    let mut far = shop.point();
    far.point.x = 1e147;
    let before = watch;
    let error = watch.push(&shop.arm, &far, &Vector3::zeros()).unwrap_err();
    assert_eq!(error, DriftError::Solve(SolveError::Overflow));
    let source = std::error::Error::source(&error).unwrap();
    assert_eq!(source.to_string(), SolveError::Overflow.to_string());
    assert_eq!(watch, before);
}

#[test]
fn bad_input_is_an_error_and_changes_nothing() {
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200] {
        let watch = DriftWatch::<f64, 6>::new(sigma, FalseAlarms::default());
        assert_eq!(watch.map(|_| ()), Err(DriftError::BadSigma));
    }
    let mut shop = Shop::new(41, |p| p.tool.x += 1e-3);
    let mut watch = DriftWatch::new(SIGMA, FalseAlarms::default()).unwrap();
    let _ = shop.push(&mut watch);
    let before = watch;
    let good = shop.point();
    let mut bad = [good; 3];
    bad[0].q[3] = f64::NAN;
    bad[1].point.z = f64::INFINITY;
    bad[2].state.payload = f64::NAN;
    for point in bad {
        let pushed = watch.push(&shop.arm, &point, &Vector3::zeros());
        assert_eq!(pushed, Err(DriftError::NotFinite));
    }
    let nan = Vector3::repeat(f64::NAN);
    assert_eq!(watch.push(&shop.arm, &good, &nan), Err(DriftError::NotFinite));
    assert_eq!(watch, before);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn no_nan_comes_out(
        numbers in prop::collection::vec(prop::array::uniform9(any::<f64>()), 1..10),
        usual in prop::bool::ANY,
        sigma in any::<f64>(),
    ) {
        let arm = Arm::new(&parameters());
        let sigma = if usual { SIGMA } else { sigma };
        let Ok(mut watch) = DriftWatch::<f64, 6>::new(sigma, FalseAlarms::OneIn100) else {
            return Ok(());
        };
        for [x, y, z, q @ ..] in numbers {
            let point = CheckPoint::plain(q, Vector3::new(x, y, z), 20.0);
            if let Ok(v) = watch.push(&arm, &point, &Vector3::zeros()) {
                prop_assert!(v.level.is_finite() && v.chi_square.is_finite());
            }
            for s in watch.explanations() {
                let all = [s.explained, s.total, s.shift];
                prop_assert!(all.iter().all(|v| !v.is_nan()), "{s:?}");
            }
        }
    }
}

/// The compiler warns of a verdict that nobody looks at, which may ask for a re-calibration.
#[test]
#[expect(unused_must_use)]
#[deny(unfulfilled_lint_expectations)]
fn a_verdict_that_is_dropped_is_warned_of() {
    let mut shop = Shop::new(1, |_| ());
    let mut watch = DriftWatch::new(SIGMA, FalseAlarms::default()).unwrap();
    shop.push(&mut watch);
}
