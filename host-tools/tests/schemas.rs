//! The schemas of the reports stand in docs/schemas, and what every verb writes
//! is valid under its own.
//!
//! To write them anew: `UPDATE_SCHEMAS=1 cargo test -p truearm-host --test schemas`

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use truearm_host::report::{SeparatedAlternative, SeparationReport, schema, to_json};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn they_are_committed() {
    let folder = root().join("docs/schemas");
    let schemas = schema::all();
    for (name, text) in &schemas {
        let path = folder.join(format!("{name}.json"));
        if std::env::var_os("UPDATE_SCHEMAS").is_some() {
            fs::write(&path, text).unwrap();
        }
        let committed = fs::read_to_string(&path).unwrap_or_default();
        assert!(
            committed.replace("\r\n", "\n") == *text,
            "{name}: run UPDATE_SCHEMAS=1 cargo test -p truearm-host --test schemas"
        );
    }
    assert_eq!(fs::read_dir(folder).unwrap().count(), schemas.len(), "a schema too many");
}

/// Whether a report is valid under the schema that it names; the name.
fn valid(report: &str) -> String {
    let report: Value = serde_json::from_str(report).unwrap();
    let name = report["schema"].as_str().unwrap().to_owned();
    let schemas = schema::all();
    let (_, text) = schemas.iter().find(|(known, _)| *known == name).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(text).unwrap()).unwrap();
    let errors: Vec<String> = validator.iter_errors(&report).map(|e| e.to_string()).collect();
    assert!(errors.is_empty(), "{name}: {errors:?}");
    let mut broken = report;
    broken.as_object_mut().unwrap().remove("command");
    assert!(!validator.is_valid(&broken), "{name} requires no keys");
    name
}

/// What `diff --json` says of two blobs that are not the same.
fn changed_blobs(folder: &tempfile::TempDir) -> String {
    let run = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
        let ran = command.current_dir(folder).args(line.split(' ')).output().unwrap();
        assert!(ran.status.success(), "{line}: {}", String::from_utf8_lossy(&ran.stderr));
        String::from_utf8(ran.stdout).unwrap()
    };
    run("identify robot.toml measurements.csv --lambda 30 --out other");
    run("pack other/model.toml --out other.bin");
    let words = run("diff arm.bin other.bin");
    let text = run("diff arm.bin other.bin --json");
    let report: Value = serde_json::from_str(&text).unwrap();
    let changes = report["changes"].as_array().unwrap();
    assert!(changes.len() > 10 && report["same"] == false, "{text}");
    for change in changes {
        assert!(words.contains(change["what"].as_str().unwrap()), "{change} in {words}");
    }
    let motions = report["motions"].as_array().unwrap();
    assert_eq!(motions.len(), 2, "{text}");
    for motion in motions {
        let [largest, rms] = ["largest_mm", "rms_mm"].map(|key| motion[key].as_f64().unwrap());
        assert!(largest > rms && rms > 0.0, "{motion}");
        assert!(words.contains(&format!("by {largest:.4} mm at worst")), "{motion} in {words}");
    }
    text
}

#[test]
fn reports_are_valid() {
    let folder = tempfile::tempdir().unwrap();
    let data = root().join("tests/data/seed-table-8");
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data.join(name), folder.path().join(name)).unwrap();
    }
    let rows = fs::read_to_string(folder.path().join("measurements.csv")).unwrap();
    let measured = rows.clone();
    let commanded = (1..=6).fold(rows, |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    fs::write(folder.path().join("commanded.csv"), &commanded).unwrap();
    fs::write(folder.path().join("off.csv"), commanded).unwrap();
    // A hundredth of a micrometre off: measured again, and not the rows that are fitted.
    let again = |(i, line): (usize, &str)| format!("{line}{}\n", if i == 0 { "" } else { "00001" });
    let again: String = measured.lines().enumerate().map(again).collect();
    fs::write(folder.path().join("again.csv"), again).unwrap();
    fs::write(folder.path().join("pose.csv"), "x_mm,y_mm,z_mm\n-400,-200,300\n").unwrap();
    let limits = ["-120:120"; 6].join(",");
    let plan = format!("plan robot.toml --poses 14 --candidates 100 --out p.csv --limits {limits}");
    let arm = folder.path().join("arms/one");
    fs::create_dir_all(&arm).unwrap();
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data.join(name), arm.join(name)).unwrap();
    }
    let run = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
        let ran = command.current_dir(&folder).args(line.split(' ')).output().unwrap();
        assert!(ran.status.success(), "{line}: {}", String::from_utf8_lossy(&ran.stderr));
        String::from_utf8(ran.stdout).unwrap()
    };
    run("identify robot.toml measurements.csv --out start");
    run("gram add start/model.toml measurements.csv --out all.gram");
    let mut names: Vec<String> = [
        "fleet arms",
        "gram step start/model.toml all.gram --out state.toml",
        "import measurements.csv --out imported/measurements.csv",
        "identify robot.toml measurements.csv --validate again.csv --out .",
        "diagnose robot.toml measurements.csv",
        "evaluate model.toml measurements.csv",
        "export model.toml",
        "compare robot.toml measurements.csv",
        &plan,
        "check robot.toml measurements.csv",
        "verify model.toml commanded.csv --before off.csv --tolerance-mm 100",
        "fk model.toml measurements.csv --out fk.csv",
        "ik model.toml pose.csv --out ik.csv",
        "compensate model.toml measurements.csv --from joints --out told.csv",
        "pack model.toml --covariance --out arm.bin",
        "inspect arm.bin --robot robot.toml",
        "diff arm.bin arm.bin",
        "unpack arm.bin --out unpacked.toml",
    ]
    .map(|line| {
        let name = valid(&run(&format!("{line} --json")));
        assert!(name.contains(line.split(' ').next().unwrap()), "{line}: {name}");
        name
    })
    .to_vec();
    let changed = changed_blobs(&folder);
    assert_eq!(valid(&changed), "truearm-diff-1");
    // No shipped data has alternatives.
    names.push(valid(&to_json(&SeparationReport {
        schema: SeparationReport::SCHEMA,
        command: "plan",
        robot: "arm".to_owned(),
        data: "measurements.csv".to_owned(),
        poses: 6,
        candidates: 3000,
        alternatives: vec![SeparatedAlternative {
            effects: vec![("joint-gain", vec![2])],
            instead: "joint-compliance of joint 2 instead of base-compliance".to_owned(),
            worse_by_now: 3.5,
            worse_by_planned: 40.0,
        }],
        warnings: Vec::new(),
    })));
    names.sort();
    let mut known: Vec<_> = schema::all().iter().map(|(name, _)| (*name).to_owned()).collect();
    known.sort();
    assert_eq!(names, known);
}
