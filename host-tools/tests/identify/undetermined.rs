//! What data leave open or contradict: along it the answer stays where the robot
//! file has it, and where it cannot be an answer it is refused.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use truearm_host::identify::{Identification, Options, identify};
use truearm_host::model::{Measurements, Robot};

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(file)
}

fn scara(file: &str) -> (Robot, Measurements) {
    let robot = Robot::read(&data("scara/robot.toml")).unwrap();
    let rows = Measurements::read(&data(file), &robot).unwrap();
    (robot, rows)
}

fn identified(robot: &Robot, rows: &Measurements) -> Identification {
    identify(robot, rows, &Options::default(), &|_, _| {}).unwrap()
}

/// Base and half of the tool move no distance between two poses: the equations are
/// all but singular, and the fit must not stay where it began.
#[test]
fn distances_of_pairs_identify_an_arm_of_parallel_axes() {
    let (robot, rows) = scara("scara/pairs.csv");
    let figures = identified(&robot, &rows).figures;
    let [nominal, found, held] =
        [figures.nominal, figures.identified, figures.cross_validated].map(|s| s.unwrap().rms_mm);
    assert!(held < 0.1 * nominal && found < held, "{nominal} {found} {held}");
    // The other end of a pair is no row that lacks a prediction.
    assert_eq!(figures.rows_not_cross_validated, 0);
}

/// Height of base and tool are one where all axes are parallel: the tool stays where
/// the robot file has it, wherever the noise would put it.
#[test]
fn a_height_that_nothing_tells_stays_with_the_robot_file() {
    for file in ["scara/points.csv", "scara/pairs.csv"] {
        let (robot, rows) = scara(file);
        let found = identified(&robot, &rows).model;
        let off = found.markers[0].1 - robot.tool;
        assert!(off.norm() < 0.15 && off.z.abs() < 5e-3, "{file}: {off} m");
    }
}

/// Rows written twice were measured once.
#[test]
fn rows_written_twice_change_no_figure() {
    let (robot, once) = scara("scara/points.csv");
    let mut twice = once.clone();
    twice.rows.extend(once.rows.clone());
    let [a, b] = [&once, &twice].map(|rows| identified(&robot, rows));
    assert_eq!(a.figures.lambda, b.figures.lambda);
    assert_eq!(a.model.corrections, b.model.corrections);
    assert_eq!(a.model.uncertainties, b.model.uncertainties);
    let said = |i: &Identification| i.figures.warnings.iter().any(|w| w.contains("count once"));
    assert!(!said(&a) && said(&b), "{:?}", b.figures.warnings);
}

/// Copies of a flagged row are what it is: they stood among the rows of every figure, and 0.04 mm
/// were 7 mm.
#[test]
fn copies_of_a_gross_row_are_gross() {
    let (robot, mut once) = scara("scara/points.csv");
    once.rows[3].measured[0] += 0.05;
    let mut twice = once.clone();
    twice.rows.extend(once.rows.clone());
    let [a, b] = [&once, &twice].map(|rows| identified(&robot, rows));
    assert_eq!(a.figures.outlier_rows, [4]);
    assert_eq!(b.figures.outlier_rows, [4]);
    let flagged = |i: &Identification| i.rows.iter().filter(|row| row.flagged).count();
    assert_eq!((flagged(&a), flagged(&b)), (1, 2));
    let rms = |i: &Identification| i.figures.identified.unwrap().rms_mm;
    assert!((rms(&a) / rms(&b) - 1.0).abs() < 1e-9, "{} {}", rms(&a), rms(&b));
}

/// A plate whose coordinates are in inches is no set of gross errors.
#[test]
fn a_kind_that_contradicts_the_others_is_no_set_of_gross_rows() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/instruments");
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    let inches = |line: &str| match line.split_once(" = [") {
        Some((hole, xyz)) if hole.starts_with('H') => {
            let xyz = xyz.trim_end_matches(']').split(',');
            let xyz: Vec<String> =
                xyz.map(|x| (x.trim().parse::<f64>().unwrap() / 25.4).to_string()).collect();
            format!("{hole} = [{}]\n", xyz.join(", "))
        }
        _ => format!("{line}\n"),
    };
    let book: String = text("instruments.toml").lines().map(inches).collect();
    let own = tempfile::tempdir().unwrap();
    std::fs::write(own.path().join("instruments.toml"), book).unwrap();
    let mut run = Command::cargo_bin("truearm").unwrap();
    run.current_dir(&own).args(["identify", "robot.toml"]);
    std::fs::write(own.path().join("robot.toml"), text("robot.toml")).unwrap();
    for file in ["distances.csv", "touches.csv", "holes.csv"] {
        std::fs::write(own.path().join(file), text(file)).unwrap();
        run.args(["--data", file]);
    }
    let run = run.assert().code(1);
    let said = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert!(said.contains("rows of kind plate contradict the rest"), "{said}");
}

/// Angles are not said to be millimetres.
#[test]
fn angles_are_no_position_error() {
    let out = tempfile::tempdir().unwrap();
    let files = ["robot.toml", "measurements.csv"].map(|f| data("inclinations").join(f));
    let mut run = Command::cargo_bin("truearm").unwrap();
    run.arg("identify").args(files).arg("--out").arg(out.path());
    let run = run.assert().success();
    let said = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(said.contains("inclination") && !said.contains("position error"), "{said}");
    let report = std::fs::read_to_string(out.path().join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["identified"].is_null() && report["cross_validated"].is_null(), "{report}");
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(!page.contains("The arm misses by"), "a length of angles");
}
