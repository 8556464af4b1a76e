//! `cargo xtask ci`: what a change must pass.

use std::path::Path;
use std::process::Stdio;

use crate::image::directory;
use crate::run::{Result, call, cargo, root, step};
use crate::{c, counts, package, pages, python, test, tools};

/// Every workspace.
const LOCKED: [&str; 5] = [".", "tests/firmware", "capi", "fuzz", "host-tools/python"];

/// Whether the lock file of a workspace is up to date.
fn locked(workspace: &Path) -> Result {
    let mut metadata = cargo(workspace, "metadata --locked --format-version 1");
    call(metadata.stdout(Stdio::null()))
}

pub fn run() -> Result {
    tools::ensure()?;
    let places = [
        ("the workspace", root()),
        ("the firmware", directory()),
        ("the C library", c::directory()),
    ];
    // Before anything is built: a stale lock file would end the run at the workspace built last.
    step("lock files", || LOCKED.iter().try_for_each(|place| locked(&root().join(place))))?;
    for (name, dir) in &places {
        step(&format!("format of {name}"), || call(&mut cargo(dir, "fmt --all --check")))?;
    }
    for (name, dir) in &places {
        step(&format!("lints of {name}"), || {
            call(&mut cargo(dir, "clippy --workspace --all-targets -- -D warnings"))
        })?;
    }
    step("format of the Python package", || {
        call(&mut cargo(&python::directory(), "fmt --all --check"))
    })?;
    test::run(true)?;
    counts::run()?;
    package::run()?;
    match python::found() {
        true => python::run()?,
        false => eprintln!("\nno python3 with venv: the wheel is not built"),
    }
    pages::run(&[])
}
