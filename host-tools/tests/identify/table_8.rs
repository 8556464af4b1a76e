//! The paper's only printed measurements: Table 8, 18 rows, two misprinted cells.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;
use truearm_host::evaluate::residuals;
use truearm_host::identify::{Conditions, Options, State, identify};
use truearm_host::methods::{Frames, all, compare};
use truearm_host::model::{Measurements, Robot};

/// Joints in degrees, point in mm, as the paper prints them (x, y, z in the last
/// three columns, whose heads it misprints).
const PRINTED: [[f64; 9]; 18] = [
    [-30.0, -270.0, -120.0, -120.0, -120.0, 60.0, 209.973, -293.954, 209.626],
    [-20.0, -260.0, -110.0, -110.0, -110.0, 70.0, 291.836, -251.513, 336.002],
    [-10.0, -250.0, -100.0, -100.0, -100.0, 80.0, 313.725, -179.829, 488.507],
    [0.0, -240.0, -90.0, -90.0, -90.0, 90.0, 254.148, -108.274, 644.31],
    [10.0, -230.0, -80.0, -80.0, -80.0, 100.0, 113.411, -75.378, 773.123],
    [20.0, -220.0, -70.0, -70.0, -70.0, 110.0, -79.909, -114.24, 804.813],
    [30.0, -210.0, -60.0, -60.0, -60.0, 120.0, -274.935, -236.05, 813.508],
    [40.0, -200.0, -50.0, -50.0, -50.0, 130.0, -415.406, -420.588, 720.802],
    [-0.055, -244.987, -100.005, -99.949, -92.524, 61.787, 305.016, -112.191, 515.618],
    [-0.024, -235.077, -90.010, -99.968, -92.439, 61.771, 202.378, -111.875, 642.36],
    [-0.041, -219.938, -100.093, -87.655, -91.486, 89.953, 102.831, -110.489, 632.207],
    [10.003, -235.014, -100.035, -100.081, -92.065, 61.065, 244.328, -69.872, 561.687],
    [20.190, -235.055, -100.29, -100.317, -92.106, 61.101, 253.422, -25.405, 558.896],
    [20.177, -244.968, -90.0401, -100.317, -92.104, 61.098, 312.765, -3.653, 598.55],
    [30.009, -244.965, -99.9937, -100.007, -82.109, 61.103, 312.434, 68.515, 516.422],
    [30.001, -235.000, -99.9992, -100.001, -82.002, 70.997, 246.008, 30.275, 562.874],
    [-10.000, -235.000, -99.9854, -100.009, -82.109, 61.090, 207.896, -135.085, 562.85],
    [-10.000, -245.000, -89.9989, -100.009, -82.109, 61.090, 271.342, -146.286, 600.039],
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/seed-table-8")
}

fn read() -> (Robot, Measurements) {
    let robot = Robot::read(&folder().join("robot.toml")).unwrap();
    let data = Measurements::read(&folder().join("measurements.csv"), &robot).unwrap();
    (robot, data)
}

#[test]
fn the_file_is_the_printed_table() {
    let (_, data) = read();
    assert_eq!((data.rows.len(), data.poses), (18, 18));
    for (row, printed) in data.rows.iter().zip(&PRINTED) {
        for (q, degrees) in row.q.iter().zip(printed) {
            assert_eq!(*q, degrees.to_radians());
        }
        for (x, mm) in row.measured.iter().zip(&printed[6..]) {
            assert!((x * 1e3 - mm).abs() < 1e-9, "line {}", row.line);
        }
    }
}

#[test]
fn two_cells_are_flagged_and_no_other() {
    let out = tempfile::tempdir().unwrap();
    let run = Command::cargo_bin("truearm")
        .unwrap()
        .current_dir(folder())
        .args(["identify", "robot.toml", "measurements.csv", "--json", "--out"])
        .arg(out.path())
        .output()
        .unwrap();
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(report["outlier_rows"], serde_json::json!([6, 7]));
    for (outlier, z) in report["outliers"].as_array().unwrap().iter().zip([-38.0, -15.0]) {
        assert_eq!(outlier["coordinates"], serde_json::json!(["z"]));
        let found: Vec<f64> = outlier["residual_mm"]
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect();
        // Whole millimetres: misprints, not measurements.
        assert!((found[2] - z).abs() < 0.25, "{found:?}");
        assert!(found[0].abs() < 0.25 && found[1].abs() < 0.25, "{found:?}");
    }
    assert_eq!(report["condition_number_raw"], "> 1e15");
    assert_eq!(report["rank"], 27);
    // No correction of metres: every length within 15 mm.
    let text = std::fs::read_to_string(out.path().join("model.toml")).unwrap();
    let model: toml::Table = text.parse().unwrap();
    for correction in model["corrections"].as_array().unwrap() {
        for key in ["a_mm", "d_mm"] {
            assert!(correction[key].as_float().unwrap().abs() < 15.0, "{correction}");
        }
    }
}

/// What the report calls leave-one-out, with 18 identifications that never saw
/// the row they are judged on.
#[test]
fn leave_one_out_by_leaving_one_out() {
    let (robot, data) = read();
    let whole = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap();
    let stats = whole.figures.cross_validated.unwrap();
    println!("Table 8, leave-one-out: mean {:.4} mm, max {:.4} mm", stats.mean_mm, stats.max_mm);
    assert!(stats.mean_mm <= 0.075 && stats.max_mm <= 0.25);
    assert!(whole.figures.all_rows.cross_validated.unwrap().max_mm > 30.0);
    assert_eq!(whole.figures.cross_validation, "leave-one-out over 18 poses");
    let mut kept = Vec::new();
    for left_out in 0..data.rows.len() {
        let mut others = data.clone();
        others.rows.remove(left_out);
        for (i, row) in others.rows.iter_mut().enumerate() {
            row.pose = i;
        }
        others.poses = others.rows.len();
        let found = identify(&robot, &others, &Options::default(), &|_, _| ()).unwrap();
        let state = State {
            bases: found.model.stations.iter().map(|s| s.1).collect(),
            markers: found.model.markers.iter().map(|m| m.1).collect(),
            instruments: Vec::new(),
            links: found.model.links(),
            terms: Vec::new(),
        };
        let seen = residuals(&data, &Conditions::new(&data, &robot), &state)[left_out];
        let reported = whole.rows[left_out].held_out.unwrap();
        assert!((seen - reported).norm() < 1e-7, "row {}: {seen} {reported}", left_out + 1);
        if !whole.rows[left_out].flagged {
            kept.push(seen.norm() * 1e3);
        }
    }
    assert_eq!(kept.len(), 16);
    let mean = kept.iter().sum::<f64>() / 16.0;
    assert!((mean - stats.mean_mm).abs() < 1e-4, "{mean} {}", stats.mean_mm);
}

/// On the paper's own rows: plain methods fit them with corrections of
/// decimetres or not at all, regularised ones with millimetres.
#[test]
fn methods_on_the_printed_rows() {
    let (robot, data) = read();
    let found = compare(&robot, &data, None, Frames::Fitted, &all()).unwrap();
    assert_eq!(found.outlier_rows, [6, 7]);
    for o in &found.methods {
        let mae = o.fitted.map_or(f64::NAN, |s| s.mean_mm);
        println!("{:7} {mae:12.4} mm, {:?} tolerances", o.name, o.correction_norm);
    }
    let of = |name: &str| found.methods.iter().find(|o| o.name == name).unwrap();
    for name in ["RPIM-P", "RPIM"] {
        assert!(of(name).fitted.unwrap().mean_mm < 0.05, "{name}");
        assert!(of(name).correction_norm.unwrap() < 10.0, "{name}");
    }
    for name in ["LSM", "GN"] {
        assert!(of(name).correction_norm.unwrap() > 100.0, "{name}");
    }
}
