//! Files that say too little, and verbs that say so.

use std::fs;

use crate::{read, run, table_8, write};

/// Rows of few poses, each measured often.
fn repeated(rows: &str, poses: usize, count: usize) -> String {
    let (header, rows) = rows.split_once('\n').unwrap();
    let some: Vec<&str> = rows.lines().take(poses).collect();
    let mut text = format!("{header}\n");
    (0..count).for_each(|i| text += &format!("{}\n", some[i % poses]));
    text
}

#[test]
fn check_of_few_poses_decides_nothing() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    for poses in [1, 2, 5] {
        write(&folder, "m.csv", &repeated(&rows, poses, 30));
        let (status, said) = run(&folder, "check robot.toml m.csv --fix fixed");
        assert_eq!(status, 4, "{poses} poses: {said}");
        assert!(
            said.contains("cannot be decided") && said.contains("at least 6 are needed"),
            "{said}"
        );
        assert!(!folder.path().join("fixed").exists());
        let (status, said) = run(&folder, "check robot.toml m.csv --json");
        assert_eq!(status, 4, "{said}");
        assert!(said.contains("\"verdict\": \"not-understood\""), "{said}");
        assert!(said.contains(&format!("\"poses\": {poses}")), "{said}");
        assert!(said.contains("\"poses_needed\": 6"), "{said}");
    }
    write(&folder, "m.csv", &repeated(&sound(&rows), 8, 30));
    let (status, said) = run(&folder, "check robot.toml m.csv");
    assert!(status != 4, "8 poses are enough: {said}");
}

/// Without the sixth and the seventh of the paper's points, which are gross errors.
fn sound(rows: &str) -> String {
    let lines = rows.lines().enumerate().filter(|(k, _)| ![6, 7].contains(k));
    lines.map(|(_, line)| format!("{line}\n")).collect()
}

/// Every verb that takes too few poses when asked to names its option, and no other does.
#[test]
fn an_option_is_named_where_there_is_one() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    let few: String = rows.lines().take(9).map(|line| format!("{line}\n")).collect();
    write(&folder, "m.csv", &few);
    std::fs::create_dir_all(folder.path().join("arms/a")).unwrap();
    write(&folder, "arms/a/measurements.csv", &few);
    write(&folder, "arms/robot.toml", &read(&folder, "robot.toml"));
    for (line, named) in [
        ("identify robot.toml m.csv", true),
        ("identify robot.toml m.csv --in-pieces", true),
        ("diagnose robot.toml m.csv", true),
        ("fleet arms", true),
        ("compare robot.toml m.csv", false),
        (
            "plan robot.toml --poses 6 --discriminate m.csv --out p.csv \
             --limits=-90:90,-90:90,-90:90,-90:90,-90:90,-90:90",
            false,
        ),
    ] {
        let (status, said) = run(&folder, line);
        let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(status != 0 && words.contains("measure at least 13 poses"), "{line}: {words}");
        assert_eq!(words.contains("--allow-few-poses goes on"), named, "{line}: {words}");
    }
}

/// The points that the file has are counted, not those that are left of them.
#[test]
fn check_counts_points() {
    let folder = table_8();
    let rows = read(&folder, "measurements.csv");
    for count in 1..8 {
        write(&folder, "m.csv", &repeated(&rows, count, count));
        let (status, said) = run(&folder, "check robot.toml m.csv");
        let words = format!("cannot be decided: too few points, {count}");
        assert!(status == 4 && said.contains(&words), "{count}: {status} {said}");
        assert!(said.contains("at least 8 are needed"), "{said}");
    }
    write(&folder, "m.csv", &repeated(&sound(&rows), 8, 8));
    assert_eq!(run(&folder, "check robot.toml m.csv").0, 0);
    // Of so few rows two that are far off may be the right ones.
    write(&folder, "m.csv", &repeated(&rows, 8, 8));
    let (status, said) = run(&folder, "check robot.toml m.csv");
    assert!(status == 4 && said.contains("2 of 8 rows are far off"), "{said}");
}

#[test]
fn a_path_out_of_reach() {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    write(&folder, "far.csv", "x_mm,y_mm,z_mm\n9000,0,0\n0,9000,0\n");
    let (status, said) = run(&folder, "compensate model.toml far.csv --out told.csv");
    assert!(status == 3 && said.contains("no row is reached"), "{status} {said}");
    assert!(!said.contains("orientation: off by"), "{said}");
    write(&folder, "none.csv", "x_mm,y_mm,z_mm\n");
    let (status, said) = run(&folder, "compensate model.toml none.csv --out told.csv");
    assert!(status == 1 && said.contains("add rows below the headings"), "{status} {said}");
    let (status, said) = run(&folder, "compensate model.toml far.csv --out told.yaml --every 1");
    assert!(status == 1 && said.contains("line 2 is not reached"), "{status} {said}");
    assert!(!folder.path().join("told.yaml").exists());
}

/// What was fitted is no validation, by whatever name it goes.
#[test]
fn the_training_file_validates_nothing() {
    let folder = table_8();
    fs::copy(folder.path().join("measurements.csv"), folder.path().join("copy.csv")).unwrap();
    for other in ["measurements.csv", "./measurements.csv", "copy.csv"] {
        let line = format!("identify robot.toml measurements.csv --validate {other} --out out");
        let (status, said) = run(&folder, &line);
        assert!(status == 2 && said.contains("18 of 18 rows are fitted"), "{other}: {said}");
        assert!(!folder.path().join("out").exists());
    }
}

/// Outside the repository there is no memory.x: it is said where it was looked for.
#[test]
fn a_slot_without_a_linker_script() {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    let (status, said) = run(&folder, "pack model.toml --slot a --out p.hex");
    assert_eq!(status, 1, "{said}");
    let place = folder.path().canonicalize().unwrap().join("memory.x");
    // However the line is broken.
    let said = said.replace(' ', "");
    assert!(said.contains(place.to_str().unwrap()) && said.contains("--memory"), "{said}");
}
