//! Names must not hang on a sigma that nobody knows: the shipped sets with half
//! and with twice the stated noise.

use std::collections::BTreeSet;
use std::path::Path;

use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::model::{Measurements, Robot};

type Names = BTreeSet<(String, Vec<usize>)>;

/// Names, the noise over the stated sigma, and whether structure without a name
/// is left.
fn named(folder: &Path, factor: f64) -> (Names, f64, bool) {
    let mut robot = Robot::read(&folder.join("robot.toml")).unwrap();
    robot.sigma *= factor;
    let data = Measurements::read(&folder.join("measurements.csv"), &robot).unwrap();
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
    let report = found.outcome;
    assert!(report.effects.iter().all(|e| e.probability >= 0.9));
    let names = report.effects.iter().map(|e| (e.name.to_owned(), e.joints.clone())).collect();
    (names, report.noise_scale, !report.unnamed.is_empty())
}

#[test]
fn names_do_not_hang_on_the_stated_sigma() {
    let sets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases");
    for (case, expected, nameless) in [
        ("case_004", vec![], true),
        ("case_005", vec![("tool-remount", vec![])], false),
        ("case_009", vec![("thermal-expansion", vec![])], false),
        ("case_014", vec![], false),
        ("case_016", vec![("backlash", vec![4])], false),
    ] {
        let expected: Names = expected.into_iter().map(|(n, j)| (n.to_owned(), j)).collect();
        for factor in [0.5, 2.0] {
            let (names, scale, left) = named(&sets.join(case), factor);
            println!("{case} x {factor}: {names:?}, noise {scale:.3} times the stated one");
            assert_eq!((&names, left), (&expected, nameless), "{case} x {factor}");
            assert!((scale * factor - 1.0).abs() < 0.15, "{case} x {factor}: {scale}");
        }
    }
}
