//! The real UR10: joints that err by smooth curves, and springs and gear lines
//! beside them.

use std::path::Path;

use truearm::blob::Blob;
use truearm::effects::MAX_TERMS;
use truearm_host::blob::pack;
use truearm_host::diagnose::{DiagnoseOptions, Diagnosis, diagnose};
use truearm_host::model::{CURVE, JointTables, Measurements, ModelTerm, Robot};

fn series(name: &str) -> Diagnosis {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/ur10-ipa");
    let robot = Robot::read(&data.join("robot.toml")).unwrap();
    let rows = Measurements::read(&data.join(name).join("measurements.csv"), &robot).unwrap();
    diagnose(&robot, &rows, None, &DiagnoseOptions::default(), &|_| ()).unwrap()
}

fn check(found: &Diagnosis, limit: f64) {
    let report = &found.outcome;
    let figure = |model: &str| {
        let row = report.gap.iter().find(|g| g.model == model).unwrap();
        row.cross_validated_rms_mm.unwrap()
    };
    assert!((0.42..0.50).contains(&figure("geometry")));
    let last = report.gap.last().unwrap();
    let nested = report.nested_rms_mm.unwrap();
    println!("nested {nested:.4} mm, {:?}", report.gap);
    assert!(nested <= limit && last.cross_validated_rms_mm.unwrap() <= limit, "{nested} {last:?}");
    assert_eq!(
        (report.effects[0].name, report.effects[0].joints.clone()),
        (CURVE, vec![1, 2, 3, 4, 5])
    );
    let compliance = report.effects.iter().find(|e| e.name == "joint-compliance").unwrap();
    assert_eq!(compliance.joints, [3]);
    assert!((6e-6..12e-6).contains(&compliance.coefficients[0].value), "{compliance:?}");
    assert!((0.8..1.6).contains(&report.noise_scale), "{}", report.noise_scale);
    let flagged = report.figures.outlier_rows.len() as f64;
    assert!(flagged <= 0.01 * report.figures.rows as f64);
    // By default what is found can be flashed.
    let of_arm = |term: &&ModelTerm| matches!(term, ModelTerm::Arm(_));
    let flashed = found.model.terms.iter().filter(of_arm).count();
    assert!(flashed <= MAX_TERMS && found.model.curves.len() == 5, "{flashed}");
    let bytes = pack(&found.model, None).unwrap();
    assert!(bytes.len() <= 4096, "{}", bytes.len());
    let blob = Blob::check(&bytes).unwrap().parameters::<f64, 6>().unwrap();
    let stated = report.figures.cross_validated.unwrap().rms_mm;
    assert!((blob.rms_after * 1e3 - stated).abs() < 1e-6);
}

/// The curves belong to the arm: where both series went, they agree.
#[test]
fn both_series_find_the_same_arm() {
    let (b, c) = (series("series-b"), series("series-c"));
    check(&b, 0.095);
    check(&c, 0.085);
    for row in [533, 855, 856] {
        assert!(b.outcome.figures.outlier_rows.contains(&row), "row {row} is a gross error");
    }
    let covered = |found: &Diagnosis, joint: usize| found.model.covered[joint].unwrap();
    for (joint, least) in [(2, 0.9), (3, 0.8)] {
        let [first, second] = [covered(&b, joint), covered(&c, joint)];
        let (low, high) = (first[0].max(second[0]), first[1].min(second[1]));
        let tables = [&b, &c].map(|found| JointTables::new(&found.model.curves));
        let values = tables.map(|t| {
            let at = |k: usize| t.value(joint as u8, low + (high - low) * k as f64 / 400.0);
            let all: Vec<f64> = (0..=400).map(at).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            all.into_iter().map(|x| x - mean).collect::<Vec<_>>()
        });
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let [a, b] = [&values[0], &values[1]];
        let correlation = dot(a, b) / (dot(a, a) * dot(b, b)).sqrt();
        println!("joint {}, {low:.2} to {high:.2} rad: correlation {correlation:.3}", joint + 1);
        assert!(correlation > least, "joint {}: {correlation}", joint + 1);
    }
}
