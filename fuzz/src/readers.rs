//! Bytes as the files that users bring. The first says which reader has them; none may
//! panic, and what one writes the next must read.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use truearm_host::convert::table::{Convention, Units, robot_of_table};
use truearm_host::convert::urdf::{Ends, robot_of_urdf};
use truearm_host::files::Wanted;
use truearm_host::import::{ImportOptions, import};
use truearm_host::model::{Commanded, Measurements, Model, Path as Rows, Robot};

/// Readers, in the order of the first byte.
const READERS: [fn(&[u8]); 8] =
    [robot, measurements, instruments, path, commanded, model, urdf_or_table, imported];

/// Bytes of one file.
pub fn readers(data: &[u8]) {
    if let Some((which, bytes)) = data.split_first() {
        READERS[usize::from(*which) % READERS.len()](bytes);
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn robot(bytes: &[u8]) {
    let _ = Robot::parse(Path::new("robot.toml"), &text(bytes));
}

fn measurements(bytes: &[u8]) {
    let _ = Measurements::parse(Path::new("m.csv"), &text(bytes), &known());
}

/// An instruments.toml beside touched holes.
fn instruments(bytes: &[u8]) {
    let rows: Vec<&str> =
        include_str!("../../host-tools/examples/instruments/holes.csv").lines().take(5).collect();
    let _ = Measurements::parse_with(Path::new("m.csv"), &rows.join("\n"), &known(), &text(bytes));
}

fn path(bytes: &[u8]) {
    let _ = Rows::parse(Path::new("path.csv"), &text(bytes), &known(), Wanted::Either);
}

fn commanded(bytes: &[u8]) {
    let _ = Commanded::parse(Path::new("commanded.csv"), &text(bytes), &known());
}

fn model(bytes: &[u8]) {
    let file = written("model.toml", bytes);
    let Ok(model) = Model::read(&file) else { return };
    let again = written("again.toml", model.to_toml().as_bytes());
    assert!(Model::read(&again).is_ok(), "what was read can be written");
}

fn urdf_or_table(bytes: &[u8]) {
    let Some((which, bytes)) = bytes.split_first() else { return };
    let text = match which % 3 {
        0 => robot_of_urdf(&written("arm.urdf", bytes), &Ends::default()).map(|found| found.text),
        1 => robot_of_table(&written("dh.csv", bytes), Convention::Standard, &Units::default()),
        _ => robot_of_table(&written("dh.csv", bytes), Convention::Modified, &Units::default()),
    };
    if let Ok(text) = text {
        assert!(Robot::parse(Path::new("robot.toml"), &text).is_ok(), "{text}");
    }
}

fn imported(bytes: &[u8]) {
    let Some((which, bytes)) = bytes.split_first() else { return };
    let name = ["table.csv", "table.txt", "table.xlsx", "table.ods"][usize::from(which % 4)];
    let file = written(name, bytes);
    let robot = known();
    let found = import(&[file.clone()], Some(&robot), None, &ImportOptions::default());
    let Ok(found) = found else { return };
    let config = (Path::new("import.toml"), found.config.as_str());
    let again = import(&[file], Some(&robot), Some(config), &ImportOptions::default());
    assert_eq!(again.map(|a| a.csv).ok(), Some(found.csv), "{}", found.config);
}

/// The arm that all tables are of.
fn known() -> Robot {
    thread_local!(static ROBOT: OnceCell<Robot> = const { OnceCell::new() });
    let read = || {
        let text = include_str!("../../host-tools/examples/instruments/robot.toml");
        Robot::parse(Path::new("robot.toml"), text).expect("the shipped robot")
    };
    ROBOT.with(|robot| robot.get_or_init(read).clone())
}

/// A file of this process.
fn written(name: &str, bytes: &[u8]) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("truearm-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for files");
    let file = folder.join(name);
    std::fs::write(&file, bytes).expect("a file that is read");
    file
}
