//! Rows that contradict the others, too many for gross errors.

mod simulate;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use simulate::{Truth, UR10_LIKE, parse, robot};
use truearm_host::Error;
use truearm_host::diagnose::{DiagnoseOptions, Verdict, diagnose};
use truearm_host::files::Measurements;
use truearm_host::identify::{Options, identify};

/// An encoder that slips by half a degree before the last rows.
fn slipped(truth: &Truth, rows: usize, last: usize, joint: usize, seed: u64) -> Measurements {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let text = truth.measure(rows, 2e-5, &mut rng);
    let line = |(i, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if i > rows - last {
            cells[joint] = format!("{:.5}", cells[joint].parse::<f64>().unwrap() + 0.5);
        }
        cells.join(",") + "\n"
    };
    parse(&truth.robot, &text.lines().enumerate().map(line).collect::<String>())
}

#[test]
fn a_slip_is_shown_and_not_refused() {
    for (seed, last, joint) in [(1, 17, 1), (2, 20, 2), (3, 26, 0)] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = Truth::draw(&robot(UR10_LIKE), 1, 1, &mut rng);
        let data = slipped(&truth, 64, last, joint, seed);
        let options = Options::default();
        let refused = identify(&truth.robot, &data, &options, &|_, _| ()).unwrap_err();
        assert!(matches!(refused, Error::Contradiction { of: 64, .. }), "{refused}");
        assert!(refused.help().contains("truearm diagnose"));

        let options = DiagnoseOptions::default();
        let report = diagnose(&truth.robot, &data, None, &options, &|_| ()).unwrap().report;
        assert_eq!(report.verdict, Verdict::Unexplained);
        assert!(report.effects.is_empty(), "{:?}", report.effects);
        let rows: Vec<usize> = (64 - last + 1..=64).collect();
        assert_eq!(report.base.outlier_rows, rows);
        let told = format!("{last} of 64 rows contradict the others: {} to 64", rows[0]);
        assert_eq!(report.whereabouts[0], told);
        let order = |w: &String| w.contains("goes with the order of the rows");
        assert!(report.whereabouts.iter().any(order), "{:?}", report.whereabouts);
    }
}

/// Where neither half is the majority, no row is called wrong.
#[test]
fn halves_that_contradict_are_unexplained() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let truth = Truth::draw(&robot(UR10_LIKE), 1, 1, &mut rng);
    let data = slipped(&truth, 64, 32, 1, 4);
    let options = DiagnoseOptions::default();
    let report = diagnose(&truth.robot, &data, None, &options, &|_| ()).unwrap().report;
    assert_eq!(report.verdict, Verdict::Unexplained);
    assert!(!report.whereabouts.is_empty());
}
