//! `cargo xtask ci`: what a change must pass.

use crate::image::directory;
use crate::run::{Result, call, cargo, root, step};
use crate::study::fuzz;
use crate::{c, package, proof, python, test, tools};

pub fn run() -> Result {
    tools::ensure()?;
    let places = [
        ("the workspace", root()),
        ("the firmware", directory()),
        ("the C library", c::directory()),
    ];
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
    test::run()?;
    proof::others()?;
    c::miri()?;
    package::run()?;
    step("figures as PNG", || {
        call(&mut cargo(&root(), "test -p truearm-host --features png --test png"))
    })?;
    match python::found() {
        true => python::run()?,
        false => eprintln!("\nno python3 with venv: the wheel is not built"),
    }
    // Of each target: half a minute for both.
    fuzz::run(&["-max_total_time=15".to_owned()])
}
