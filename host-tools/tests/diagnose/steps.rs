//! A zero that is another from some row on, beside something else without a name: each is
//! described, and nothing that imitates half of the step gets a name.

use std::path::Path;

use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::model::{Measurements, Robot};

/// Names and descriptions of a set of `tests/data/steps`.
fn said(set: &str) -> (Vec<&'static str>, Vec<String>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/steps").join(set);
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let data = Measurements::read(&folder.join("measurements.csv"), &robot).unwrap();
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
    let names = found.outcome.effects.iter().map(|e| e.name).collect();
    (names, found.outcome.unnamed)
}

#[test]
fn what_comes_and_goes_is_seen_beside_a_step() {
    let sets: [(&str, &[&str]); 2] = [
        (
            "scara",
            &[
                "the zero of joint 2 is another from row 2",
                "joint 2 is off as the angle of joint 1 goes",
                "the target moves on the flange as the angle of joint 1 goes",
            ],
        ),
        (
            "rail",
            &[
                "the zero of joint 2 is another from row 3",
                "joint 3 is off as the angle of joint 2 goes",
            ],
        ),
    ];
    for (set, expected) in sets {
        let (names, unnamed) = said(set);
        assert!(names.is_empty(), "{set}: {names:?}");
        for words in expected {
            assert!(unnamed.iter().any(|said| said.starts_with(words)), "{set}: {unnamed:?}");
        }
    }
}
