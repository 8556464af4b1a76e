//! What a program owes its shell: permissions, formats by name, completions,
//! manual pages, and files it refuses to judge by themselves.

#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// The paper's points and the model they give.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/seed-table-8");
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data.join(name), folder.path().join(name)).unwrap();
    }
    fs::copy(data.join("../../../memory.x"), folder.path().join("memory.x")).unwrap();
    assert_eq!(run(&folder, "truearm identify robot.toml measurements.csv --out .").0, 0);
    folder
}

/// Runs a line under sh, which holds the umask; status, standard output and error.
fn run(folder: &TempDir, line: &str) -> (i32, String, String) {
    let line = line.replace("truearm ", &format!("{} ", env!("CARGO_BIN_EXE_truearm")));
    let mut command = Command::new("sh");
    let ran =
        command.current_dir(folder).args(["-c", &line]).env("COLUMNS", "1000").output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).replace('│', " ");
    let words = |bytes: &[u8]| text(bytes).split_whitespace().collect::<Vec<_>>().join(" ");
    (ran.status.code().unwrap(), text(&ran.stdout), words(&ran.stderr))
}

#[test]
fn files_get_the_users_umask() {
    let folder = folder();
    let mode =
        |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode() & 0o777;
    for (umask, expected) in [("022", 0o644), ("002", 0o664), ("077", 0o600)] {
        let line = format!("umask {umask}; truearm pack model.toml --out {umask}.bin");
        assert_eq!(run(&folder, &line).0, 0);
        assert_eq!(mode(&format!("{umask}.bin")), expected, "umask {umask}");
    }
    // What stands there keeps what its owner gave it.
    fs::set_permissions(folder.path().join("022.bin"), fs::Permissions::from_mode(0o640)).unwrap();
    assert_eq!(run(&folder, "truearm pack model.toml --out 022.bin").0, 0);
    assert_eq!(mode("022.bin"), 0o640);
}

#[test]
fn the_format_is_in_the_name() {
    let folder = folder();
    let format = [
        ("p.hex", "ihex"),
        ("p.ihex", "ihex"),
        ("p.uf2", "uf2"),
        ("p.ELF", "elf"),
        ("p.c", "c"),
        ("p.rs", "rust"),
        ("p.bin", "bin"),
        ("p", "bin"),
    ];
    for (name, format) in format {
        for line in [format!("--out {name}"), format!("--force --out explicit --format {format}")] {
            let line = format!("truearm pack model.toml --slot a {line}");
            assert_eq!(run(&folder, &line).0, 0, "{line}");
        }
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
        assert_eq!(read(name), read("explicit"), "{name}");
    }
    // An address is still asked for.
    let (status, _, said) = run(&folder, "truearm pack model.toml --out q.hex");
    assert!(status == 1 && said.contains("--slot a or --slot b"), "{said}");
}

#[test]
fn completions_and_manual_pages() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (status, text, _) = run(&folder, &format!("truearm completions {shell}"));
        assert_eq!(status, 0);
        assert!(text.contains("identify") && text.contains("reregister"), "{shell}");
    }
    assert_eq!(run(&folder, "truearm completions bash > c.sh && bash -n c.sh").0, 0);
    let (status, text, _) = run(&folder, "truearm man man1");
    assert!(status == 0 && text.contains("pages to man1"), "{text}");
    let page = fs::read_to_string(folder.path().join("man1/truearm-identify.1")).unwrap();
    assert!(
        page.contains(".TH truearm\\-identify") || page.contains(".TH truearm-identify"),
        "{page}"
    );
    assert!(
        fs::read_to_string(folder.path().join("man1/truearm.1")).unwrap().contains("Exit status")
    );
}

/// Poses that were fitted are no hold-out, and points of the tracker's frame are
/// not what a controller was told.
#[test]
fn files_that_cannot_judge() {
    let folder = folder();
    let rows = fs::read_to_string(folder.path().join("measurements.csv")).unwrap();
    let (status, _, said) =
        run(&folder, "truearm diagnose robot.toml measurements.csv --holdout measurements.csv");
    assert!(status == 2 && said.contains("18 of 18 rows are fitted in measurements.csv"), "{said}");
    let head: String = rows.lines().take(5).map(|l| format!("{l}\n")).collect();
    fs::write(folder.path().join("some.csv"), head).unwrap();
    let (status, _, said) =
        run(&folder, "truearm diagnose robot.toml measurements.csv --holdout some.csv");
    assert!(status == 2 && said.contains("4 of 4 rows are fitted"), "{said}");

    // A tracker two metres away, whose points are told as if commanded.
    let moved = |name: &str, offset: [f64; 3]| {
        let line = |(i, line): (usize, &str)| {
            let cells: Vec<&str> = line.split(',').collect();
            if i == 0 {
                return format!("{},cmd_x_mm,cmd_y_mm,cmd_z_mm\n", cells[6..].join(","));
            }
            let seen: Vec<f64> = cells[6..].iter().map(|c| c.parse().unwrap()).collect();
            let told = seen.iter().zip(offset).map(|(v, o)| (v + o).to_string());
            format!("{},{}\n", cells[6..].join(","), told.collect::<Vec<_>>().join(","))
        };
        let text: String = rows.lines().enumerate().map(line).collect();
        fs::write(folder.path().join(name), text).unwrap();
    };
    let far: String = rows
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if i > 0 {
                cells[6] = (cells[6].parse::<f64>().unwrap() + 2000.0).to_string();
            }
            cells.join(",") + "\n"
        })
        .collect();
    fs::write(folder.path().join("far.csv"), &far).unwrap();
    assert_eq!(run(&folder, "truearm identify robot.toml far.csv --out far").0, 0);
    let near = fs::read_to_string(folder.path().join("measurements.csv")).unwrap();
    assert_ne!(near, far);
    moved("seen.csv", [0.0; 3]);
    // Identified 2 m away, verified with points told where the tracker saw them.
    let (status, _, said) = run(&folder, "truearm verify far/model.toml seen.csv");
    assert!(
        status == 1 && said.contains("in the tracker's") && said.contains("in the robot's frame"),
        "{said}"
    );
    let (status, _, said) = run(&folder, "truearm verify model.toml seen.csv");
    assert_eq!(status, 0, "robot and tracker in one place: {said}");
}

/// Another robot's model and what others wrote stay, unless they are meant.
#[test]
fn what_is_not_ours_stays() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let identify = "truearm identify robot.toml measurements.csv --out .";
    assert_eq!(run(&folder, identify).0, 0, "the same again");
    assert_eq!(run(&folder, "truearm pack model.toml --out p.bin").0, 0);
    let robot = String::from_utf8(read("robot.toml")).unwrap();
    write("other.toml", &robot.replace("name = \"", "name = \"other "));
    let other = "truearm identify other.toml measurements.csv --out";
    assert_eq!(run(&folder, &format!("{other} other")).0, 0);
    write("mine.bin", "mine");
    for (line, file, says) in [
        (format!("{other} ."), "model.toml", "the file is of another robot: 6R"),
        (
            "truearm pack other/model.toml --out p.bin".to_owned(),
            "p.bin",
            "of another robot: with the id",
        ),
        (
            "truearm pack model.toml --out mine.bin".to_owned(),
            "mine.bin",
            "it is not as truearm wrote it",
        ),
        (
            "truearm unpack p.bin --out robot.toml".to_owned(),
            "robot.toml",
            "it is not as truearm wrote it",
        ),
    ] {
        let before = read(file);
        let (status, _, said) = run(&folder, &line);
        assert!(status == 1 && said.contains(says) && said.contains("--force"), "{line}: {said}");
        assert!(read(file) == before, "{line} wrote over {file}");
        assert_eq!(run(&folder, &format!("{line} --force")).0, 0, "{line}");
        assert!(read(file) != before, "{line} --force did not write {file}");
    }
    write("report.json", "{}");
    let (status, _, said) = run(&folder, "truearm identify other.toml measurements.csv --out .");
    assert!(status == 1 && said.contains("report.json: the file is there"), "{said}");
}

#[test]
fn quiet_and_verbose() {
    let folder = folder();
    let line = "truearm identify robot.toml measurements.csv";
    let (status, out, err) = run(&folder, line);
    assert!(status == 0 && !out.is_empty() && !err.contains("truearm 0"), "{err}");
    let (status, out, err) = run(&folder, &format!("{line} --quiet"));
    assert_eq!((status, out.as_str(), err.as_str()), (0, "", ""));
    let (_, out, _) = run(&folder, &format!("{line} -q --json"));
    assert!(out.starts_with('{'), "{out}");
    let (_, _, err) = run(&folder, &format!("{line} -v"));
    assert!(err.contains(concat!("truearm ", env!("CARGO_PKG_VERSION"), ": ")), "{err}");
    let (status, _, err) = run(&folder, "truearm -q identify none.toml measurements.csv");
    assert!(status == 1 && err.contains("none.toml"), "{err}");
}

/// Where one wrong row leads a fit away it is named: nothing is wrong with senses and units.
#[test]
fn the_row_that_a_fit_fails_of_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let case =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases/case_008");
    fs::copy(case.join("robot.toml"), folder.path().join("robot.toml")).unwrap();
    let text = fs::read_to_string(case.join("measurements.csv")).unwrap();
    let mut lines: Vec<String> = text.lines().take(41).map(str::to_owned).collect();
    let (first, rest) = lines[40].split_once(',').unwrap();
    lines[40] = format!("{},{rest}", first.parse::<f64>().unwrap() + 90.0);
    fs::write(folder.path().join("m.csv"), lines.join("\n") + "\n").unwrap();
    let (status, _, told) = run(&folder, "truearm identify robot.toml m.csv");
    let named = told.contains("1 of 40 rows is far off") && told.contains("row 40");
    assert!(status == 0 || named, "{told}");
}
