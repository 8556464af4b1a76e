//! The real UR10: a strong structure that geometry cannot explain.

use std::path::Path;

use truearm_host::diagnose::{DiagnoseOptions, Diagnosis, Verdict, diagnose};
use truearm_host::files::{Measurements, Robot};

fn series(name: &str) -> Diagnosis {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/ur10-ipa");
    let robot = Robot::read(&data.join("robot.toml")).unwrap();
    let rows = Measurements::read(&data.join(name).join("measurements.csv"), &robot).unwrap();
    diagnose(&robot, &rows, None, &DiagnoseOptions::default(), &|_| ()).unwrap()
}

fn check(found: &Diagnosis, limit: f64) {
    let report = &found.report;
    assert_eq!(report.verdict, Verdict::Unexplained, "0.05 mm of noise is not reached");
    let figure = |model: &str| {
        let row = report.gap.iter().find(|g| g.model == model).unwrap();
        row.cross_validated_rms_mm.unwrap()
    };
    assert!((0.42..0.50).contains(&figure("geometry")));
    let last = report.gap.last().unwrap();
    println!("{:?}", report.gap);
    assert!(last.cross_validated_rms_mm.unwrap() <= limit, "{last:?}");
    assert_eq!(report.effects[0].name, "joint-periodic-error");
    for joint in 1..=3 {
        let lines = report.effects.iter().filter(|e| e.joints.contains(&joint)).count();
        assert!(lines >= 3, "joint {joint}");
    }
    let flagged = report.base.outlier_rows.len() as f64;
    assert!(flagged <= 0.01 * report.base.rows as f64);
}

#[test]
fn series_b() {
    let found = series("series-b");
    check(&found, 0.20);
    for row in [533, 855, 856] {
        assert!(found.report.base.outlier_rows.contains(&row), "row {row} is a gross error");
    }
}

#[test]
fn series_c() {
    check(&series("series-c"), 0.16);
}
