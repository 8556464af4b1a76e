//! Rows that contradict the others, too many for gross errors.

use crate::simulated::{Truth, UR10_LIKE, parse, robot};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};

/// The report of rows of which some were changed: cells of each line, the first is the heading.
fn changed(rows: usize, seed: u64, change: impl Fn(usize, &mut Vec<String>)) -> Outcome {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let truth = Truth::draw(&robot(UR10_LIKE), 1, 1, &mut rng);
    let text = truth.measure(rows, 2e-5, &mut ChaCha8Rng::seed_from_u64(seed));
    let line = |(i, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        change(i, &mut cells);
        cells.join(",") + "\n"
    };
    let data = parse(&truth.robot, &text.lines().enumerate().map(line).collect::<String>());
    let options = DiagnoseOptions::default();
    diagnose(&truth.robot, &data, None, &options, &|_| ()).unwrap().outcome
}

fn plus(cell: &mut String, by: f64) {
    *cell = format!("{:.5}", cell.parse::<f64>().unwrap() + by);
}

/// The report of 64 rows, in the last of which an encoder has slipped (degrees).
fn slipped(last: usize, joint: usize, slip: f64, seed: u64) -> Outcome {
    changed(64, seed, |row, cells| {
        if row > 64 - last {
            plus(&mut cells[joint], slip);
        }
    })
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

/// Up to a quarter of the rows may be off each by its own: they are gross errors by number...
#[test]
fn scattered_rows_are_gross_errors() {
    for (share, seed) in [(0.1, 20), (0.15, 21), (0.22, 22)] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let shifts: Vec<Option<[f64; 3]>> = (0..100)
            .map(|_| {
                let wrong = rng.random_bool(share);
                wrong.then(|| {
                    [0; 3].map(|_| rng.random_range(0.4..3.0) * [-1.0, 1.0][rng.random_range(0..2)])
                })
            })
            .collect();
        let report = changed(100, seed, |row, cells| {
            let shift = row.checked_sub(1).and_then(|row| shifts[row]);
            for (cell, by) in cells[6..9].iter_mut().zip(shift.into_iter().flatten()) {
                plus(cell, by);
            }
        });
        let wrong: Vec<usize> =
            (0..100).filter(|row| shifts[*row].is_some()).map(|row| row + 1).collect();
        assert_eq!(report.figures.outlier_rows, wrong);
        assert_eq!(report.verdict, Verdict::Explained, "{:?}", report.whereabouts);
        assert_eq!(report.effects[0].name, "outliers");
    }
}

/// ...and structure where something that was recorded has them together.
#[test]
fn rows_off_together_are_structure() {
    // A block of rows, each off by its own; those where joint 3 is bent.
    for (seed, where_) in [(30, "rows"), (31, "joint")] {
        let report = changed(100, seed, |row, cells| {
            let own = match where_ {
                "rows" => (40..55).contains(&row),
                _ => row > 0 && cells[2].parse::<f64>().unwrap() > 100.0,
            };
            if own {
                let mut rng = ChaCha8Rng::seed_from_u64(row as u64);
                cells[6..9].iter_mut().for_each(|cell| plus(cell, rng.random_range(-2.0..2.0)));
            }
        });
        let count = report.figures.outlier_rows.len();
        assert!((9..=25).contains(&count), "{count} rows");
        assert_eq!(report.verdict, Verdict::Unexplained, "{where_}");
        assert!(report.effects.iter().all(|e| e.name != "outliers"));
        assert!(report.whereabouts[0].contains("contradict the others"));
    }
}
