//! Child processes, steps and places that all verbs share.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// What a verb returns; the message goes to the user as it is.
pub type Result<T = ()> = std::result::Result<T, Box<dyn Error>>;

/// The repository.
pub fn root() -> PathBuf {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask).to_path_buf()
}

/// Where cargo puts what it builds.
pub fn target_dir() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        // As cargo does: relative to where the user called it.
        Some(dir) => std::path::absolute(&dir).unwrap_or_else(|_| dir.into()),
        None => root().join("target"),
    }
}

/// Announces a step, puts its name before its error, and says how long it took.
pub fn step<T>(name: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    eprintln!("\n== {name}");
    let start = Instant::now();
    let done = work().map_err(|error| format!("{name}: {error}"))?;
    eprintln!("-- {name}: {:.0} s", start.elapsed().as_secs_f64());
    Ok(done)
}

/// `cargo` with these arguments, to be run in `dir`.
pub fn cargo(dir: &Path, arguments: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(dir).args(arguments.split_whitespace());
    if std::env::var_os("CARGO_TARGET_DIR").is_some() {
        // A relative one means another place in another directory.
        command.env("CARGO_TARGET_DIR", target_dir());
    }
    command
}

/// The program that users have, built with what xtask and the tests share: alone it would
/// be compiled anew, with other features of the crates below it.
pub fn program() -> Result<Command> {
    let packages = "build --quiet --package xtask --package truearm-host --bin truearm";
    call(&mut cargo(&root(), packages))?;
    Ok(Command::new(target_dir().join("debug/truearm")))
}

/// Runs a command with inherited output; any status but 0 is an error.
pub fn call(command: &mut Command) -> Result {
    let line = shown(command);
    let status = command.status().map_err(|error| format!("`{line}`: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("`{line}`: {status}").into()) }
}

/// The command as one would type it.
pub fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(|word| word.to_string_lossy()).collect();
    words.join(" ")
}

/// Whether a program can be started at all.
pub fn exists(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}
