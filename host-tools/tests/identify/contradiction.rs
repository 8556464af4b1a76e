//! Rows that contradict the others, too many for gross errors.

use crate::simulated::{Truth, UR10_LIKE, parse, robot};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};

/// The report of 64 rows, in the last of which an encoder has slipped (degrees).
fn slipped(last: usize, joint: usize, slip: f64, seed: u64) -> Outcome {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let truth = Truth::draw(&robot(UR10_LIKE), 1, 1, &mut rng);
    let text = truth.measure(64, 2e-5, &mut ChaCha8Rng::seed_from_u64(seed));
    let line = |(i, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if i > 64 - last {
            cells[joint] = format!("{:.5}", cells[joint].parse::<f64>().unwrap() + slip);
        }
        cells.join(",") + "\n"
    };
    let data = parse(&truth.robot, &text.lines().enumerate().map(line).collect::<String>());
    let options = DiagnoseOptions::default();
    diagnose(&truth.robot, &data, None, &options, &|_| ()).unwrap().outcome
}

/// 17 of 64 rows: more than can be gross errors, and no reason to refuse.
#[test]
fn contradicting_rows_are_shown_and_not_refused() {
    let report = slipped(17, 3, 0.5, 4);
    assert_eq!(report.verdict, Verdict::Unexplained);
    assert!(report.effects.is_empty(), "{:?}", report.effects);
    assert_eq!(report.figures.outlier_rows, (48..=64).collect::<Vec<_>>());
    assert_eq!(report.whereabouts[0], "17 of 64 rows contradict the others: 48 to 64");
    let says = &report.whereabouts[1];
    assert!(says.starts_with("there joint 4 is as if shifted by -0.49"), "{says}");
}

/// Where the fit spreads a slip over all rows, or half of them slipped, the
/// step still shows from which row on.
#[test]
fn a_slip_is_placed() {
    for (last, joint, slip, seed) in
        [(17, 1, 0.5, 1), (20, 2, 0.1, 2), (26, 0, 0.05, 3), (17, 4, 0.1, 5), (32, 1, 0.2, 6)]
    {
        let report = slipped(last, joint, slip, seed);
        assert_eq!(report.verdict, Verdict::Unexplained);
        assert!(report.effects.is_empty(), "{:?}", report.effects);
        let start = format!("from row {} on joint {} is as if", 64 - last + 1, joint + 1);
        assert!(
            report.whereabouts.iter().any(|w| w.starts_with(&start)),
            "{:?}",
            report.whereabouts
        );
    }
}
