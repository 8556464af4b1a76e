//! Arms of other sizes than those that chose the limits, by another simulator.

use std::path::Path;

use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};
use truearm_host::model::{Measurements, Robot};

/// One name at these joints and no other; other poses are missed by little more than by a fit
/// that was told the truth, which misses them by `attainable`, mm.
fn named(arm: &str, name: &str, joints: &[usize], attainable: f64) -> Outcome {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/other-arms").join(arm);
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let read = |file: &str| Measurements::read(&folder.join(file), &robot).unwrap();
    let (data, fresh) = (read("measurements.csv"), read("fresh.csv"));
    let options = DiagnoseOptions::default();
    let told = diagnose(&robot, &data, Some(&fresh), &options, &|_| ()).unwrap().outcome;
    assert_eq!(told.verdict, Verdict::Explained, "{arm}: {:?}", told.unnamed);
    let found: Vec<_> = told.effects.iter().flat_map(|e| e.joints.iter().copied()).collect();
    assert_eq!(found, joints, "{arm}");
    assert!(!told.effects.is_empty() && told.effects.iter().all(|e| e.name == name), "{arm}");
    assert!(told.suspected.is_empty(), "{arm}");
    let missed = told.gap.last().unwrap().holdout_rms_mm.unwrap();
    assert!(missed < 1.1 * attainable, "{arm}: {missed} mm, {attainable}");
    told
}

/// Soft springs are refused where they would give way by much, and here they give way by little:
/// lateral compliance stood in for one at 1e-2 rad/Nm, and nine rows were flagged for another.
#[test]
fn a_small_arm_has_soft_springs() {
    named("small-spring", "joint-compliance", &[2, 5], 0.0515);
}

/// Less friction than a step of 1/64 N m: rows were on the wrong side of the gap.
#[test]
fn a_small_arm_has_little_friction() {
    let told = named("small-play", "backlash", &[6], 0.0304);
    let friction = told.effects[0].coefficients[0].friction_nm.unwrap();
    assert!((friction - 0.0084).abs() < 0.002, "{friction}");
}

/// A row is nearer to where the target was in the series before by noise: "the target sits
/// elsewhere from row 36 on" stood in for the series that begins at row 37.
#[test]
fn a_remount_is_no_step_a_row_beside_it() {
    named("remount", "tool-remount", &[], 0.1501);
}

/// A temperature that only rises goes with time: the name was only suspected.
#[test]
fn what_grows_with_the_temperature_is_not_said_to_grow_with_time() {
    let told = named("growth", "thermal-expansion", &[], 0.0325);
    assert!(told.effects[0].probability > 0.95, "{:?}", told.effects[0].probability);
}

/// With the flange in one orientation a target that moves on it is a drift, nearly: what all
/// such neighbours shared was named by none.
#[test]
fn a_drift_over_poses_in_one_orientation_is_named() {
    named("drift", "measurement-drift", &[], 0.0341);
}
