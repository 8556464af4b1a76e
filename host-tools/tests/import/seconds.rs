//! From a file as it comes to a verdict, with the program: for the table in docs/results.md.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::published::ROBOT;
use crate::tables::shapes;

/// Asserts that every way ends in a verdict, and prints what each took.
#[test]
#[ignore = "prints times: cargo test -p truearm-host --test import seconds -- --ignored --nocapture"]
fn seconds_from_a_file_to_a_verdict() {
    for (name, bytes) in shapes() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path(name), bytes).unwrap();
        fs::write(path("robot.toml"), ROBOT).unwrap();
        let steps: [&[&str]; 3] = [
            &["import", name, "--robot", "robot.toml", "--out", "measurements.csv"],
            &["check", "robot.toml", "measurements.csv"],
            &["diagnose", "robot.toml", "measurements.csv", "--out", "out"],
        ];
        let seconds = steps.map(|step| seconds(folder.path(), step));
        assert!(path("out/report.json").exists(), "{name}");
        let [import, check, diagnose] = seconds.map(|s| format!("{s:.3}"));
        println!("| {name} | {import} | {check} | {diagnose} |");
    }
}

fn seconds(folder: &Path, step: &[&str]) -> f64 {
    let start = Instant::now();
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    let output = command.args(step).current_dir(folder).output().unwrap();
    // 4: too few points to say that nothing is missing.
    assert!(matches!(output.status.code(), Some(0 | 4)), "{step:?}: {output:?}");
    start.elapsed().as_secs_f64()
}
