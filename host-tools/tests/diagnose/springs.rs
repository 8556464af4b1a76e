//! Springs of arms that another simulator made: the model that is written is the one that
//! was judged, and moments that nobody knows take no spring's name.

use std::path::Path;

use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};
use truearm_host::model::{Measurements, Robot};

fn outcome(name: &str) -> Outcome {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/springs").join(name);
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let read = |file: &str| Measurements::read(&folder.join(file), &robot).unwrap();
    let (data, fresh) = (read("measurements.csv"), read("fresh.csv"));
    let options = DiagnoseOptions::default();
    diagnose(&robot, &data, Some(&fresh), &options, &|_| ()).unwrap().outcome
}

/// No other names, and fitted, held-out and fresh poses agree.
fn holds(name: &str, springs: &[&str], joints: &[usize]) -> Outcome {
    let told = outcome(name);
    assert_eq!(told.verdict, Verdict::Explained, "{name}: {:?}", told.unnamed);
    for effect in told.effects.iter().chain(&told.suspected) {
        let right =
            springs.contains(&effect.name) && effect.joints.iter().all(|j| joints.contains(j));
        assert!(right, "{name}: {} {:?}", effect.name, effect.joints);
    }
    let last = told.gap.last().unwrap();
    let floor = told.noise_floor_mm;
    let nested = told.nested_rms_mm.unwrap();
    assert!(last.train_rms_mm < 1.1 * floor, "{name}: {} {floor}", last.train_rms_mm);
    assert!(nested < 1.2 * floor, "{name}: {nested} {floor}");
    let fresh = last.holdout_rms_mm.unwrap();
    assert!(fresh < 1.2 * nested, "{name}: {fresh} {nested}");
    told
}

/// The squares of a heavy arm's torques are so large a column that all others seemed to be
/// nothing beside it: the fit stopped where it began.
#[test]
fn a_heavy_arm_that_stiffens_is_fitted_to_the_end() {
    let told = holds("stiffening", &["joint-compliance", "joint-stiffening"], &[2]);
    assert!(told.effects.iter().any(|e| e.name == "joint-compliance"));
}

/// At one payload the moments' columns hold all that a spring does: curves and
/// eccentricities stood in for it.
#[test]
fn springs_of_an_unweighed_arm_at_one_payload() {
    let told = holds("unweighed", &["joint-compliance"], &[2, 4]);
    let found = told.effects.iter().chain(&told.suspected).flat_map(|e| e.joints.clone());
    let mut joints: Vec<usize> = found.collect();
    joints.sort_unstable();
    assert_eq!(joints, [2, 4]);
}
