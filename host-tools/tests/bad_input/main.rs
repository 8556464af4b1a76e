//! What the program guards its user against: losing files, numbers that are none,
//! input that makes no sense, tables that would take for ever.

mod bounds;
mod fits;
mod in_silence;
mod mutate;
mod mutations;
mod overwriting;
mod remarks;
mod small_arms;
mod stated;
mod table;
mod too_little;
mod twins;
mod wide;

use std::fs;
use std::path::Path;

use tempfile::TempDir;

/// Status and what was said, with line breaks undone.
fn run(folder: &TempDir, line: &str) -> (i32, String) {
    let mut command = assert_cmd::Command::cargo_bin("truearm").unwrap();
    let ran =
        command.current_dir(folder).args(line.split(' ')).env("COLUMNS", "1000").output().unwrap();
    let text = String::from_utf8([ran.stdout, ran.stderr].concat()).unwrap();
    assert!(!text.contains("panicked"), "{line}: {text}");
    let text = text.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ");
    (ran.status.code().unwrap(), text)
}

/// A folder with the robot and the measurements of the paper's points.
fn table_8() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/seed-table-8");
    for name in ["robot.toml", "measurements.csv"] {
        fs::copy(data.join(name), folder.path().join(name)).unwrap();
    }
    folder
}

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap();
}

fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).unwrap()
}
