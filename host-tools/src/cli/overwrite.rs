//! What may be written over: files that truearm wrote, of the same robot. The
//! rest needs --force; and nothing lets a verb write over what it reads.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use truearm::blob::Blob;
use truearm_host::error::{Place, listed};
use truearm_host::files::{ToWrite, foreign, overwritable, overwritable_like, writable, write};
use truearm_host::model::{Model, Robot};
use truearm_host::page::BEGIN;
use truearm_host::{Error, Result};

use super::rows::RESIDUALS;

/// Whether none of the outputs is a file that is read, by whatever name.
///
/// # Errors
/// The one that is, with or without --force.
pub fn apart<'o, 'i>(
    outputs: impl IntoIterator<Item = &'o Path>,
    inputs: impl IntoIterator<Item = &'i Path>,
) -> Result<()> {
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    let read: Vec<(&Path, PathBuf)> =
        inputs.into_iter().filter_map(|path| Some((path, real(path)?))).collect();
    for output in outputs {
        let Some(place) = real(output).filter(|place| place.is_file()) else { continue };
        if let Some((input, _)) = read.iter().find(|(_, read)| *read == place) {
            return Err(Error::usage(
                format!("{} is read: it would be written over", input.display()),
                "write elsewhere; --force is for other files",
            ));
        }
    }
    Ok(())
}

/// The same of files in a folder that is to be written; nothing where none is.
///
/// # Errors
/// As for [`apart`].
pub fn folder_apart<'a>(
    folder: Option<&Path>,
    names: &[&str],
    inputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<()> {
    let Some(folder) = folder else { return Ok(()) };
    let outputs: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    apart(outputs.iter().map(PathBuf::as_path), inputs.into_iter().map(PathBuf::as_path))
}

/// Whether pictures may be written beside a report: none stands there, or the
/// report that does is truearm's.
///
/// # Errors
/// The report, or the picture, that others made.
pub fn pictures(report: &Path, pictures: &[PathBuf], force: bool) -> Result<()> {
    overwritable(report, force)?;
    let there = pictures.iter().find(|picture| picture.is_file());
    match there.filter(|_| !force && !report.is_file()) {
        Some(picture) => Err(foreign(picture)),
        None => Ok(()),
    }
}

/// A remark on what of this sort is in a folder and was not written by this run: of an earlier
/// one, it is of another model.
pub fn left_behind<'a>(
    folder: &Path,
    own: impl Iterator<Item = &'a Path>,
    sort: impl Fn(&Path) -> bool,
) -> Option<String> {
    let own: HashSet<_> = own.filter_map(Path::file_name).collect();
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let others = entries.filter(|entry| sort(&entry.path())).map(|entry| entry.file_name());
    let others = others.filter(|name| !own.contains(name.as_os_str()));
    let mut others: Vec<String> = others.map(|n| n.to_string_lossy().into_owned()).collect();
    others.sort();
    let folder = folder.display();
    (!others.is_empty()).then(|| format!("{folder}: not of this run: {}", listed(&others)))
}

/// The same of pictures, beside what was written.
pub fn pictures_left_behind(folder: &Path, made: &[ToWrite]) -> Option<String> {
    let picture = |path: &Path| path.extension().is_some_and(|e| e == "svg" || e == "png");
    left_behind(folder, made.iter().map(|(path, _)| path.as_path()), picture)
}

/// Whether a page may be written here: what stands there is one of truearm's.
///
/// # Errors
/// A page of others.
pub fn page_file(path: &Path, force: bool) -> Result<()> {
    match std::fs::read(path) {
        Ok(bytes) if !force && !bytes.starts_with(BEGIN.as_bytes()) => Err(foreign(path)),
        _ => Ok(()),
    }
}

/// Writes a table or a program, if it may stand there.
///
/// # Errors
/// An input, or a file that this verb did not write, and what the system says.
pub fn write_like(path: &Path, text: &str, inputs: &[&Path], force: bool) -> Result<()> {
    apart([path], inputs.iter().copied())?;
    overwritable_like(path, text, force)?;
    write(path, text.as_bytes())
}

/// Robot id of a model, as its blob has it.
fn id(model: &Model) -> u64 {
    model.robot_id.unwrap_or_else(|| id_of(&model.robot))
}

/// The same of a model to be made.
fn id_of(robot: &Robot) -> u64 {
    truearm::blob::robot_id(&robot.name, &robot.serial)
}

/// Whether what is to be found of a robot may be written into a folder: asked before it is
/// looked for, which takes its time.
///
/// # Errors
/// As for [`in_folder`], and a folder in which nothing can be written.
pub fn folder_ready(folder: Option<&Path>, robot: &Robot, force: bool) -> Result<()> {
    let Some(folder) = folder else { return Ok(()) };
    of_robot(folder, id_of(robot), force)?;
    writable(folder)
}

/// What `identify` and `diagnose` write into a folder.
pub const MODEL_FOLDER: [&str; 3] = ["model.toml", "report.json", "residuals.csv"];

/// Whether a file of a model's folder may be written over.
///
/// # Errors
/// A file that truearm did not write, and a model of another robot.
pub fn in_folder(folder: &Path, model: &Model, force: bool) -> Result<()> {
    of_robot(folder, id(model), force)
}

fn of_robot(folder: &Path, robot: u64, force: bool) -> Result<()> {
    // Before anything is written: a new model never stands beside an old page.
    for name in MODEL_FOLDER.iter().chain(["report.html"].iter()) {
        let path = folder.join(name);
        if path.is_dir() {
            let help = "move the folder away, or write elsewhere";
            return Err(Error::file(&path, Place::default(), "a folder, not a file", help));
        }
    }
    if force {
        return Ok(());
    }
    page_file(&folder.join("report.html"), force)?;
    for (name, begins) in
        [("report.json", &["{\n  \"schema\": \"truearm-"][..]), ("residuals.csv", &RESIDUALS)]
    {
        let path = folder.join(name);
        let own = |bytes: &[u8]| begins.iter().any(|begin| bytes.starts_with(begin.as_bytes()));
        match std::fs::read(&path) {
            Ok(bytes) if !own(&bytes) => return Err(foreign(&path)),
            _ => {}
        }
    }
    model_of(&folder.join("model.toml"), robot, force)
}

/// The same of a model.toml by itself.
///
/// # Errors
/// As for [`in_folder`].
pub fn model_file(path: &Path, model: &Model, force: bool) -> Result<()> {
    model_of(path, id(model), force)
}

fn model_of(path: &Path, robot: u64, force: bool) -> Result<()> {
    if force || !path.is_file() {
        return Ok(());
    }
    match Model::read(path) {
        Ok(old) if id(&old) == robot => Ok(()),
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

fn other(path: &Path, robot: &str) -> Error {
    Error::file(
        path,
        Place::default(),
        format!("the file is of another robot: {}", robot.trim()),
        "write elsewhere, or over it with --force",
    )
}
