//! The Python package: its wheel, and its tests and its notebook in a bare environment.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::run::{Result, call, root, step, target_dir};

const PYTHON: &str = "python3";

/// The package's folder, a workspace of its own.
pub fn directory() -> PathBuf {
    root().join("host-tools/python")
}

/// Whether there is a Python that makes environments.
pub fn found() -> bool {
    let made = Command::new(PYTHON).args(["-m", "venv", "--help"]).output();
    made.is_ok_and(|output| output.status.success())
}

/// How packages are installed.
pub const PIP: [&str; 5] = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];

/// Built as tests are: what users install is compiled longer and does the same.
pub fn run() -> Result {
    let tester = built("dev")?;
    step("tests of the wheel", || {
        call(Command::new(&tester).arg(directory().join("tests/test_truearm.py")))
    })?;
    // As a script, and without figures: matplotlib is not there.
    step("notebook", || call(Command::new(&tester).arg(directory().join("notebooks/ur10.py"))))?;
    step("tables of pandas", || {
        call(Command::new(&tester).args(PIP).arg("pandas>=2"))?;
        call(Command::new(&tester).arg(directory().join("tests/test_pandas.py")))
    })
}

/// The wheel as users have it, built and installed in a bare environment; its Python.
pub fn installed() -> Result<PathBuf> {
    built("release")
}

fn built(profile: &str) -> Result<PathBuf> {
    if !found() {
        return Err("no python3 with venv: install Debian's python3-venv".into());
    }
    let [build, bare] = ["build", "bare"].map(|name| target_dir().join("python").join(name));
    let wheels = target_dir().join("python/wheels");
    for place in [&bare, &wheels] {
        // Of an earlier run.
        let _ = fs::remove_dir_all(place);
    }
    for place in [&build, &bare] {
        call(Command::new(PYTHON).args(["-m", "venv"]).arg(place))?;
    }
    let [builder, tester] = [&build, &bare].map(|place| place.join("bin/python"));
    step("wheel", || {
        call(Command::new(&builder).args(PIP).arg("maturin>=1.9,<2"))?;
        let mut wheel = Command::new(build.join("bin/maturin"));
        wheel.current_dir(directory()).args(["build", "--profile", profile, "--out"]);
        call(wheel.arg(&wheels).arg("--target-dir").arg(target_dir()))?;
        let wheel = fs::read_dir(&wheels)?.next().ok_or("no wheel was built")??.path();
        call(Command::new(&tester).args(PIP).arg(wheel))
    })?;
    Ok(tester)
}
