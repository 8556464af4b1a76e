//! The command line: one file a subcommand, each a thin layer over the library.

mod arm_file;
mod check;
mod compare;
mod compensate;
mod completions;
mod console;
mod diagnose;
mod diff;
mod evaluate;
mod exit_status;
mod export;
mod fk;
mod fleet;
mod gram;
mod identify;
mod ik;
mod import;
mod inspect;
mod man;
mod markdown;
mod overwrite;
mod pack;
mod page;
mod plan;
mod progress;
mod robot;
mod rows;
mod shown;
mod unpack;
mod verify;
mod words;
mod workspace;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::{CommandFactory, Parser, Subcommand};
use truearm::blob::{AcceptanceError, Blob};
use truearm_host::blob::explain;
use truearm_host::check::explained;
use truearm_host::files::write_all;
use truearm_host::identify::allowing;
use truearm_host::model::{Measurements, Model, Robot};
use truearm_host::page::Page;
use truearm_host::report::to_json;
use truearm_host::{Error, ErrorKind, Result};

use console::{Said, warn};
use exit_status::End;

/// How many there are to be of something.
fn count(text: &str) -> std::result::Result<usize, String> {
    const MOST: usize = 1_000_000;
    let given = text.parse().ok().filter(|count| (1..=MOST).contains(count));
    given.ok_or_else(|| format!("give a whole number from 1 to {MOST}"))
}

/// Identify the true geometry of a robot arm from tracker measurements.
#[derive(Parser)]
#[command(name = "truearm", version, arg_required_else_help = true, after_help = exit_status::TABLE)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
    /// Say nothing but errors, and JSON where it is asked for
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Say on standard error how long it took, and with which version
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    verbose: bool,
}

#[derive(Subcommand)]
enum Verb {
    Robot(robot::MakeRobot),
    Import(import::Import),
    Identify(identify::Identify),
    Diagnose(diagnose::Diagnose),
    Evaluate(evaluate::Evaluate),
    Fleet(fleet::Fleet),
    Gram(gram::Gram),
    Check(check::Check),
    Compare(compare::Compare),
    Pack(pack::Pack),
    Inspect(inspect::Inspect),
    Diff(diff::Diff),
    Unpack(unpack::Unpack),
    Plan(plan::Plan),
    Verify(verify::Verify),
    Export(export::Export),
    Completions(completions::Completions),
    Man(man::Manual),
    Fk(fk::Fk),
    Ik(ik::Ik),
    Compensate(compensate::Compensate),
}

/// Runs the verb of the command line; the exit status.
pub fn run() -> ExitCode {
    match Cli::try_parse() {
        Ok(cli) => {
            let (start, verbose) = (Instant::now(), cli.verbose);
            console::set_quiet(cli.quiet);
            let status = console::finish(cli.run());
            if verbose {
                console::took(start.elapsed());
            }
            status
        }
        Err(error) => console::usage(&error),
    }
}

impl Cli {
    fn run(self) -> Result<Said> {
        match self.verb {
            Verb::Robot(verb) => verb.run(),
            Verb::Import(verb) => verb.run(),
            Verb::Identify(verb) => verb.run(),
            Verb::Diagnose(verb) => verb.run(),
            Verb::Evaluate(verb) => verb.run(),
            Verb::Fleet(verb) => verb.run(),
            Verb::Gram(verb) => verb.run(),
            Verb::Check(verb) => verb.run(),
            Verb::Compare(verb) => verb.run(),
            Verb::Pack(verb) => verb.run(),
            Verb::Inspect(verb) => verb.run(),
            Verb::Diff(verb) => verb.run(),
            Verb::Unpack(verb) => verb.run(),
            Verb::Plan(verb) => verb.run(),
            Verb::Verify(verb) => verb.run(),
            Verb::Export(verb) => verb.run(),
            Verb::Completions(verb) => verb.run(Self::command()),
            Verb::Man(verb) => verb.run(Self::command()),
            Verb::Fk(verb) => verb.run(),
            Verb::Ik(verb) => verb.run(),
            Verb::Compensate(verb) => verb.run(),
        }
    }
}

/// Reads an arm and what was measured of it. What looks wrong in the first may
/// be why the second cannot be read: it is said before the error is.
fn read_both(robot: &Path, data: &Path) -> Result<(Robot, Measurements)> {
    let robot = Robot::read(robot)?;
    let data = Measurements::read(data, &robot).inspect_err(|_| warn(&robot.warnings))?;
    Ok((robot, data))
}

/// Reads an arm and files of what was measured of it, one behind the other.
fn read_all(robot: &Path, data: &[&PathBuf]) -> Result<(Robot, Measurements)> {
    let robot = Robot::read(robot)?;
    let data = all_of(data, &robot)?;
    Ok((robot, data))
}

/// The error of a fit, with what explains it. The warnings of the files come first: what looked
/// wrong there may be why.
fn failed(error: Error, robot: &Robot, data: &Measurements) -> Error {
    warn(&[robot.warnings.as_slice(), &data.warnings].concat());
    explained(error, robot, data)
}

/// The same of a verb that has `--allow-few-poses`.
fn failed_or_few(error: Error, robot: &Robot, data: &Measurements) -> Error {
    allowing(failed(error, robot, data), ALLOW_FEW)
}

/// How to go on with fewer equations than unknowns.
const ALLOW_FEW: &str = "--allow-few-poses";

/// Files of what was measured of an arm that is read.
fn all_of(data: &[&PathBuf], robot: &Robot) -> Result<Measurements> {
    let data = session(data.iter().copied(), robot).inspect_err(|_| warn(&robot.warnings))?;
    data.ok_or_else(|| {
        Error::usage("no file of measurements", "give one behind robot.toml, or by --data")
    })
}

/// Files of what was measured of an arm, one behind the other; `None` of none.
fn session<'p>(
    files: impl IntoIterator<Item = &'p PathBuf>,
    robot: &Robot,
) -> Result<Option<Measurements>> {
    files.into_iter().try_fold(None, |all: Option<Measurements>, file| {
        let read = Measurements::read(file, robot)?;
        Ok(Some(match all {
            Some(all) => all.joined(read, robot)?,
            None => read,
        }))
    })
}

/// Reads a file and takes it as a blob; what is wrong with it is explained.
fn read_blob(path: &Path) -> Result<Vec<u8>> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    match Blob::check(&bytes) {
        Ok(_) => Ok(bytes),
        Err(error) => Err(refused(path, &bytes, &error.into())),
    }
}

fn refused(path: &Path, bytes: &[u8], refusal: &AcceptanceError) -> Error {
    Error::data(
        ErrorKind::Refused,
        format!("{}: {refusal}", path.display()),
        explain(bytes, refusal),
    )
}

/// Writes the files of a folder, the page and its figures among them, and says the report as JSON or in words.
fn deliver(
    report: &impl serde::Serialize,
    words: impl FnOnce() -> String,
    as_json: bool,
    (folder, force): (Option<&Path>, bool),
    model: &Model,
    residuals: impl FnOnce() -> String,
    (pictures, figures): (impl FnOnce() -> Result<Page>, bool),
) -> Result<Said> {
    let json = to_json(report);
    let mut wrote = String::new();
    if let Some(folder) = folder {
        let text = model.to_sound_toml()?;
        overwrite::in_folder(folder, model, force)?;
        let mut made = page::page_files(&folder.join("report.html"), &pictures()?, figures)?;
        made.extend([
            (folder.join("model.toml"), text.into_bytes()),
            (folder.join("report.json"), json.clone().into_bytes()),
            (folder.join("residuals.csv"), residuals().into_bytes()),
        ]);
        write_all(&made)?;
        warn(overwrite::pictures_left_behind(folder, &made).as_slice());
        let files = folder.join("{model.toml,report.json,residuals.csv,report.html}");
        wrote = format!("wrote {}\n", files.display());
    }
    Ok(if as_json { json.into() } else { (words() + &wrote).into() })
}
