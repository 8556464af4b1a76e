//! What is stated twice, or cannot stand on a line: refused before anything is
//! computed or written.

use crate::{read, run, table_8, write};

#[test]
fn a_label_is_stated_once() {
    let folder = table_8();
    let hole = "label = \"p\"\n[plates.holes]\nH1 = [0, 0, 0]\n";
    let mark = "marker = \"m\"\nxyz_mm = [0, 0, 10]\n";
    for (what, table, keys) in [
        ("anchor", "anchors", "label = \"a\"\nxyz_mm = [0, 0, 0]\n"),
        ("surface", "surfaces", "label = \"s\"\nshape = \"sphere\"\nradius_mm = 10\n"),
        ("probe", "probes", "marker = \"m\"\nradius_mm = 3\n"),
        ("plate", "plates", hole),
        ("marker", "markers", mark),
    ] {
        let once = format!("[[{table}]]\n{keys}");
        write(&folder, "instruments.toml", &once);
        let (status, said) = run(&folder, "identify robot.toml measurements.csv --json");
        assert_eq!(status, 0, "{what}: {said}");
        write(&folder, "instruments.toml", &once.repeat(2));
        let (status, said) = run(&folder, "identify robot.toml measurements.csv --json");
        assert!(status == 1 && said.contains(&format!("{what} \"")), "{what}: {status} {said}");
        assert!(said.contains("stated twice"), "{what}: {said}");
    }
    write(&folder, "instruments.toml", "[[probes]]\nmarker = \"m\"\nradius_mm = -3\n");
    let (status, said) = run(&folder, "identify robot.toml measurements.csv --json");
    assert!(status == 1 && said.contains("negative radius"), "{status} {said}");
}

#[test]
fn a_name_stands_on_one_line() {
    let folder = table_8();
    let robot = read(&folder, "robot.toml");
    let rest: String =
        robot.lines().filter(|l| !l.starts_with("name")).map(|l| l.to_owned() + "\n").collect();
    for (name, said_of_it) in [
        ("a\\u001b[2Jb".to_owned(), "control characters"),
        ("a\\nb".to_owned(), "control characters"),
        ("x".repeat(201), "201 characters"),
    ] {
        write(&folder, "robot.toml", &format!("name = \"{name}\"\n{rest}"));
        let (status, said) = run(&folder, "identify robot.toml measurements.csv --json");
        assert!(status == 1 && said.contains(said_of_it), "{status} {said}");
    }
    write(&folder, "robot.toml", &format!("name = \"{}\"\n{rest}", "é".repeat(200)));
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --json").0, 0);
}

/// Where one of the files cannot be written none is.
#[test]
fn a_new_model_never_stands_beside_an_old_page() {
    let folder = table_8();
    std::fs::create_dir_all(folder.path().join("out/report.html")).unwrap();
    for verb in ["identify", "diagnose"] {
        let line = format!("{verb} robot.toml measurements.csv --out out --force");
        let (status, said) = run(&folder, &line);
        assert!(status == 1 && said.contains("report.html"), "{verb}: {status} {said}");
        assert!(!folder.path().join("out/model.toml").exists(), "{verb}");
    }
}

/// A key that is right in its place is not said to be a slip of itself.
#[test]
fn a_wrong_term_is_the_only_thing_said_of_a_model() {
    let folder = table_8();
    assert_eq!(run(&folder, "identify robot.toml measurements.csv --out .").0, 0);
    let model = read(&folder, "model.toml");
    write(&folder, "model.toml", &format!("{model}\n[[terms]]\neffect = \"magic\"\n"));
    let (status, said) = run(&folder, "evaluate model.toml measurements.csv");
    assert!(status == 1 && !said.contains("is `joints` meant"), "{status} {said}");
    assert!(!said.contains("is `gravity_m_s2` meant"), "{said}");
}
