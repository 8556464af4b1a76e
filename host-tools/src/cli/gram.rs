use std::collections::HashMap;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use truearm_host::error::{Place, count};
use truearm_host::files::{Pieces, foreign, write};
use truearm_host::gram::{LARGE, Part, accumulate, is_part, step};
use truearm_host::model::{Measurements, Model};
use truearm_host::report::{GramReport, to_json};
use truearm_host::{Error, Result};

use super::{Said, overwrite, warn, words};

/// Identify by parts, on many machines: sums of each part, merged, and one solve a round.
#[derive(Args)]
pub struct Gram {
    #[command(subcommand)]
    part: Round,
}

/// A round.
#[derive(Subcommand)]
enum Round {
    /// Sum what some rows say at a state: a small file, however many rows there are
    Add(Add),
    /// Sums of what several files say; the order does not matter
    Merge(Merge),
    /// Solve for the next state, and say whether it is settled
    Step(Next),
}

#[derive(Args)]
struct Add {
    /// model.toml of `identify` of some of the rows, which knows every station and marker, or of
    /// the `gram step` before
    state: PathBuf,
    /// Measured points, measurements.csv, one file after the other
    #[arg(required = true)]
    data: Vec<PathBuf>,
    /// The .gram file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write over a file that is no .gram
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct Merge {
    /// Files of `gram add` or `gram merge`, at one state
    #[arg(required = true)]
    grams: Vec<PathBuf>,
    /// The .gram file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write over a file that is no .gram
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct Next {
    /// The state that the files were made at
    state: PathBuf,
    /// Files of `gram add` or `gram merge`
    #[arg(required = true)]
    grams: Vec<PathBuf>,
    /// The model.toml to write: the next state, and once settled the identified arm
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write over a file that truearm did not write, or of another robot
    #[arg(long)]
    force: bool,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

impl Gram {
    pub fn run(self) -> Result<Said> {
        match self.part {
            Round::Add(add) => add.run(),
            Round::Merge(merge) => merge.run(),
            Round::Step(next) => next.run(),
        }
    }
}

impl Add {
    fn run(self) -> Result<Said> {
        let inputs = std::iter::once(&self.state).chain(&self.data);
        overwrite::apart([self.out.as_path()], inputs.map(PathBuf::as_path))?;
        let state = Model::read(&self.state)?;
        // File by file: no more than one is in memory, and of a large one a piece. What bends an
        // arm may hang on the rows before.
        let rigid = state.terms.is_empty() && state.curves.is_empty();
        let add = |path: &PathBuf| {
            if rigid && Pieces::more_than(LARGE, &[path])? {
                let rows = Pieces::of(&[path], &state.robot)?;
                return rows.fold(&|data| accumulate(&state, &data), &|a, b| a.beside(&b));
            }
            let data = Measurements::read(path, &state.robot)?;
            warn(&data.warnings);
            accumulate(&state, &data)
        };
        save(&self.out, &sum(&self.data, add)?, self.force)
    }
}

impl Merge {
    fn run(self) -> Result<Said> {
        // One that holds the others already would count them twice.
        overwrite::apart([self.out.as_path()], self.grams.iter().map(PathBuf::as_path))?;
        save(&self.out, &sum(&self.grams, read)?, self.force)
    }
}

impl Next {
    fn run(self) -> Result<Said> {
        // The state may go on in its place: that is what a round is for.
        overwrite::apart([self.out.as_path()], self.grams.iter().map(PathBuf::as_path))?;
        let state = Model::read(&self.state)?;
        let sums = sum(&self.grams, read)?;
        let next = step(&state, &sums)?;
        let text = next.model.to_sound_toml()?;
        overwrite::model_file(&self.out, &next.model, self.force)?;
        write(&self.out, text.as_bytes())?;
        let report = GramReport::new(&next, &sums);
        if self.json {
            return Ok(to_json(&report).into());
        }
        let wrote = format!("wrote {}\n", self.out.display());
        Ok((words::gram(&report) + &wrote).into())
    }
}

/// All of them together.
fn sum(paths: &[PathBuf], part: impl Fn(&PathBuf) -> Result<Part>) -> Result<Part> {
    // Which file holds a part; a merged one holds several.
    let mut holders: HashMap<u64, &PathBuf> = HashMap::new();
    let mut parts = paths.iter().map(|path| {
        let part = part(path)?;
        for digest in part.sources() {
            if let Some(same) = holders.insert(digest, path) {
                let (path, same) = (path.display(), same.display());
                return Err(Error::usage(
                    format!("{path} holds a part that {same} holds: its rows would count twice"),
                    "give every part once, by itself or in a merged one",
                ));
            }
        }
        Ok((path, part))
    });
    let none = || Error::usage("no file", "give one");
    let (_, first) = parts.next().ok_or_else(none)??;
    parts.try_fold(first, |sum, next: Result<(&PathBuf, Part)>| {
        let (path, part) = next?;
        let named = |e: Error| {
            Error::data(e.kind(), format!("{}: {e}", path.display()), e.help().to_owned())
        };
        sum.plus(&part).map_err(named)
    })
}

fn read(path: &PathBuf) -> Result<Part> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let help = "give what `truearm gram add` or `truearm gram merge` wrote";
    Part::from_bytes(&bytes).map_err(|e| Error::file(path, Place::default(), e.to_string(), help))
}

/// Writes sums and says what they are of.
fn save(path: &Path, sums: &Part, force: bool) -> Result<Said> {
    if !force && path.is_file() {
        let stands = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        if !stands.is_empty() && !is_part(&stands) {
            return Err(foreign(path));
        }
    }
    write(path, &sums.to_bytes())?;
    let (files, rows) = (count(sums.files() as usize, "file"), count(sums.rows() as usize, "row"));
    let flagged = match sums.flagged() {
        0 => String::new(),
        n => format!(", {n} of which do not count"),
    };
    Ok(format!("{files}, {rows}{flagged}\nwrote {}\n", path.display()).into())
}
