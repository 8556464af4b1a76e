//! Sets of another simulator, tests/data/hidden-effects: the program is asked
//! about all of them before an answer is opened.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

type Places = BTreeSet<(String, Vec<u64>)>;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects")
}

/// Names with a place each: a joint, a coupled pair or none.
fn places(effects: &Value) -> Places {
    let mut out = Places::new();
    for effect in effects.as_array().unwrap() {
        let name = effect["name"].as_str().unwrap().to_owned();
        let joints: Vec<u64> =
            effect["joints"].as_array().unwrap().iter().map(|j| j.as_u64().unwrap()).collect();
        if name == "joint-coupling" || joints.is_empty() {
            out.insert((name, joints));
        } else {
            out.extend(joints.iter().map(|j| (name.clone(), vec![*j])));
        }
    }
    out
}

fn diagnosed(case: &str) -> Value {
    let folder = folder().join("cases").join(case);
    let out = Command::cargo_bin("truearm")
        .unwrap()
        .current_dir(folder)
        .args(["diagnose", "robot.toml", "measurements.csv", "--holdout", "holdout.csv", "--json"])
        .output()
        .unwrap();
    assert!(out.status.success(), "{case}: {}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).unwrap()
}

#[test]
fn hidden_effects_are_named() {
    let entries = std::fs::read_dir(folder().join("cases")).unwrap();
    let mut cases: Vec<String> =
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    cases.sort();
    assert_eq!(cases.len(), 18);
    let reports: Vec<Value> = cases.iter().map(|case| diagnosed(case)).collect();

    let mut wrong = Vec::new();
    for (case, report) in cases.iter().zip(&reports) {
        let path = folder().join("answers").join(format!("{case}.json"));
        let answer: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
        let (named, hidden) = (places(&report["effects"]), places(&answer["expected_effects"]));
        if named != hidden || report["verdict"] != answer["expected_verdict"] {
            let verdict = &report["verdict"];
            wrong.push(format!("{case}: hidden {hidden:?}, named {named:?}, {verdict}"));
        }
        let last = report["gap"].as_array().unwrap().last().unwrap();
        let (rms, attainable) = (&last["holdout_rms_mm"], &answer["attainable_holdout_rms_mm"]);
        if let Some(attainable) = attainable.as_f64() {
            let ratio = rms.as_f64().unwrap() / attainable;
            println!("{case}: hold-out RMS over attainable {ratio:.3}");
            if ratio > 1.10 {
                wrong.push(format!("{case}: hold-out RMS {ratio:.3} of the attainable"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
