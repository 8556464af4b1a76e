//! Instruments that err, and arms that scatter, by another simulator: nothing of it is an effect of
//! the arm.

use std::path::Path;

use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};
use truearm_host::effects::OUTLIERS;
use truearm_host::model::{Measurements, Robot};

/// What is said of a cell.
fn told(cell: &str) -> Outcome {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/other-cells").join(cell);
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let read = |file: &str| Measurements::read(&folder.join(file), &robot).unwrap();
    let (data, fresh) = (read("measurements.csv"), read("fresh.csv"));
    let options = DiagnoseOptions::default();
    diagnose(&robot, &data, Some(&fresh), &options, &|_| ()).unwrap().outcome
}

/// The same: nothing of its arm.
fn unnamed(cell: &str) -> Outcome {
    let told = told(cell);
    let named = told.effects.iter().chain(&told.suspected).filter(|e| e.name != OUTLIERS);
    let named: Vec<_> = named.map(|e| (e.name, &e.joints, e.probability)).collect();
    assert!(named.is_empty(), "{cell}: {named:?}");
    told
}

/// The parts that err and with what, each at a probability of 0.9 and more.
fn described(cell: &str) -> Vec<(&'static str, &'static str)> {
    let told = unnamed(cell);
    assert_eq!(told.verdict, Verdict::Unexplained, "{cell}");
    assert!(told.described.iter().all(|d| d.probability > 0.9), "{cell}: {:?}", told.unnamed);
    told.described.iter().map(|d| (d.part, d.with)).collect()
}

fn says_that_the_lens_is_wrong(told: &Outcome) -> bool {
    told.figures.warnings.iter().any(|w| w.contains("do not fit the images"))
}

/// A spring and an eccentricity of joint 2 at P > 0.98, and a scatter of it.
#[test]
fn a_plane_that_is_not_flat() {
    let mut found = described("bowed-plane");
    found.sort_unstable();
    assert_eq!(found, [("surface", "x"), ("surface", "y")]);
}

/// Three targets on a flange whose joints come to rest off by 40 and 60 urad: what moves one
/// moves all. Ten lines of three joints and a curve were named, and a read-out's lag beside
/// six sentences.
#[test]
fn targets_of_one_pose_move_together() {
    for cell in ["three-targets", "three-targets-in-many-poses"] {
        let told = unnamed(cell);
        assert_eq!((told.verdict, &told.unnamed[..]), (Verdict::Clean, &[][..]), "{cell}");
    }
}

/// Joint 6 was said to go with the order of the rows, by 5 mrad.
#[test]
fn wires_that_warm_up() {
    assert_eq!(described("lengths-drift"), [("length", "order")]);
}

/// The base was said to shift as joint 3 goes.
#[test]
fn a_wire_of_another_scale() {
    assert_eq!(described("one-scale"), [("length", "length")]);
}

/// A line of joint 3 of 278 cycles a turn at P > 0.99: corners of an image counted each by itself.
#[test]
fn what_an_arm_scatters_by_is_one_for_all_corners_of_an_image() {
    let told = unnamed("scatter-in-images");
    assert_eq!(told.verdict, Verdict::Clean, "{:?}", told.unnamed);
    // Its constants fit: they would take up a part of the scatter.
    assert!(!says_that_the_lens_is_wrong(&told));
}

/// Before anything is named other constants of the cameras fit better, as a spring looks like them.
#[test]
fn a_spring_is_no_lens() {
    let told = told("spring-before-cameras");
    let named: Vec<_> = told.effects.iter().map(|e| (e.name, &e.joints[..])).collect();
    assert_eq!(named, [("joint-compliance", &[2][..])]);
    assert!(told.suspected.is_empty() && told.verdict == Verdict::Explained);
    assert!(!says_that_the_lens_is_wrong(&told));
}

/// An eccentricity of joint 4 at P > 0.99.
#[test]
fn a_lens_that_was_stated_wrong_is_found() {
    let told = unnamed("wrong-lens");
    assert_eq!(told.verdict, Verdict::Clean, "{:?}", told.unnamed);
    assert!(says_that_the_lens_is_wrong(&told), "{:?}", told.figures.warnings);
    assert!((0.8..1.2).contains(&told.noise_scale), "{}", told.noise_scale);
}
