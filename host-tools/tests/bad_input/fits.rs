//! What users get wrong, and what they are told.

use std::path::Path;

use truearm_host::identify::{Options, identify};
use truearm_host::model::{Measurements, Robot};

const ROBOT: &str = include_str!("../../../tests/data/seed-table-8/robot.toml");
const ROWS: &str = include_str!("../../../tests/data/seed-table-8/measurements.csv");

fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), ROBOT).unwrap()
}

/// The message and the help for measurements.
fn refused(text: &str) -> String {
    let data = Measurements::parse(Path::new("m.csv"), text, &robot());
    let error = match data {
        Err(error) => error,
        Ok(data) => identify(&robot(), &data, &Options::default(), &|_, _| ()).unwrap_err(),
    };
    format!("{error} -> {}", error.help())
}

fn bad_robot(text: &str) -> String {
    let error = Robot::parse(Path::new("robot.toml"), text).unwrap_err();
    format!("{error} -> {}", error.help())
}

/// The table with one cell replaced; row and column count from 0.
fn with_cell(row: usize, column: usize, value: &str) -> String {
    let mut lines: Vec<Vec<String>> =
        ROWS.lines().map(|l| l.split(',').map(str::to_owned).collect()).collect();
    lines[row + 1][column] = value.to_owned();
    lines.iter().map(|l| l.join(",") + "\n").collect()
}

fn first_rows(count: usize) -> String {
    ROWS.lines().take(count + 1).map(|l| format!("{l}\n")).collect()
}

#[test]
fn measurements() {
    for (text, says) in [
        (String::new(), "m.csv: the file is empty -> it needs a header line and rows"),
        (first_rows(0), "m.csv: no data rows -> add rows below the headings"),
        (
            ROWS.replace("y_mm", "why_mm"),
            "m.csv:1: missing column y_mm -> the measured point needs x_mm, y_mm, z_mm",
        ),
        (
            ROWS.replace("q6_deg", "q6"),
            "m.csv:1: missing column q6_deg -> joint 6 of robot.toml is revolute and the robot has 6 joints",
        ),
        (
            ROWS.replace("x_mm", "q7_deg").replace("z_mm\n", "z_mm,x_mm\n"),
            "m.csv:1: column q7_deg, but robot.toml has 6 joints",
        ),
        (ROWS.replace("q2_deg", "q1_deg"), "m.csv:1: column q1_deg stands there twice"),
        (ROWS.replace(',', ";"), "m.csv:1: cells are separated by `;`"),
        (with_cell(3, 7, "NaN"), "m.csv:5, column y_mm: NaN is not a finite number"),
        (with_cell(3, 7, "inf"), "m.csv:5, column y_mm: inf is not a finite number"),
        (with_cell(0, 2, "1.2.3"), "m.csv:2, column q3_deg: \"1.2.3\" is not a number"),
        (with_cell(17, 8, ""), "m.csv:19, column z_mm: empty cell -> fill it in or delete the row"),
        (with_cell(1, 6, "2000000"), "m.csv:3, column x_mm: 2000 m away -> give the point in mm"),
        (with_cell(2, 8, "1,2"), "m.csv:4: 10 cells where the header has 9"),
        (
            first_rows(12),
            "m.csv: 12 distinct points give 36 equations for 39 unknowns -> measure at least 13 poses",
        ),
        (
            first_rows(0) + &[ROWS.lines().nth(1).unwrap(); 30].join("\n"),
            "m.csv: all rows have the same joint values -> measure different poses",
        ),
        (
            first_rows(10) + &first_rows(10)[first_rows(0).len()..],
            "m.csv: 10 distinct points give 30 equations for 39 unknowns",
        ),
    ] {
        let message = refused(&text);
        assert!(message.contains(says), "{message}\nshould say\n{says}");
    }
}

#[test]
fn a_few_poses_may_be_asked_for() {
    let data = Measurements::parse(Path::new("m.csv"), &first_rows(12), &robot()).unwrap();
    let options = Options { allow_few_poses: true, ..Options::default() };
    let found = identify(&robot(), &data, &options, &|_, _| ()).unwrap();
    assert!(found.figures.correction_norm < 100.0);
}

#[test]
fn a_wrong_joint_sense_does_not_pass_as_outliers() {
    let flipped: String = ROWS
        .lines()
        .enumerate()
        .map(|(i, l)| match (i, l.split_once(',')) {
            (0, _) | (_, None) => format!("{l}\n"),
            (_, Some((q1, rest))) => format!("{},{rest}\n", -q1.parse::<f64>().unwrap()),
        })
        .collect();
    let data = Measurements::parse(Path::new("m.csv"), &flipped, &robot()).unwrap();
    match identify(&robot(), &data, &Options::default(), &|_, _| ()) {
        Err(error) => assert!(error.help().contains("joint senses"), "{error}"),
        // A fit is possible, but nobody can take it for a good one.
        Ok(found) => assert!(found.figures.cross_validated.unwrap().rms_mm > 10.0),
    }
}

#[test]
fn warnings() {
    let radians: String = ROWS
        .lines()
        .enumerate()
        .map(|(i, l)| {
            let cell = |(k, c): (usize, &str)| match (i, k) {
                (1.., 0..6) => c.parse::<f64>().unwrap().to_radians().to_string(),
                _ => c.to_owned(),
            };
            l.split(',').enumerate().map(cell).collect::<Vec<_>>().join(",") + "\n"
        })
        .collect();
    let data = Measurements::parse(Path::new("m.csv"), &radians, &robot()).unwrap();
    assert!(data.warnings.iter().any(|w| w.contains("are they radians?")), "{:?}", data.warnings);
    let more: String = ROWS
        .lines()
        .enumerate()
        .map(
            |(i, l)| {
                if i == 0 { format!("\u{feff}{l},note\r\n") } else { format!("{l},hello\r\n") }
            },
        )
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.csv");
    std::fs::write(&path, more).unwrap();
    let data = Measurements::read(&path, &robot()).unwrap();
    assert!(data.warnings[0].contains("columns not used: note"), "{:?}", data.warnings);
    let text = ROBOT.replace("name =", "colour = \"red\"\nname =").replacen(
        "alpha_deg = 90.0",
        "alpha_deg = 1.5708",
        1,
    );
    let robot = Robot::parse(Path::new("robot.toml"), &text).unwrap();
    assert!(
        robot.warnings.iter().any(|w| w.contains("unknown key `colour`")),
        "{:?}",
        robot.warnings
    );
    assert!(
        robot.warnings.iter().any(|w| w.contains("looks like radians")),
        "{:?}",
        robot.warnings
    );
}

#[test]
fn robots() {
    for (text, says) in [
        ("name = 3", "robot.toml:1:8: invalid type: integer `3`, expected a string"),
        ("name = \"x\"", "robot.toml: no [[joints]]"),
        ("[[joints]\n", "robot.toml:1:"),
        (&ROBOT.replacen("a_mm = 425.0", "", 1), "missing field `a_mm`"),
        (
            &ROBOT.replacen("a_mm = 425.0", "a_mm = 42500.0", 1),
            "a_mm = 42500 -> lengths are mm, up to 10 m",
        ),
        (&ROBOT.replacen("a_mm = 425.0", "a_mm = nan", 1), "a_mm is NaN -> give a finite number"),
        (
            &ROBOT.replacen("a_mm = 425.0", "a_mm = 425.0\nkind = \"helical\"", 1),
            "kind = \"helical\" -> use \"revolute\" or \"prismatic\"",
        ),
        (
            &ROBOT.replacen("a_mm = 425.0", "a_mm = 425.0\nkind = \"prismatic\"", 1),
            "d_mm on a prismatic joint",
        ),
        (
            &ROBOT.replacen("a_mm = 425.0", "a_mm = 425.0\nlimits_deg = [3, -3]", 1),
            "limits [3, -3] -> give the lower limit first",
        ),
        (&ROBOT.replacen("sigma_mm = 0.03", "sigma_mm = 0", 1), "measurement_sigma_mm = 0"),
    ] {
        let message = bad_robot(text);
        assert!(message.contains(says), "{message}\nshould say\n{says}");
    }
}

/// Nothing is written when anything fails, and an old file stays.
#[test]
fn files_are_whole_or_untouched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a/b/model.toml");
    truearm_host::files::write(&path, b"one").unwrap();
    truearm_host::files::write(&path, b"two").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"two");
    let entries = std::fs::read_dir(path.parent().unwrap()).unwrap().count();
    assert_eq!(entries, 1, "no temporary file is left behind");
    // A folder in the way.
    assert!(truearm_host::files::write(folder.path(), b"x").is_err());
}
