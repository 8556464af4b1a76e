//! What may be written over: files that truearm wrote, of the same robot. The
//! rest needs --force.

use std::path::Path;

use truearm::blob::Blob;
use truearm_host::model::Model;
use truearm_host::page::BEGIN;
use truearm_host::{Error, Result};

/// Robot id of a model, as its blob has it.
fn id(model: &Model) -> u64 {
    let named = || truearm::blob::robot_id(&model.robot.name, &model.robot.serial);
    model.robot_id.unwrap_or_else(named)
}

/// Whether a file of a model's folder may be written over.
///
/// # Errors
/// A file that truearm did not write, and a model of another robot.
pub fn in_folder(folder: &Path, model: &Model, force: bool) -> Result<()> {
    if force {
        return Ok(());
    }
    for (name, begin) in [
        ("report.json", "{\n  \"schema\": \"truearm-"),
        ("residuals.csv", "row,line,"),
        ("report.html", BEGIN),
    ] {
        let path = folder.join(name);
        match std::fs::read(&path) {
            Ok(bytes) if !bytes.starts_with(begin.as_bytes()) => return Err(foreign(&path)),
            _ => {}
        }
    }
    model_file(&folder.join("model.toml"), model, force)
}

/// The same of a model.toml by itself.
///
/// # Errors
/// As for [`in_folder`].
pub fn model_file(path: &Path, model: &Model, force: bool) -> Result<()> {
    if force || !path.is_file() {
        return Ok(());
    }
    match Model::read(path) {
        Ok(old) if id(&old) == id(model) => Ok(()),
        Ok(old) => Err(other(path, &format!("{} {}", old.robot.name, old.robot.serial))),
        Err(_) => Err(foreign(path)),
    }
}

/// Whether a blob may be written over one that is there: only where that is of
/// the same robot. Other formats cannot be told from what others wrote.
///
/// # Errors
/// As for [`in_folder`].
pub fn blob_file(path: &Path, model: &Model, force: bool) -> Result<()> {
    if force || !path.is_file() {
        return Ok(());
    }
    let Ok(bytes) = std::fs::read(path) else { return Ok(()) };
    match Blob::check(&bytes) {
        Ok(old) if old.robot_id() == id(model) => Ok(()),
        Ok(old) => Err(other(path, &format!("with the id {:#018x}", old.robot_id()))),
        Err(_) if bytes.is_empty() => Ok(()),
        Err(_) => Err(foreign(path)),
    }
}

fn foreign(path: &Path) -> Error {
    Error::usage(
        format!("{} is there and not of truearm's making", path.display()),
        "write elsewhere, or over it with --force",
    )
}

fn other(path: &Path, robot: &str) -> Error {
    Error::usage(
        format!("{} is of another robot: {}", path.display(), robot.trim()),
        "write elsewhere, or over it with --force",
    )
}
