//! Where joints came from, what they were read to hold, how the base settled: what
//! a file tells without saying it, and columns that say it.

use super::session::{SIGMA, arm, diagnosed, names, session, still, with};
use crate::simulated::{Truth, csv_of, vector};
use nalgebra::{Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, Verdict, diagnose};
use truearm_host::error::ErrorKind;
use truearm_host::evaluate::{Reregister, evaluate};
use truearm_host::model::{Measurements, Robot};

/// One joint off by so much to the side that it moved to.
fn aside(joint: usize, by: f64) -> impl Fn(&[f64], &[f64]) -> Vec<f64> {
    move |q, before| {
        let mut q = q.to_vec();
        q[joint] += by * (q[joint] - before[joint]).signum() * f64::from(u8::from(q != before));
        q
    }
}

#[test]
fn a_gap_is_found_from_the_order_of_the_rows() {
    let session = session(150, 1, &aside(2, -1e-4), &still);
    let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
    assert_eq!(names(&outcome), [("backlash", vec![3])]);
    let value = outcome.effects[0].coefficients[0].value;
    assert!((value - 1e-4).abs() < 1e-5, "{value}");
    let said = outcome.figures.warnings.iter().any(|w| w.contains("order of the rows"));
    assert!(said, "{:?}", outcome.figures.warnings);
}

/// A session that turns one joint after another, from where all rested on some side that
/// nobody wrote down: most rows of the last joints are before they first moved.
#[test]
fn gaps_of_joints_that_are_moved_one_after_another() {
    for (seed, rested) in [(11, [1.0, 1.0, -1.0]), (12, [-1.0, 1.0, 1.0]), (13, [-1.0; 3])] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = Truth::draw(&arm(), 1, 1, &mut rng);
        let gaps = [(1, 8e-5), (2, 1e-4), (4, 3e-4)];
        let mut sides = [1.0; 6];
        for ((joint, _), side) in gaps.iter().zip(rested) {
            sides[*joint] = side;
        }
        let home = [0.3, -1.2, 1.4, -0.9, 1.1, 0.4];
        let (mut poses, mut points, mut before) = (Vec::new(), Vec::new(), home);
        for k in 0..180 {
            let mut q = home;
            let degrees: f64 = rng.random_range(-70.0..70.0);
            q[k / 30] += degrees.to_radians();
            for j in 0..6 {
                // As files say it: six digits of a degree.
                q[j] = (q[j].to_degrees() * 1e4).round().to_radians() / 1e4;
                if k > 0 && q[j] != before[j] {
                    sides[j] = (q[j] - before[j]).signum();
                }
            }
            let mut real = q;
            gaps.iter().for_each(|(j, half)| real[*j] -= sides[*j] * half);
            points.push(truth.point(&real, 0, 0) + vector(&mut rng) * SIGMA);
            poses.push(q.to_vec());
            before = q;
        }
        let outcome = diagnosed(&arm(), &csv_of(&truth.robot, &poses, &points));
        let joints = gaps.map(|(joint, _)| joint + 1).to_vec();
        assert_eq!(names(&outcome), [("backlash", joints)], "{rested:?}: {:?}", outcome.suspected);
        assert!(outcome.figures.outliers.is_empty());
    }
}

/// A joint goes up in many steps and back in a few: of all rows only these come from the other
/// side. They are no gross errors, and what is left of the others is no sound arm.
#[test]
fn a_gap_of_a_joint_that_comes_from_one_side_nearly_always() {
    for seed in 21..24 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = Truth::draw(&arm(), 1, 1, &mut rng);
        let home = [0.3, -1.2, 1.4, -0.9, 1.1, 0.4];
        let (mut poses, mut points, mut before, mut side) = (Vec::new(), Vec::new(), home, 1.0);
        for k in 0..240 {
            let (joint, step) = (k / 40, k % 40);
            let mut q = home;
            let up = if step < 36 { step as f64 / 36.0 } else { (39 - step) as f64 / 4.0 };
            q[joint] += 2.0 * up - 1.0 + rng.random_range(-0.02..0.02);
            q = q.map(|q| (q.to_degrees() * 1e4).round().to_radians() / 1e4);
            if k > 0 && q[0] != before[0] {
                side = (q[0] - before[0]).signum();
            }
            let mut real = q;
            real[0] -= side * 4e-4;
            points.push(truth.point(&real, 0, 0) + vector(&mut rng) * SIGMA);
            poses.push(q.to_vec());
            before = q;
        }
        let outcome = diagnosed(&arm(), &csv_of(&truth.robot, &poses, &points));
        assert_eq!(names(&outcome), [("backlash", vec![1])], "{seed}: {:?}", outcome.suspected);
        let half = outcome.effects[0].coefficients[0].value;
        assert!((half - 4e-4).abs() < 2e-5, "{half}");
    }
}

#[test]
fn a_readout_that_lags_is_no_gap_of_the_wrong_sign_and_no_line() {
    let session = session(150, 2, &aside(1, 4e-4), &still);
    let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
    assert_eq!(names(&outcome), [("readout-lag", vec![2])]);
    let value = outcome.effects[0].coefficients[0].value;
    assert!((value - 4e-4).abs() < 1e-5, "{value}");
}

/// A tracker that was moved reads the joints through the same read-out.
#[test]
fn a_readout_lags_wherever_the_tracker_stands() {
    let session = session(150, 2, &aside(1, 4e-4), &still);
    let text = with(&session, "", |_| String::new());
    let data = Measurements::parse("m.csv".as_ref(), &text, &arm()).unwrap();
    let found = diagnose(&arm(), &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
    let missed = |frames| evaluate(&found.model, &data, frames).unwrap().stats.unwrap().rms_mm;
    let [as_trained, anew] = [Reregister::Nothing, Reregister::Base].map(missed);
    assert!(anew < 1.02 * as_trained, "{as_trained} {anew}");
}

/// Rows in no order: what they came from is not known, and nothing is named.
#[test]
fn rows_in_another_order_have_no_gap() {
    let mut session = session(150, 3, &aside(2, -1e-4), &still);
    session.poses.reverse();
    session.points.reverse();
    let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
    assert!(names(&outcome).iter().all(|(name, _)| *name != "backlash"), "{:?}", names(&outcome));
    // Their numbers tell.
    let outcome = diagnosed(&arm(), &with(&session, "order", |k| format!("{}", 150 - k)));
    assert_eq!(names(&outcome), [("backlash", vec![3])]);
}

#[test]
fn where_rows_are_missing_no_side_is_known() {
    let session = session(40, 4, &|q, _| q.to_vec(), &still);
    let text = with(&session, "order", |k| format!("{}", if k < 20 { k } else { k + 5 }));
    let data = Measurements::parse("m.csv".as_ref(), &text, &arm()).unwrap();
    let known = |row: &truearm_host::model::Row| row.directions.iter().any(|side| *side != 0);
    let unknown: Vec<usize> = (0..40).filter(|k| !known(&data.rows[*k])).collect();
    assert_eq!(unknown, [0, 20]);
}

/// Two days whose clocks both begin at nothing: the second is not measured among the first.
#[test]
fn a_second_day_comes_after_the_first() {
    let session = session(20, 4, &|q, _| q.to_vec(), &still);
    let text = with(&session, "time_s", |k| format!("{}", 60 * k));
    let day = || Measurements::parse("m.csv".as_ref(), &text, &arm()).unwrap();
    let both = day().joined(day(), &arm()).unwrap();
    assert_eq!(both.in_order(), (0..40).collect::<Vec<_>>());
    let first = |row: &Option<usize>| row.is_none();
    assert_eq!(
        both.before().iter().enumerate().filter(|b| first(b.1)).map(|b| b.0).collect::<Vec<_>>(),
        [0, 20]
    );
    // A clock that goes on is one session.
    let later = with(&session, "time_s", |k| format!("{}", 60 * k + 5000));
    let later = Measurements::parse("m.csv".as_ref(), &later, &arm()).unwrap();
    let both = day().joined(later, &arm()).unwrap();
    assert_eq!(both.before()[20], Some(19));
}

/// What a joint holds, N m, of an arm that nobody weighed.
fn held(q: &[f64]) -> [f64; 6] {
    let (shoulder, elbow) = (q[1], q[1] + q[2]);
    let wrist = elbow + q[3];
    let [c, b, a] = [3.0 * wrist.cos(), 25.0 * elbow.cos(), 60.0 * shoulder.cos()];
    [0.0, a + b + c, b + c, c, 0.4 * wrist.sin() * q[4].sin(), 0.0]
}

/// What joints hold, or what loads them: without gravity's direction nobody knows.
#[test]
fn torques_that_were_read_stand_in_for_masses() {
    for sign in [1.0, -1.0] {
        springs_of_read_torques(sign);
    }
}

fn springs_of_read_torques(sign: f64) {
    let bent = |q: &[f64], _: &[f64]| {
        let mut q = q.to_vec();
        q[1] -= 4e-6 * held(&q)[1];
        q
    };
    let session = session(120, 5, &bent, &still);
    let header = "torque1_nm,torque2_nm,torque3_nm,torque4_nm,torque5_nm,torque6_nm";
    let cells = |k: usize| held(&session.poses[k]).map(|t| format!("{:.4}", sign * t)).join(",");
    let outcome = diagnosed(&arm(), &with(&session, header, cells));
    assert_eq!(names(&outcome), [("joint-compliance", vec![2])]);
    let value = outcome.effects[0].coefficients[0].value;
    assert!((value - sign * 4e-6).abs() < 2e-7, "{value}");
    let said = outcome.figures.warnings.iter().any(|w| w.contains("load the joints"));
    assert_eq!(said, sign < 0.0, "{:?}", outcome.figures.warnings);
}

/// Springs that read torques showed say nothing of rows that read none.
#[test]
fn a_model_of_read_torques_refuses_rows_without() {
    let bent = |q: &[f64], _: &[f64]| {
        let mut q = q.to_vec();
        q[1] -= 4e-6 * held(&q)[1];
        q
    };
    let session = session(60, 8, &bent, &still);
    let header = "torque1_nm,torque2_nm,torque3_nm,torque4_nm,torque5_nm,torque6_nm";
    let cells = |k: usize| held(&session.poses[k]).map(|t| format!("{t:.4}")).join(",");
    let parsed = |text: &str| Measurements::parse("m.csv".as_ref(), text, &arm()).unwrap();
    let (told, silent) =
        (parsed(&with(&session, header, cells)), parsed(&with(&session, "", |_| String::new())));
    let found = |holdout| {
        diagnose(&arm(), &told, holdout, &DiagnoseOptions::default(), &|_| {}).map(|d| d.model)
    };
    let refused = found(Some(&told)).unwrap_err();
    assert!(refused.to_string().contains("rows are fitted in"), "{refused}");
    let model = found(None).unwrap();
    let left = evaluate(&model, &told, Reregister::Nothing).unwrap().stats.unwrap().rms_mm;
    assert!(left < 2.0 * SIGMA * 1e3, "{left}");
    let refused = evaluate(&model, &silent, Reregister::Nothing).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::NoTorques, "{refused}");
    let refused = found(Some(&silent)).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::NoTorques, "{refused}");
}

/// Five joints say what they hold, the sixth does not.
#[test]
fn torques_are_read_from_all_joints_or_none() {
    let session = session(30, 6, &|q, _| q.to_vec(), &still);
    let header = "torque1_nm,torque2_nm,torque3_nm,torque4_nm,torque5_nm";
    let text = with(&session, header, |_| "1,2,3,4,5".to_owned());
    let refused = Measurements::parse("m.csv".as_ref(), &text, &arm()).unwrap_err().to_string();
    assert!(refused.contains("torque6_nm"), "{refused}");
}

/// Its motors warm its links, which no column says: what measures it stands still.
#[test]
fn an_arm_that_warms_up_is_no_drift_of_what_measures() {
    let hours = |k: usize| 3.0 * k as f64 / 150.0;
    let mut session = session(150, 9, &|q, _| q.to_vec(), &still);
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let cold = session.truth.links.clone();
    for (k, q) in session.poses.iter().enumerate() {
        // Eight kelvin of aluminium.
        let grown = 1.0 + 8.0 * 2.4e-5 * (1.0 - (-hours(k) / 0.5).exp());
        for (link, cold) in session.truth.links.iter_mut().zip(&cold) {
            link.parameters.a = cold.parameters.a * grown;
            link.parameters.d = cold.parameters.d * grown;
        }
        session.points[k] = session.truth.point(q, 0, 0) + vector(&mut rng) * SIGMA;
    }
    let cell = |k: usize| format!("{:.1}", hours(k) * 3600.0);
    let outcome = diagnosed(&arm(), &with(&session, "time_s", cell));
    assert_eq!(names(&outcome), []);
    assert!(
        outcome.unnamed.iter().any(|w| w.contains("arm grows with time")),
        "{:?}",
        outcome.unnamed
    );
}

#[test]
fn a_base_that_settles_is_told_from_one_that_creeps() {
    // At one of the times that are offered, and between them.
    for (hours_to_settle, seed) in [(0.3, 7), (0.16, 14), (0.55, 15), (1.8, 16)] {
        let hours = |k: usize| 3.0 * k as f64 / 150.0;
        let settles = |k: usize| {
            Vector3::new(6e-4, -4e-4, 3e-4) * (1.0 - (-hours(k) / hours_to_settle).exp())
        };
        let session = session(150, seed, &|q, _| q.to_vec(), &settles);
        let outcome =
            diagnosed(&arm(), &with(&session, "time_s", |k| format!("{}", 3600.0 * hours(k))));
        assert_eq!(names(&outcome), [("measurement-drift", vec![])], "{hours_to_settle}");
        assert_eq!(outcome.verdict, Verdict::Explained, "{:?}", outcome.unnamed);
        let left = outcome.gap.last().unwrap().train_rms_mm;
        assert!(left < 1.05 * SIGMA * 3_f64.sqrt() * 1e3, "{hours_to_settle}: {left}");
    }
}

/// Gears of a wrist that nobody compensates turn one joint by a share of another.
#[test]
fn a_wrist_that_couples_by_a_thirtieth() {
    let coupled = |q: &[f64], _: &[f64]| {
        let mut q = q.to_vec();
        q[5] += q[4] / 30.0;
        q
    };
    let outcome =
        diagnosed(&arm(), &with(&session(80, 17, &coupled, &still), "", |_| String::new()));
    assert_eq!(names(&outcome), [("joint-coupling", vec![5, 6])]);
}

/// Poses read three times that are farther off than their readings: by what was stated that
/// is noise of the arm, and beyond it structure.
#[test]
fn what_returns_with_the_pose_is_noise_only_as_far_as_stated() {
    let mut rng = ChaCha8Rng::seed_from_u64(18);
    let truth = Truth::draw(&arm(), 1, 1, &mut rng);
    let (mut poses, mut points) = (Vec::new(), Vec::new());
    for _ in 0..60 {
        let q: Vec<f64> = (0..6).map(|_| rng.random_range(-2.4..2.4)).collect();
        let point = truth.point(&q, 0, 0) + vector(&mut rng) * (5.0 * SIGMA);
        for _ in 0..3 {
            poses.push(q.clone());
            points.push(point + vector(&mut rng) * SIGMA);
        }
    }
    let text = csv_of(&truth.robot, &poses, &points);
    let told = diagnosed(&arm(), &text);
    assert_eq!(told.verdict, Verdict::Unexplained);
    assert!(told.unnamed.iter().any(|w| w.contains("what their repeats scatter")));
    let stated = Robot { sigma: 5.0 * SIGMA, ..arm() };
    let told = diagnosed(&stated, &text);
    assert_eq!(told.verdict, Verdict::Clean, "{:?}", told.unnamed);
}

/// Without a clock the numbers of the rows stand in for it.
#[test]
fn a_drift_is_found_from_the_numbers_of_rows() {
    let creeps = |k: usize| Vector3::new(2e-4, 1e-4, -1e-4) * (k as f64 / 150.0);
    let session = session(150, 8, &|q, _| q.to_vec(), &creeps);
    let outcome = diagnosed(&arm(), &with(&session, "order", |k| k.to_string()));
    assert_eq!(names(&outcome), [("measurement-drift", vec![])]);
    assert_eq!(outcome.effects[0].coefficients[3].unit, "m/1000 rows");
}

/// About its own vertical an azimuth goes with time, about another axis an elevation: neither is
/// another thing than a drift, and less is told of it.
#[test]
fn an_instrument_that_turns_as_time_goes_is_a_drift() {
    for (seed, about) in [(31, Vector3::z()), (32, Vector3::x()), (33, Vector3::y())] {
        let mut session = session(80, seed, &|q, _| q.to_vec(), &|_| Vector3::zeros());
        for (k, point) in session.points.iter_mut().enumerate() {
            *point = Rotation3::from_scaled_axis(about * (2e-4 * k as f64 / 80.0)) * *point;
        }
        let outcome = diagnosed(&arm(), &with(&session, "time_s", |k| (30 * k).to_string()));
        assert_eq!(names(&outcome), [("measurement-drift", vec![])], "about {about}");
        assert!(outcome.described.is_empty(), "about {about}");
        assert_eq!(outcome.verdict, Verdict::Explained, "about {about}: {:?}", outcome.unnamed);
    }
}

/// Rows that one angle of a joint has together are no mistakes of as many causes.
#[test]
fn a_bump_of_a_joint_is_no_handful_of_gross_errors() {
    let bump = |q: &[f64], _: &[f64]| {
        let mut real = q.to_vec();
        if (0.75..1.0).contains(&q[2]) {
            real[2] += 1.5e-3;
        }
        real
    };
    let session = session(110, 34, &bump, &|_| Vector3::zeros());
    let bumped = session.poses.iter().filter(|q| (0.75..1.0).contains(&q[2])).count();
    assert!((4..=8).contains(&bumped), "{bumped} rows");
    let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
    assert_ne!(outcome.verdict, Verdict::Clean);
    assert!(names(&outcome).iter().all(|(name, _)| *name != "outliers"), "{:?}", names(&outcome));
}

/// Five readings of one pose that all miss are one mistake, though they are neighbours.
#[test]
fn a_pose_whose_readings_all_miss_is_a_gross_error() {
    let mut session = session(80, 35, &|q, _| q.to_vec(), &|_| Vector3::zeros());
    let mut rng = ChaCha8Rng::seed_from_u64(36);
    let (pose, point) = (session.poses[40].clone(), session.points[40]);
    let shift = Vector3::new(2e-3, -1e-3, 2e-3);
    session.points[40] += shift;
    for _ in 0..4 {
        session.poses.insert(40, pose.clone());
        session.points.insert(40, point + shift + vector(&mut rng) * SIGMA);
    }
    let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
    assert_eq!(names(&outcome), [("outliers", vec![])]);
    assert_eq!(outcome.verdict, Verdict::Explained, "{:?}", outcome.unnamed);
}

/// Where no column says when rows were measured they have the order of the file, for a base that
/// drifts as for sides: it was said to stand elsewhere from some row on.
#[test]
fn a_base_that_drifts_needs_no_clock() {
    let unmoved = |q: &[f64], _: &[f64]| q.to_vec();
    for (seed, slope) in [(70, 2e-6), (71, -3e-6)] {
        let drifts = |row: usize| Vector3::new(0.5, -1.0, 0.3) * (row as f64 * slope);
        let session = session(80, seed, &unmoved, &drifts);
        let outcome = diagnosed(&arm(), &with(&session, "", |_| String::new()));
        assert_eq!(names(&outcome), [("measurement-drift", vec![])], "{:?}", outcome.unnamed);
        let warned = |words: &str| outcome.figures.warnings.iter().any(|w| w.contains(words));
        assert!(warned("no column time_s or order"), "{:?}", outcome.figures.warnings);
        assert_eq!(outcome.verdict, Verdict::Explained, "{:?}", outcome.unnamed);
    }
}
