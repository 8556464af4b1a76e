//! Paths through angles at which a joint's error curve is not known, and corrections that are
//! held back.

use std::path::Path as FilePath;

use truearm_host::evaluate::not_covered;
use truearm_host::files::Wanted;
use truearm_host::model::{ErrorCurve, Model, Path, Robot};
use truearm_host::paths::{CompensateOptions, Row, compensate};
use truearm_host::report::CompensateReport;
use truearm_simulate::robots;

/// Six joints; the curve of the second is not known from 90 to 101.25 degrees.
fn model() -> Model {
    let robot = Robot::parse(FilePath::new("robot.toml"), robots::ALL[0]).unwrap();
    let mut model = Model::nominal(robot);
    model.covered = vec![Some([-2.6, 2.6]); 6];
    model.corrections[2].a = 4e-4;
    let (curve, _) = ErrorCurve::of_function(1, 32, 1e-5, |q| 2e-4 * q.sin()).unwrap();
    model.curves = vec![curve.with_gaps(3e-4, &[8]).unwrap()];
    model
}

fn path(model: &Model, second: &[f64]) -> Path {
    let head = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg";
    let rows: String = second.iter().map(|q| format!("10,{q},-60,20,50,0\n")).collect();
    let text = format!("{head}\n{rows}");
    Path::parse(FilePath::new("path.csv"), &text, &model.robot, Wanted::Joints).unwrap()
}

fn covered(model: &Model, path: &Path, extrapolate: bool) -> Vec<bool> {
    let options = CompensateOptions { extrapolate, ..CompensateOptions::default() };
    let found = compensate(model, path, &options).unwrap();
    let row = |row: &Row| match row {
        Row::Corrected { covered, command, joints, .. } => {
            // What nobody has measured is not invented.
            assert_eq!(command != joints, *covered || extrapolate);
            *covered
        }
        Row::NotReached(_) => panic!("joints are always reached"),
    };
    found.rows.iter().map(row).collect()
}

#[test]
fn a_gap_is_not_covered_in_a_path_and_in_a_file() {
    let model = model();
    let through = path(&model, &[89.0, 91.0, 100.0, 102.0, -95.0]);
    for extrapolate in [false, true] {
        let found = covered(&model, &through, extrapolate);
        assert_eq!(found, [true, false, false, true, true], "{extrapolate}");
    }
    assert_eq!(not_covered(&model, &through.data), [2]);
    let beside = path(&model, &[89.0, 102.0, -95.0]);
    assert_eq!(not_covered(&model, &beside.data), [0; 0]);
    // Where a curve is known all over only the ranges count.
    let mut known = model.clone();
    let (curve, _) = ErrorCurve::of_function(1, 32, 1e-5, |q| 2e-4 * q.sin()).unwrap();
    known.curves = vec![curve];
    assert_eq!(covered(&known, &through, false), [true; 5]);
}

/// A zero off by a fifth of a radian is more than a controller corrects, a milliradian is not.
#[test]
fn what_is_held_back_so_far_that_most_stays_is_told() {
    for (zero, told) in [(0.2, 2), (9e-4, 0)] {
        let mut model = model();
        model.corrections[1].theta = zero;
        let path = path(&model, &[20.0, 40.0]);
        let options = CompensateOptions::default();
        let found = compensate(&model, &path, &options).unwrap();
        let files = ["model.toml", "out.csv"].map(str::to_owned);
        let report = CompensateReport::new(files, &model, &path, &found, &options, Vec::new());
        assert_eq!(report.mostly_left.len(), told, "{zero}: {:?}", report.left);
        assert!(report.mostly_left.iter().all(|row| row.left_mm > 0.1));
    }
}
