//! Poses about one point: how the base is turned is told by what the arm errs by alone.

use std::path::Path;

use truearm_host::diagnose::{DiagnoseOptions, Verdict, diagnose};
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Measurements, Robot};

/// The base had been turned by chance, and fits ended there: 0.57 mm and an instrument whose
/// elevation errs in place of 0.036 mm of noise, and 150 mm off in other poses.
#[test]
fn poses_about_one_point_find_their_base() {
    for (set, off) in [("rail", 1.0), ("medium", 0.2)] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/one-point").join(set);
        let robot = Robot::read(&folder.join("robot.toml")).unwrap();
        let read = |name| Measurements::read(&folder.join(name), &robot).unwrap();
        let (data, fresh) = (read("measurements.csv"), read("fresh.csv"));
        let mut wrong = data.clone();
        wrong.rows[17].measured[1] += 0.5;
        for (data, gross) in [(&data, 0), (&wrong, 1)] {
            let found = identify(&robot, data, &Options::default(), &|_, _| ()).unwrap();
            let left = found.figures.identified.unwrap().rms_mm;
            assert!(left < 0.05, "{set}: {left} mm");
            assert_eq!(found.figures.outlier_rows.len(), gross, "{set}");
        }
        let options = DiagnoseOptions::default();
        let found = diagnose(&robot, &data, Some(&fresh), &options, &|_| ()).unwrap();
        let outcome = found.outcome;
        assert_eq!(outcome.verdict, Verdict::Clean, "{set}: {:?}", outcome.unnamed);
        let held_out = outcome.gap.last().and_then(|row| row.holdout_rms_mm).unwrap();
        assert!(held_out < off, "{set}: {held_out} mm");
    }
}
