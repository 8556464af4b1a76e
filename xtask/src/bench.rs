//! `cargo xtask bench`: times of a pose as ratios to the scalar path, in one run.

use std::process::Command;

use crate::run::{Result, call, cargo, root, step, target_dir};

pub fn run() -> Result {
    step("build", || call(&mut cargo(&root(), "build --release --quiet -p truearm-batch")))?;
    call(&mut pinned(target_dir().join("release/truearm-batch-ratios")))
}

/// A program that stays on one core, the last, where there is `taskset`.
pub fn pinned(program: impl AsRef<std::ffi::OsStr>) -> Command {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if !crate::run::exists("taskset") {
        return Command::new(program);
    }
    let mut command = Command::new("taskset");
    command.arg("-c").arg((cores - 1).to_string()).arg(program);
    command
}
