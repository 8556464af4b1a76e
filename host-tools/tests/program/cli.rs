//! The program as its user meets it: real data in, figures and files out, and
//! what it says to bad input.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

fn truearm() -> Command {
    Command::cargo_bin("truearm").unwrap()
}

/// Runs to success; standard output and standard error.
fn run(args: &[&str]) -> (String, String) {
    let out = truearm().args(args).output().unwrap();
    let text = |b: &[u8]| String::from_utf8(b.to_vec()).unwrap();
    assert!(out.status.success(), "{args:?}: {}", text(&out.stderr));
    (text(&out.stdout), text(&out.stderr))
}

/// Runs to failure; the message with its line breaks undone.
fn fail(args: &[&str]) -> String {
    let out = truearm().args(args).env("COLUMNS", "1000").output().unwrap();
    assert_eq!(out.status.code(), Some(1), "{args:?}: {}", String::from_utf8_lossy(&out.stdout));
    let text = String::from_utf8(out.stderr).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    text.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

fn identify(set: &str, series: &str, more: &[&str]) -> Value {
    let robot = data(set).join("robot.toml");
    let rows = data(set).join(series).join("measurements.csv");
    let mut args = vec!["identify", robot.to_str().unwrap(), rows.to_str().unwrap(), "--json"];
    args.extend(more);
    serde_json::from_str(&run(&args).0).unwrap()
}

fn number(report: &Value, pointer: &str) -> f64 {
    report.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"))
}

#[test]
fn ur10_series() {
    for (series, nominal, limit) in [("series-b", 1.09, 0.46), ("series-c", 1.0, 0.50)] {
        let report = identify("ur10-ipa", series, &[]);
        let before = number(&report, "/nominal/rms_mm");
        let after = number(&report, "/cross_validated/rms_mm");
        println!("UR10 {series}: {before:.4} mm nominal, {after:.4} mm cross-validated");
        assert!((before - nominal).abs() < 0.02, "{before}");
        assert!(after <= limit, "{after}");
        assert!(number(&report, "/all_rows/cross_validated/rms_mm") <= limit);
        let flagged = report["outlier_rows"].as_array().unwrap().len();
        assert!(flagged as f64 <= 0.01 * number(&report, "/rows"));
        assert!(number(&report, "/cross_validated_blocked/rms_mm") >= after);
    }
}

#[test]
fn a_model_of_one_series_on_the_other() {
    let folder = tempfile::tempdir().unwrap();
    identify("ur10-ipa", "series-b", &["--out", folder.path().to_str().unwrap()]);
    let model = folder.path().join("model.toml");
    let model = model.to_str().unwrap();
    let other = data("ur10-ipa/series-c/measurements.csv");
    let other = other.to_str().unwrap();
    let message = fail(&["evaluate", model, other]);
    assert!(
        message.contains("station \"C\" is unknown to the model, which knows \"B\""),
        "{message}"
    );
    assert!(message.contains("--reregister base"), "{message}");
    assert!(message.contains("joint ranges not covered"), "{message}");

    let (json, _) = run(&["evaluate", model, other, "--reregister", "base", "--json"]);
    let report: Value = serde_json::from_str(&json).unwrap();
    let rms = number(&report, "/validation/rms_mm");
    println!("model of B on C, base fitted: {rms:.4} mm");
    assert!((0.55..0.65).contains(&rms));
    assert_eq!(report["validation"]["reregistered"], "base");
    assert_eq!(report["validation"]["joints_not_covered"].as_array().unwrap().len(), 6);

    // Its own data again: the same figure as identify's.
    let own = data("ur10-ipa/series-b/measurements.csv");
    let (json, _) = run(&["evaluate", model, own.to_str().unwrap(), "--json"]);
    let report: Value = serde_json::from_str(&json).unwrap();
    assert!((number(&report, "/validation/rms_mm") - 0.4414).abs() < 1e-3);
    let (table, _) = run(&["evaluate", model, own.to_str().unwrap()]);
    assert!(table.contains("identified"), "{table}");
}

#[test]
fn validation_of_identify_and_a_moved_tracker() {
    let folder = tempfile::tempdir().unwrap();
    let robot = data("ur10-ipa/robot.toml");
    let all = std::fs::read_to_string(data("ur10-ipa/series-c/measurements.csv")).unwrap();
    let (train, check) = (folder.path().join("train.csv"), folder.path().join("check.csv"));
    let lines: Vec<&str> = all.lines().collect();
    let write = |path: &Path, rows: &[&str]| {
        std::fs::write(path, format!("{}\n{}\n", lines[0], rows.join("\n"))).unwrap()
    };
    write(&train, &lines[1..301]);
    write(&check, &lines[301..401]);
    let args = |check: &Path| {
        let strings =
            [robot.clone(), train.clone(), "--validate".into(), check.to_owned(), "--json".into()];
        let strings = strings.map(|p| p.to_str().unwrap().to_owned());
        let mut args: Vec<&str> = vec!["identify"];
        args.extend(strings.iter().map(String::as_str));
        serde_json::from_str::<Value>(&run(&args).0).unwrap()
    };
    let report = args(&check);
    let good = number(&report, "/validation/rms_mm");
    assert!(good < 0.6, "{good}");
    assert_eq!(report["validation"]["reregistered"], "none");

    // The same rows from a tracker that was pushed by 5 mm.
    let moved: Vec<String> = lines[301..401]
        .iter()
        .map(|l| {
            let mut cells: Vec<String> = l.split(',').map(str::to_owned).collect();
            let x: f64 = cells[7].parse().unwrap();
            cells[7] = (x + 5.0).to_string();
            cells.join(",")
        })
        .collect();
    let pushed = folder.path().join("pushed.csv");
    write(&pushed, &moved.iter().map(String::as_str).collect::<Vec<_>>());
    let report = args(&pushed);
    assert!(number(&report, "/validation/rms_mm") > 4.5);
    assert!((number(&report, "/validation/base_refitted_rms_mm") - good).abs() < 0.05);
}

#[test]
fn pack_and_inspect() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    identify("seed-table-8", "", &["--out", folder.path().to_str().unwrap()]);
    let (said, _) =
        run(&["pack", &path("model.toml"), "--out", &path("params.bin"), "--sequence", "77"]);
    assert!(said.contains("564 bytes") && said.contains("orientation: not identified"), "{said}");
    assert!(said.contains("joint 6 beta moves no measured point"), "{said}");
    let (fields, _) = run(&["inspect", &path("params.bin")]);
    for field in ["checksum good", "sequence              77", "392.25", "109.15"] {
        assert!(fields.contains(field), "{field} in {fields}");
    }
    let bytes = std::fs::read(path("params.bin")).unwrap();
    std::fs::write(path("short.bin"), &bytes[..200]).unwrap();
    let message = fail(&["inspect", &path("short.bin")]);
    assert!(message.contains("200 bytes where 564 are needed"), "{message}");
    let mut flipped = bytes;
    flipped[100] ^= 1;
    std::fs::write(path("flipped.bin"), &flipped).unwrap();
    assert!(fail(&["inspect", &path("flipped.bin")]).contains("checksum"));
    let message =
        fail(&["pack", data("seed-table-8/robot.toml").to_str().unwrap(), "--out", &path("x")]);
    assert!(message.contains("model.toml as written by"), "{message}");
    assert!(!Path::new(&path("x")).exists());
}

/// The blob's arm and the model's arm are one: tool points agree after the
/// residual base, up to the rounding of f32.
#[test]
fn the_blob_is_the_model() {
    let folder = tempfile::tempdir().unwrap();
    identify("ur10-ipa", "series-c", &["--out", folder.path().to_str().unwrap()]);
    let model = truearm_host::model::Model::read(&folder.path().join("model.toml")).unwrap();
    let bytes = truearm_host::blob::pack(&model, None).unwrap();
    let blob = truearm::blob::Blob::check(&bytes).unwrap();
    let arm = truearm::Arm::new(&blob.parameters::<f64, 6>().unwrap());
    let (label, tool) = &model.markers[0];
    assert_eq!(label, "");
    let chain = truearm_host::model::arm::chain(&model.links(), truearm::Pose::identity(), *tool);
    let frame = truearm::Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let (mut square, mut count) = (0.0, 0.0);
    for k in 0..200 {
        let q: [f64; 6] = core::array::from_fn(|j| {
            let [low, high] = model.covered[j].unwrap();
            low + (high - low) * f64::from((k * (7 + j as i32)) % 101 + 1) / 103.0
        });
        let expected = frame.transform_point(&chain.pose(&q).translation);
        let real = arm.real_pose(&q).translation;
        assert!((real - expected).norm() < 1e-6);
        assert!(arm.covers(&q));
        square += (real - arm.nominal().forward(&q).translation).norm_squared();
        count += 1.0;
    }
    // Commanded and real points agree to what the identification corrects.
    let rms = f64::sqrt(square / count);
    assert!((0.3e-3..3e-3).contains(&rms), "{rms}");
}
