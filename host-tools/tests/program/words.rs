//! What every verb says on the terminal, on the shipped data. Numbers are
//! rounded to two digits, so that machines agree; `cargo insta review`, or
//! `INSTA_UPDATE=always cargo test -p truearm-host --test program words`, takes new words.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

/// A folder with the paper's points, commanded ones, a model and a blob.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/seed-table-8");
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data.join(name), folder.path().join(name)).unwrap();
    }
    let rows = fs::read_to_string(data.join("measurements.csv")).unwrap();
    // A hundredth of a micrometre off: measured again, and not the rows that are fitted.
    let again = |(i, line): (usize, &str)| format!("{line}{}\n", if i == 0 { "" } else { "00001" });
    let again: String = rows.lines().enumerate().map(again).collect();
    fs::write(folder.path().join("again.csv"), again).unwrap();
    let commanded = (1..=6).fold(rows, |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    fs::write(folder.path().join("commanded.csv"), commanded).unwrap();
    says(&folder, "identify robot.toml measurements.csv --out .");
    says(&folder, "pack model.toml --out a.bin --sequence 7");
    folder
}

/// Status, standard output and standard error.
fn says(folder: &TempDir, line: &str) -> String {
    let line = line.replace("LIMITS", &["-120:120"; 6].join(","));
    let mut command = Command::new(env!("CARGO_BIN_EXE_truearm"));
    command.current_dir(folder).args(line.split(' ')).stdin(Stdio::null()).env("NO_COLOR", "1");
    let ran = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let status = ran.status.code().unwrap();
    format!("status {status}\n{}{}", text(ran.stdout), text(ran.stderr))
}

/// Words with numbers of more than two digits behind the point, or with an
/// exponent, rounded to two digits; what is left of small ones is noise.
fn rounded(text: &str) -> String {
    let part = |c: char| c.is_ascii_digit() || ".e+-".contains(c);
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(part) {
        out += &rest[..start];
        let length = rest[start..].find(|c| !part(c)).unwrap_or(rest.len() - start);
        let word = &rest[start..start + length];
        let number = word.trim_start_matches("+-");
        out += &word[..word.len() - number.len()];
        let digits = number.split(['.', 'e']).nth(1).map_or(0, str::len);
        match number.parse::<f64>() {
            Ok(x) if number.contains('e') || (number.contains('.') && digits > 2) => {
                let size = x.abs().log10().floor().max(-2.0);
                let unit = 10_f64.powf(size - 1.0);
                out += &format!("~{}", ((x / unit).round() * unit * 1e6).round() / 1e6 + 0.0);
            }
            _ => out += number,
        }
        rest = &rest[start + length..];
    }
    // Columns are as wide as the numbers were.
    let lines = (out + rest).lines().map(str::to_owned).collect::<Vec<_>>();
    let words =
        |line: &String| line.split(' ').filter(|w| !w.is_empty()).collect::<Vec<_>>().join(" ");
    lines.iter().map(|line| words(line) + "\n").collect()
}

/// Compares what a verb says, lines with a time or a hash left out.
fn verb(name: &str, line: &str, vary: &[&str]) {
    let said = rounded(&says(&folder(), line));
    let keep = said.lines().filter(|l| !vary.iter().any(|word| l.contains(word)));
    insta::assert_snapshot!(name, keep.collect::<Vec<_>>().join("\n"));
}

#[test]
fn identify() {
    verb("identify", "identify robot.toml measurements.csv --validate again.csv", &[]);
}

#[test]
fn diagnose() {
    verb("diagnose", "diagnose robot.toml measurements.csv", &[]);
}

#[test]
fn evaluate() {
    verb("evaluate", "evaluate model.toml measurements.csv --reregister base", &[]);
}

#[test]
fn compare() {
    // Times, and what breaks down, differ from machine to machine.
    let vary = ["NC ", "LSM", "GD ", "GN", "LM ", "EKF", "RPIM"];
    verb("compare", "compare robot.toml measurements.csv", &vary);
}

#[test]
fn pack() {
    verb("pack", "pack model.toml --out b.bin --sequence 7", &[]);
}

#[test]
fn inspect() {
    verb("inspect", "inspect a.bin", &["created", "robot id"]);
}

#[test]
fn diff() {
    verb("diff", "diff a.bin a.bin", &[]);
}

#[test]
fn unpack() {
    verb("unpack", "unpack a.bin --out back.toml", &[]);
}

#[test]
fn plan() {
    let line = "plan robot.toml --poses 14 --candidates 100 --limits LIMITS --out plan.csv";
    verb("plan", line, &["O1 "]);
}

#[test]
fn verify() {
    verb("verify", "verify model.toml commanded.csv --tolerance-mm 0.5", &[]);
}

#[test]
fn fk() {
    verb("fk", "fk model.toml measurements.csv --out fk.csv", &[]);
}

#[test]
fn compensate() {
    let line = "compensate model.toml measurements.csv --from joints --out told.csv";
    verb("compensate", line, &[]);
}

#[test]
fn ik() {
    let folder = folder();
    fs::write(folder.path().join("poses.csv"), "x_mm,y_mm,z_mm\n-400,-200,300\n0,0,9000\n")
        .unwrap();
    let said = rounded(&says(&folder, "ik model.toml poses.csv --out ik.csv"));
    insta::assert_snapshot!("ik", said);
}

/// What is wrong in a file is shown where it stands.
#[test]
fn errors() {
    let folder = folder();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let rows = read("measurements.csv");
    let second = rows.lines().nth(2).unwrap();
    let cells: Vec<&str> = second.split(',').collect();
    let broken = [&cells[..7], &["much"], &cells[8..]].concat().join(",");
    write("cell.csv", rows.replace(second, &broken));
    write("robot2.toml", read("robot.toml").replacen("a_mm = 425.0", "a_mm = 42500.0", 1));
    let misspelt = |name: &str| read(name).replace("measurement_sigma_mm", "measurment_sigma_mm");
    write("slip.toml", misspelt("model.toml"));
    write("stray.toml", format!("corrections = \"none\"\n{}", misspelt("robot.toml")));
    write("headless.toml", read("model.toml").replace("schema = \"truearm-model-1\"\n", ""));
    let blob = include_bytes!("../../../tests/data/golden/layout-3-full.blob");
    fs::write(folder.path().join("in-force.blob"), blob).unwrap();
    let said: Vec<String> = [
        "identify robot.toml cell.csv",
        "identify robot2.toml measurements.csv",
        "identify robot.toml none.csv",
        "identify robot.toml .",
        "identify robot.toml measurements.csv --lambda much",
        "identify robot.toml measurements.csv --lambda -1",
        "identify robot.toml measurements.csv --lambda 1e31",
        "diagnose robot.toml measurements.csv --highest-order nan",
        "diagnose robot.toml measurements.csv --highest-order -5",
        "diagnose robot.toml measurements.csv --highest-order 2001",
        "diagnose robot.toml measurements.csv --most-terms 0",
        "evaluate robot.toml measurements.csv",
        "evaluate in-force.blob measurements.csv",
        "evaluate headless.toml measurements.csv",
        "identify model.toml cell.csv",
        "check model.toml cell.csv",
        "identify slip.toml cell.csv",
        "identify stray.toml cell.csv",
        "fleet robot.toml",
        "pack model.toml --out new.blob --marker foo",
        "pack robot.toml --out new.blob --sequence -1",
        "diff in-force.blob in-force.blob --poses 0",
        "verify model.toml --test-poses t.csv --poses -1",
    ]
    .iter()
    .map(|line| format!("$ truearm {line}\n{}", says(&folder, line)))
    .collect();
    insta::assert_snapshot!("errors", said.join("\n"));
}
