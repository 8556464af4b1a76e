//! How the program ends: exit statuses, readers that stop reading, full disks,
//! and tables whose labels hold commas.

#![cfg(target_os = "linux")]

use std::fs::{self, File};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// Every verb, its exit status, and a file that it writes.
const VERBS: [(&str, i32, &str); 11] = [
    ("identify robot.toml m.csv --out identified", 0, "identified/residuals.csv"),
    ("identify robot.toml m.csv --json --out both", 0, "both/report.json"),
    ("diagnose robot.toml m.csv --out diagnosed", 0, "diagnosed/residuals.csv"),
    ("evaluate model.toml m.csv", 0, ""),
    ("compare robot.toml m.csv --out compared", 0, "compared/methods.svg"),
    ("pack model.toml --out packed", 0, "packed"),
    ("inspect a.bin", 0, ""),
    ("diff a.bin a.bin --poses 100", 0, ""),
    ("unpack a.bin --out back.toml", 0, "back.toml"),
    ("plan robot.toml --poses 14 --candidates 100 --limits LIMITS --out plan.csv", 0, "plan.csv"),
    ("verify model.toml c.csv --tolerance-mm 0.001 --out verified", 3, "verified/errors.csv"),
];

/// The paper's points with a label that needs quoting, and what the verbs read.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/seed-table-8");
    fs::copy(data.join("robot.toml"), folder.path().join("robot.toml")).unwrap();
    let text = fs::read_to_string(data.join("measurements.csv")).unwrap();
    let mut lines = text.lines();
    let mut labelled = format!("{},station\n", lines.next().unwrap());
    lines.for_each(|line| labelled += &format!("{line},\"hall 3, \"\"north\"\"\"\n"));
    fs::write(folder.path().join("m.csv"), &labelled).unwrap();
    let commanded =
        (1..=6).fold(labelled, |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    fs::write(folder.path().join("c.csv"), commanded).unwrap();
    for line in ["identify robot.toml m.csv --out .", "pack model.toml --out a.bin"] {
        assert_eq!(truearm(&folder, line, Stdio::null(), Stdio::null()).status.code(), Some(0));
    }
    folder
}

fn truearm(folder: &TempDir, line: &str, out: Stdio, err: Stdio) -> Output {
    let line = line.replace("LIMITS", &["-120:120"; 6].join(","));
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    command.current_dir(folder).args(line.split_whitespace()).stdout(out).stderr(err);
    command.spawn().unwrap().wait_with_output().unwrap()
}

/// A pipe that nobody reads.
fn unread() -> Stdio {
    std::io::pipe().unwrap().1.into()
}

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn who_stops_reading_loses_nothing() {
    let folder = folder();
    for (line, status, file) in VERBS {
        let output = truearm(&folder, line, unread(), Stdio::piped());
        assert_eq!(output.status.code(), Some(status), "{line}: {}", message(&output));
        assert!(!message(&output).contains("panicked"), "{line}: {}", message(&output));
        assert!(folder.path().join(file).exists(), "{line} wrote no {file}");
    }
    for line in ["--help", "--version", "plan --help"] {
        assert_eq!(truearm(&folder, line, unread(), Stdio::piped()).status.code(), Some(0));
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let folder = folder();
    for (line, _, _) in VERBS {
        let output = truearm(&folder, line, full(), Stdio::piped());
        assert_eq!(output.status.code(), Some(1), "{line}");
        let said = message(&output);
        assert!(said.contains("standard output: No space left on device"), "{line}: {said}");
        assert!(!said.contains("panicked"), "{line}: {said}");
    }
    // Remarks that cannot be written are no reason to fail.
    let output = truearm(&folder, VERBS[0].0, Stdio::null(), full());
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_device_is_written_to_and_not_replaced() {
    let folder = folder();
    for line in [
        "pack model.toml --out /dev/full",
        "unpack a.bin --out /dev/full",
        "plan robot.toml --poses 14 --candidates 100 --limits LIMITS --out /dev/full",
    ] {
        let output = truearm(&folder, line, Stdio::piped(), Stdio::piped());
        assert_eq!(output.status.code(), Some(1), "{line}");
        let said = message(&output);
        assert!(said.contains("/dev/full: No space left on device"), "{line}: {said}");
        assert!(output.stdout.is_empty(), "{line} says it wrote");
        assert!(fs::metadata("/dev/full").unwrap().file_type().is_char_device());
    }
    // A link stays one.
    std::os::unix::fs::symlink("target.bin", folder.path().join("link.bin")).unwrap();
    fs::write(folder.path().join("target.bin"), "old").unwrap();
    truearm(&folder, "pack model.toml --out link.bin --force", Stdio::null(), Stdio::null());
    assert!(folder.path().join("link.bin").is_symlink());
    let [written, packed] =
        ["target.bin", "a.bin"].map(|n| fs::read(folder.path().join(n)).unwrap());
    assert_eq!(written, packed);
}

/// The files of a folder change together: where one of them cannot, none does.
#[test]
fn a_folder_changes_as_a_whole() {
    let folder = folder();
    for line in [
        "identify robot.toml m.csv --figures --out out",
        "diagnose robot.toml m.csv --figures --out out",
        "verify model.toml c.csv --out out --figures",
        "compare robot.toml m.csv --out out",
    ] {
        let out = folder.path().join("out");
        let quietly = || truearm(&folder, line, Stdio::null(), Stdio::piped());
        assert_eq!(quietly().status.code(), Some(0), "{line}");
        let text = |name: &str| fs::read(out.join(name)).unwrap_or_default();
        let names = ["model.toml", "report.json", "residuals.csv", "report.html"];
        // Signed by another run: what is written anew would differ.
        for name in names.iter().filter(|name| out.join(name).is_file()) {
            let mut longer = text(name);
            longer.extend(b"\n");
            fs::write(out.join(name), longer).unwrap();
        }
        let before = names.map(text);
        let drawn: Vec<_> = fs::read_dir(&out).unwrap().map(|f| f.unwrap().file_name()).collect();
        let drawn: Vec<_> = drawn.iter().map(|name| name.to_str().unwrap()).collect();
        let blocked = drawn.iter().find(|name| name.ends_with(".svg")).unwrap();
        fs::remove_file(out.join(blocked)).unwrap();
        fs::create_dir(out.join(blocked)).unwrap();
        let output = quietly();
        assert_eq!(output.status.code(), Some(1), "{line}");
        assert!(message(&output).contains(blocked), "{line}: {}", message(&output));
        assert!(before == names.map(text), "{line}: new files beside old ones");
        assert_eq!(fs::read_dir(&out).unwrap().count(), drawn.len(), "{line}: files left over");
        fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn one_table_of_exit_statuses() {
    let folder = folder();
    for (line, status) in [
        ("evaluate model.toml m.csv", 0),
        ("evaluate model.toml none.csv", 1),
        ("inspect robot.toml", 1),
        ("", 2),
        ("evaluate", 2),
        ("identify robot.toml m.csv --lambda much", 2),
        ("plan robot.toml --poses 14 --limits 1:2 --out p.csv", 2),
        ("verify model.toml c.csv --tolerance-mm 100", 0),
        ("verify model.toml c.csv --tolerance-mm -1", 2),
        ("verify model.toml c.csv --tolerance-mm 0.001", 3),
    ] {
        let output = truearm(&folder, line, Stdio::null(), Stdio::piped());
        assert_eq!(output.status.code(), Some(status), "{line}: {}", message(&output));
    }
    // The largest error as the limit: less than its uncertainty away.
    let line = "verify model.toml c.csv --json";
    let json = truearm(&folder, line, Stdio::piped(), Stdio::null()).stdout;
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let line = format!("{line} --tolerance-mm {}", report["after"]["max_mm"]);
    assert_eq!(truearm(&folder, &line, Stdio::null(), Stdio::null()).status.code(), Some(4));
}

#[test]
fn labels_are_quoted() {
    let folder = folder();
    for (line, table) in [(VERBS[0].0, VERBS[0].2), (VERBS[10].0, VERBS[10].2)] {
        truearm(&folder, line, Stdio::null(), Stdio::null());
        let mut reader = csv::Reader::from_path(folder.path().join(table)).unwrap();
        let records: Vec<_> = reader.records().map(|r| r.unwrap()).collect();
        assert_eq!(records.len(), 18);
        assert!(records.iter().all(|r| &r[2] == "hall 3, \"north\""), "{table}: {records:?}");
    }
}
