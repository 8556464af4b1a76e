//! The controller's images: how they are built, where they are, and the command
//! that runs one under QEMU.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::qemu;
use crate::run::{Result, call, cargo, root, target_dir};
use crate::tools::TARGET;
use crate::vectors::{self, Files};

/// The function that does not exist, see `tests/firmware/src/bin/no_panic.rs`.
pub const PANIC_SYMBOL: &str = "truearm_panic_is_reachable";

/// An image that takes blobs with curves.
pub const CURVES: [&str; 2] = ["--features", "curves"];

/// The firmware's workspace. Its `.cargo/config.toml` counts only for a cargo
/// that runs here.
pub fn directory() -> PathBuf {
    root().join("tests/firmware")
}

/// A user's blob, with the vector file that the host computes for it.
pub fn files_for(blob: &Path) -> Result<Files> {
    let vectors = target_dir().join("firmware/other.vectors");
    fs::write(&vectors, vectors::for_blob(blob)?)?;
    Ok(Files { blob: std::path::absolute(blob)?, vectors })
}

/// Runs the image, which must have been built; what it printed.
pub fn run_image(files: &Files) -> Result<String> {
    let ended = qemu::run(&command(files)?, &directory())?;
    if ended.success { Ok(ended.output) } else { Err("the image found a fault".into()) }
}

/// Cargo building an image.
pub fn build(binary: &str) -> Command {
    build_in(&build_dir(), binary)
}

/// Cargo building an image for another target or at another optimisation level.
/// Each level has a target directory of its own.
pub fn build_for(target: &str, level: &str, binary: &str) -> Command {
    let mut command = build_in(&dir_of(level), binary);
    command.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", level).args(["--target", target]);
    command
}

/// Where images are built at this level.
pub fn dir_of(level: &str) -> PathBuf {
    if level == "3" { build_dir() } else { build_dir().join(level) }
}

/// Cargo building an image, in a target directory of its own.
pub fn build_in(dir: &Path, binary: &str) -> Command {
    build_of(dir, &format!("--bin {binary}"))
}

/// Cargo building what these arguments select.
pub fn build_of(dir: &Path, what: &str) -> Command {
    build_with("build", dir, what)
}

/// The same by another verb of cargo.
pub fn build_with(verb: &str, dir: &Path, what: &str) -> Command {
    let mut command = cargo(&directory(), &format!("{verb} --release --locked"));
    command.args(what.split(' ')).arg("--target-dir").arg(dir);
    // Would replace the flags of .cargo/config.toml, the linker script among them.
    command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    command
}

/// Where the image of this name is, once built.
pub fn image(binary: &str) -> PathBuf {
    image_in(&build_dir(), binary)
}

/// The same in another target directory.
pub fn image_in(dir: &Path, binary: &str) -> PathBuf {
    dir.join(TARGET).join("release").join(binary)
}

/// Where the images are built.
pub fn build_dir() -> PathBuf {
    target_dir().join("firmware")
}

/// The command that runs another binary on these files; builds it first.
pub fn command_of(binary: &str, files: &Files) -> Result<Vec<String>> {
    call(&mut build(binary))?;
    qemu_command(&image(binary), files)
}

/// The command that runs the image `firmware` on these files.
pub fn command(files: &Files) -> Result<Vec<String>> {
    qemu_command(&image("firmware"), files)
}

/// The runner of `.cargo/config.toml`, with this image, and with these files in
/// place of the shipped ones.
pub fn qemu_command(image: &Path, files: &Files) -> Result<Vec<String>> {
    let config = read_toml(&directory().join(".cargo/config.toml"))?;
    let runner = config
        .get("target")
        .and_then(|table| table.get(TARGET)?.get("runner")?.as_array())
        .ok_or("no runner in tests/firmware/.cargo/config.toml")?;
    let mut command: Vec<String> =
        runner.iter().filter_map(|word| Some(word.as_str()?.to_owned())).collect();
    command.push(image.display().to_string());
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

/// A file of the firmware's workspace.
pub fn read_toml(path: &Path) -> Result<toml::Table> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    text.parse().map_err(|error| format!("{}: {error}", path.display()).into())
}
