//! Springs of arms that another simulator made: the model that is written is the one that
//! was judged, and moments that nobody knows take no spring's name.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use truearm_host::diagnose::{DiagnoseOptions, Doubt, Outcome, Verdict, diagnose};
use truearm_host::model::{Measurements, Placement, Robot};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/springs").join(name)
}

fn stated(name: &str) -> Robot {
    Robot::read(&folder(name).join("robot.toml")).unwrap()
}

fn outcome(name: &str, robot: &Robot) -> Outcome {
    let folder = folder(name);
    let read = |file: &str| Measurements::read(&folder.join(file), robot).unwrap();
    let (data, fresh) = (read("measurements.csv"), read("fresh.csv"));
    let options = DiagnoseOptions::default();
    diagnose(robot, &data, Some(&fresh), &options, &|_| ()).unwrap().outcome
}

/// No other names, and fitted, held-out and fresh poses agree.
fn holds(name: &str, robot: &Robot, springs: &[&str], joints: &[usize]) -> Outcome {
    let told = outcome(name, robot);
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
    let told =
        holds("stiffening", &stated("stiffening"), &["joint-compliance", "joint-stiffening"], &[2]);
    assert!(told.effects.iter().any(|e| e.name == "joint-compliance"));
}

/// Beside a spring that stiffens in proportion what is left of two slopes is the sign of the
/// load: a gap of gravity's side was named at a probability of 1.
#[test]
fn two_slopes_of_a_spring_are_no_gap() {
    let robot = stated("two-slopes");
    let data = Measurements::read(&folder("two-slopes").join("measurements.csv"), &robot).unwrap();
    let told = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap().outcome;
    let names: Vec<_> = told.effects.iter().map(|e| (e.name, &e.joints[..])).collect();
    let expected: [(_, &[usize]); 2] = [("joint-compliance", &[3]), ("joint-stiffening", &[3])];
    assert_eq!(names, expected);
    let mut gaps = told.suspected.iter().filter(|e| e.name == "backlash").peekable();
    assert!(gaps.peek().is_some(), "no gap is suspected: nothing is tested");
    assert!(gaps.all(|gap| gap.doubt == Some(Doubt::Knee)), "{:?}", told.suspected);
}

/// At one payload the moments' columns hold all that a spring does: curves and
/// eccentricities stood in for it.
#[test]
fn springs_of_an_unweighed_arm_at_one_payload() {
    springs_of_joints_2_and_4(&stated("unweighed"));
}

/// It stands upright, as nearly all do; so much is said.
#[test]
fn springs_of_an_arm_of_which_nothing_but_geometry_is_stated() {
    let robot = Robot { gravity: None, ..stated("unweighed") };
    let told = springs_of_joints_2_and_4(&robot);
    let said = |w: &String| w.contains("no gravity_m_s2") && w.contains("stands upright");
    assert!(told.figures.warnings.iter().any(said), "{:?}", told.figures.warnings);
}

/// It hangs, and springs would give way upwards if it stood.
#[test]
fn springs_of_an_arm_that_hangs() {
    let half = Vector3::new(std::f64::consts::PI, 0.0, 0.0);
    let base = Placement { rpy: half, ..Placement::default() };
    // Upright in these coordinates, on its head in those of [base].
    let robot = Robot { gravity: None, base, ..stated("unweighed") };
    let told = springs_of_joints_2_and_4(&robot);
    let said = |w: &String| w.contains("no gravity_m_s2") && w.contains("hangs");
    assert!(told.figures.warnings.iter().any(said), "{:?}", told.figures.warnings);
}

fn springs_of_joints_2_and_4(robot: &Robot) -> Outcome {
    let told = holds("unweighed", robot, &["joint-compliance"], &[2, 4]);
    let found = told.effects.iter().chain(&told.suspected).flat_map(|e| e.joints.clone());
    let mut joints: Vec<usize> = found.collect();
    joints.sort_unstable();
    assert_eq!(joints, [2, 4]);
    told
}

/// A base that gives way and an eccentric encoder of a joint that gravity loads, masses unknown:
/// moments that bend a spring of that joint would do what both do. That spring had P = 1 while
/// models without it paid for what they explain less, and not the spring for its moments.
#[test]
fn moments_of_a_spring_stand_for_no_base() {
    for name in [
        "base-and-eccentricity",
        "base-and-eccentricity-of-another-phase",
        "base-and-eccentricity-offset-wrist",
    ] {
        let robot = stated(name);
        let data = Measurements::read(&folder(name).join("measurements.csv"), &robot).unwrap();
        let options = DiagnoseOptions::default();
        let told = diagnose(&robot, &data, None, &options, &|_| ()).unwrap().outcome;
        let springs = ["joint-compliance", "joint-stiffening"];
        let wrong: Vec<_> = told.effects.iter().filter(|e| springs.contains(&e.name)).collect();
        assert!(wrong.is_empty(), "{name}: {wrong:?}");
    }
}

/// Gravity pulls at the arm as it stands and not as it is drawn: where a zero was set does not
/// change what its springs do.
#[test]
fn zeros_that_are_degrees_off_change_no_spring() {
    let case =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases/case_015");
    let held_out = |off: f64| {
        let mut robot = Robot::read(&case.join("robot.toml")).unwrap();
        robot.joints[1].link.parameters.theta += off;
        robot.joints[2].link.parameters.theta -= off;
        let read = |file: &str| Measurements::read(&case.join(file), &robot).unwrap();
        let (data, fresh) = (read("measurements.csv"), read("holdout.csv"));
        let options = DiagnoseOptions::default();
        let told = diagnose(&robot, &data, Some(&fresh), &options, &|_| ()).unwrap().outcome;
        let names: Vec<_> = told.effects.iter().map(|e| (e.name, e.joints.clone())).collect();
        (names, told.gap.last().unwrap().holdout_rms_mm.unwrap())
    };
    let (names, drawn) = held_out(0.0);
    let (moved_names, moved) = held_out(0.1);
    assert!(names.iter().any(|(name, joints)| *name == "joint-compliance" && joints == &[2, 3]));
    assert_eq!(names, moved_names);
    assert!((moved / drawn - 1.0).abs() < 2e-3, "{drawn} {moved} mm");
}
