//! What is said of poses that are held out.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

/// Header and rows of a set of this folder.
fn rows_of(set: &str) -> (String, Vec<String>) {
    let text = std::fs::read_to_string(sets().join(set).join("measurements.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    (header.to_owned(), rows.lines().map(str::to_owned).collect())
}

fn sets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/springs")
}

/// The report of a diagnosis of rows of a set, h.csv held out.
fn reported(set: &str, header: &str, fitted: &[String], held: &[String]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    for (name, rows) in [("m.csv", fitted), ("h.csv", held)] {
        let text = format!("{header}\n{}\n", rows.join("\n"));
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    std::fs::copy(sets().join(set).join("robot.toml"), folder.path().join("robot.toml")).unwrap();
    let out = Command::cargo_bin("truearm")
        .unwrap()
        .current_dir(folder.path())
        .args(["diagnose", "robot.toml", "m.csv", "--holdout", "h.csv", "--json"])
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).unwrap()
}

/// Warnings on h.csv that say something.
fn warnings(report: &Value, what: &str) -> Vec<String> {
    let all = report["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap());
    all.filter(|w| w.starts_with("h.csv") && w.contains(what)).map(str::to_owned).collect()
}

/// Joints whose held-out angles the model's rows have not, as the warnings say them, where three
/// of four rows whose joint 1 stands below `fitted` are fitted, in degrees, and the fourth and
/// those from `from` on are held out.
fn not_covered(fitted: f64, from: f64) -> Option<String> {
    let set = "base-and-eccentricity-of-another-phase";
    let (header, rows) = rows_of(set);
    let of = |own: &dyn Fn(usize, f64) -> bool| -> Vec<String> {
        let first = |row: &str| row.split(',').next().unwrap().parse().unwrap();
        let own = rows.iter().enumerate().filter(|(k, row)| own(*k, first(row)));
        own.map(|(_, row)| row.clone()).collect()
    };
    let training = of(&|k, q| q < fitted && k % 4 != 0);
    let held = of(&|k, q| q >= from || (q < fitted && q.abs() < 45.0 && k % 4 == 0));
    let own = warnings(&reported(set, &header, &training, &held), "joint ranges not");
    assert!(own.len() <= 1, "{own:?}");
    own.into_iter().next()
}

/// What is said of a hold-out file of 100 rows of which those that are `wrong` are 3 mm off.
struct Judged {
    left_out: Vec<u64>,
    standing_out: Vec<u64>,
    /// The figure of the last model, and that with all rows, mm.
    rms: [f64; 2],
    said: Vec<String>,
    /// Whether the whole file is said to be missed by far more than folds are.
    is_far_off: bool,
}

fn with_wrong(wrong: impl Fn(usize) -> bool) -> Judged {
    let set = "base-and-eccentricity";
    let (header, rows) = rows_of(set);
    let place = header.split(',').position(|name| name == "z_mm").unwrap();
    let every_other = |from: usize| rows.iter().skip(from).step_by(2).cloned().collect::<Vec<_>>();
    let moved = |(k, row): (usize, String)| {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        if wrong(k + 1) {
            cells[place] = (cells[place].parse::<f64>().unwrap() + 3.0).to_string();
        }
        cells.join(",")
    };
    let held: Vec<String> = every_other(1).into_iter().enumerate().map(moved).collect();
    assert_eq!(held.len(), 100);
    let report = reported(set, &header, &every_other(0), &held);
    let of = &report["hold_out"];
    let rows = |key: &str| of[key].as_array().unwrap().iter().map(|r| r.as_u64().unwrap());
    let last = report["gap"].as_array().unwrap().last().unwrap();
    Judged {
        left_out: rows("left_out").collect(),
        standing_out: rows("standing_out").collect(),
        rms: [&last["holdout_rms_mm"], &of["all_rows_rms_mm"]].map(|x| x.as_f64().unwrap()),
        said: warnings(&report, "stand out"),
        is_far_off: !warnings(&report, "held out in folds").is_empty(),
    }
}

#[test]
fn what_a_hold_out_figure_leaves_out_is_said() {
    let right = with_wrong(|_| false);
    assert!(!right.is_far_off);
    assert!(right.left_out.is_empty() && right.standing_out.is_empty());
    assert!(right.said.is_empty(), "{:?}", right.said);
    assert_eq!(right.rms[0].to_bits(), right.rms[1].to_bits());

    let one = with_wrong(|row| row == 7);
    assert_eq!((one.left_out, one.standing_out), (vec![7], vec![]));
    assert!(one.rms[0] < 0.1 && one.rms[1] > 0.25, "{:?}", one.rms);
    let [said] = &one.said[..] else { panic!("{:?}", one.said) };
    assert!(said.contains("left out") && said.contains("rows 7; 0."), "{said}");
}

#[test]
fn wrong_rows_of_a_hold_out_file_count_and_are_named() {
    let many = with_wrong(|row| row % 7 == 0);
    assert_eq!((many.left_out.len(), many.standing_out.len()), (1, 13));
    let mut all = [many.left_out, many.standing_out].concat();
    all.sort_unstable();
    assert_eq!(all, (1..=14).map(|k| 7 * k).collect::<Vec<u64>>());
    assert!(many.rms[0] > 0.9 && many.rms[1] > many.rms[0], "{:?}", many.rms);
    let [_, said] = &many.said[..] else { panic!("{:?}", many.said) };
    assert!(said.contains("13 of 100 rows") && said.contains("count in"), "{said}");
}

/// Of rows that are all wrong alike none stands out.
#[test]
fn a_hold_out_file_that_is_wrong_as_a_whole_is_said_to_be() {
    let all = with_wrong(|_| true);
    assert!(all.is_far_off && all.said.is_empty(), "{:?}", all.said);
    assert!(all.rms[0] > 2.9, "{:?}", all.rms);
}

#[test]
fn angles_that_only_held_out_poses_have_are_said() {
    let of_joint_1 = |said: Option<String>| {
        said.is_some_and(|s| s.contains("joints 1,") || s.contains("joints 1;"))
    };
    assert!(of_joint_1(not_covered(0.0, 20.0)));
    assert!(!of_joint_1(not_covered(1e3, 1e3)));
}
