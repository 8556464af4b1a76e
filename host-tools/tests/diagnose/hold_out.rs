//! What is said of poses that are held out.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

/// Joints whose held-out angles the model's rows have not, as the warnings say them, where three
/// of four rows whose joint 1 stands below `fitted` are fitted, in degrees, and the fourth and
/// those from `from` on are held out.
fn not_covered(fitted: f64, from: f64) -> Option<String> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/springs/base-and-eccentricity-of-another-phase");
    let text = std::fs::read_to_string(data.join("measurements.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str, of: &dyn Fn(usize, f64) -> bool| {
        let first = |row: &str| row.split(',').next().unwrap().parse().unwrap();
        let own = rows.lines().enumerate().filter(|(k, row)| of(*k, first(row)));
        let own: Vec<&str> = std::iter::once(header).chain(own.map(|(_, row)| row)).collect();
        std::fs::write(folder.path().join(name), own.join("\n") + "\n").unwrap();
    };
    written("m.csv", &|k, q| q < fitted && k % 4 != 0);
    written("h.csv", &|k, q| q >= from || (q < fitted && q.abs() < 45.0 && k % 4 == 0));
    std::fs::copy(data.join("robot.toml"), folder.path().join("robot.toml")).unwrap();
    let out = Command::cargo_bin("truearm")
        .unwrap()
        .current_dir(folder.path())
        .args(["diagnose", "robot.toml", "m.csv", "--holdout", "h.csv", "--json"])
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let report: Value = serde_json::from_slice(&out.stdout).unwrap();
    let warnings = report["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap());
    let own: Vec<&str> = warnings.filter(|w| w.starts_with("h.csv: joint ranges not")).collect();
    assert!(own.len() <= 1, "{own:?}");
    own.first().map(|own| (*own).to_owned())
}

#[test]
fn angles_that_only_held_out_poses_have_are_said() {
    let of_joint_1 = |said: Option<String>| {
        said.is_some_and(|s| s.contains("joints 1,") || s.contains("joints 1;"))
    };
    assert!(of_joint_1(not_covered(0.0, 20.0)));
    assert!(!of_joint_1(not_covered(1e3, 1e3)));
}
