//! `cargo xtask firmware`: the controller image, from build to budget.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::qemu::{self, TARGET};
use crate::run::{Result, call, cargo, root, step, target_dir};
use crate::vectors::{self, Files};
use crate::{refusals, reidentify, sigma};

/// The function that does not exist, see `tests/firmware/src/bin/no_panic.rs`.
const PANIC_SYMBOL: &str = "truearm_panic_is_reachable";

/// The firmware's workspace. Its `.cargo/config.toml` counts only for a cargo
/// that runs here.
pub fn directory() -> PathBuf {
    root().join("tests/firmware")
}

pub fn run(blob: Option<&Path>) -> Result {
    qemu::ensure_tools()?;
    step("build of the image", || call(&mut build("firmware")))?;
    step("proof that the tick path cannot panic", prove_no_panic)?;
    let files = match blob {
        Some(blob) => files_for(blob)?,
        None => vectors::shipped(),
    };
    let mut output = step("run under QEMU", || run_image(&files))?;
    output += &step("run with terms of every effect", || run_image(&vectors::shipped_terms()))?;
    output += &step("uncertainty of the tool point", sigma::check)?;
    output += &step("re-identification", reidentify::check)?;
    step("instruction budgets", || check_budgets(&output))?;
    step("slot B and refusals", || refusals::check(&qemu_command(&files)?))
}

/// A user's blob, with the vector file that the host computes for it.
pub fn files_for(blob: &Path) -> Result<Files> {
    let vectors = target_dir().join("firmware/other.vectors");
    fs::write(&vectors, vectors::for_blob(blob)?)?;
    Ok(Files { blob: std::path::absolute(blob)?, vectors })
}

/// Runs the image, which must have been built; what it printed.
pub fn run_image(files: &Files) -> Result<String> {
    let ended = qemu::run(&qemu_command(files)?, &directory())?;
    if ended.success { Ok(ended.output) } else { Err("the image found a fault".into()) }
}

/// Cargo building an image.
pub fn build(binary: &str) -> Command {
    let mut command = cargo(&directory(), "build --release --locked --bin");
    command.arg(binary).arg("--target-dir").arg(build_dir());
    // Would replace the flags of .cargo/config.toml, the linker script among them.
    command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    command
}

/// Where the image of this name is, once built.
pub fn image(binary: &str) -> PathBuf {
    build_dir().join(TARGET).join("release").join(binary)
}

fn build_dir() -> PathBuf {
    target_dir().join("firmware")
}

/// The proof must link, and must not link once there is a panic to reach.
fn prove_no_panic() -> Result {
    call(&mut build("no_panic"))?;
    let mut control = build("no_panic");
    let output = control.args(["--features", "negative_control"]).output()?;
    if output.status.success() {
        return Err("the negative control links: the proof proves nothing".into());
    }
    let message = String::from_utf8_lossy(&output.stderr);
    if !message.contains(PANIC_SYMBOL) {
        return Err(format!("the negative control failed for another reason:\n{message}").into());
    }
    eprintln!("it links; with a panic built in it does not ({PANIC_SYMBOL})");
    Ok(())
}

/// The command that runs another binary on these files; builds it first.
pub fn command_of(binary: &str, files: &Files) -> Result<Vec<String>> {
    call(&mut build(binary))?;
    let mut command = qemu_command(files)?;
    if let Some(word) = command.last_mut() {
        *word = image(binary).display().to_string();
    }
    Ok(command)
}

/// The runner of `.cargo/config.toml`, with the image, and with these files in
/// place of the shipped ones.
fn qemu_command(files: &Files) -> Result<Vec<String>> {
    let config = read_toml(&directory().join(".cargo/config.toml"))?;
    let runner = config
        .get("target")
        .and_then(|table| table.get(TARGET)?.get("runner")?.as_array())
        .ok_or("no runner in tests/firmware/.cargo/config.toml")?;
    let mut command: Vec<String> =
        runner.iter().filter_map(|word| Some(word.as_str()?.to_owned())).collect();
    command.push(image("firmware").display().to_string());
    for word in &mut command {
        if word.contains("/ur10.blob,") {
            *word = loading(word, &files.blob);
        } else if word.contains("/fk.vectors,") {
            *word = loading(word, &files.vectors);
        }
    }
    Ok(command)
}

/// A word `loader,file=OLD,addr=...` with another file.
pub fn loading(word: &str, file: &Path) -> String {
    let address = word.split_once(",addr=").map_or("", |(_, rest)| rest);
    // A lone comma would end the name.
    format!("loader,file={},addr={address}", file.display().to_string().replace(',', ",,"))
}

/// Holds the counts that the image printed against `budgets.toml`.
fn check_budgets(output: &str) -> Result {
    let budgets = read_toml(&directory().join("budgets.toml"))?;
    let compiler = Command::new("rustc").arg("--version").current_dir(directory()).output()?;
    let compiler = String::from_utf8_lossy(&compiler.stdout).trim().to_owned();
    let judged = budgets.get("rustc").and_then(toml::Value::as_str) == Some(&compiler);
    let limits = budgets.get("instructions").and_then(toml::Value::as_table);
    let mut over = Vec::new();
    for (work, limit) in limits.ok_or("no [instructions] in budgets.toml")? {
        let limit = limit.as_integer().ok_or_else(|| format!("{work}: not an integer"))?;
        let count = count(output, work).ok_or_else(|| format!("the image counted no {work}"))?;
        eprintln!("{work}: {count} of {limit} instructions");
        if count > limit as f64 {
            over.push(work.as_str());
        }
    }
    if !judged {
        eprintln!("not judged: the budgets are not for {compiler}");
    } else if !over.is_empty() {
        return Err(format!("over budget: {}", over.join(", ")).into());
    }
    Ok(())
}

/// From a line `instructions WORK COUNT`.
fn count(output: &str, work: &str) -> Option<f64> {
    output.lines().find_map(|line| {
        let rest = line.strip_prefix("instructions ")?.strip_prefix(work)?;
        rest.strip_prefix(' ')?.parse().ok()
    })
}

fn read_toml(path: &Path) -> Result<toml::Table> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    text.parse().map_err(|error| format!("{}: {error}", path.display()).into())
}
