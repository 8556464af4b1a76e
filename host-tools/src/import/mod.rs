//! Measurement files as they come, to `measurements.csv`.
//!
//! `decode` (bytes to text), `sniff` (cells), `layout` (headings, units, data)
//! make a `Table`; `guess` says what its columns mean, or [`ImportOptions`] and an
//! `import.toml` do; `join` puts files together, `convert` writes. Every guess has
//! its evidence, and what cannot be told is an error that names the flag.

mod agreement;
mod clock;
mod config;
mod convert;
mod decode;
mod fixed;
mod footer;
mod guess;
mod join;
mod key;
mod labels;
mod layout;
mod native;
mod number;
mod options;
mod record;
mod sniff;
mod spreadsheet;
mod suffix;
mod table;
mod turn;

use std::path::{Path, PathBuf};

use crate::error::{Error, Place, Result};
use crate::model::{Measurements, Robot};
pub use config::FileConfig;
use config::{Config, Join, Pick};
pub use options::{ImportOptions, JoinAsked};
pub use record::{Imported, ImportedColumn, ImportedFile};
use table::Table;

/// Reads files and says what they hold; `config` is path and text of an
/// import.toml that settles everything.
///
/// # Errors
/// What is no table, what is missing, and what cannot be told, with the flag
/// that settles it.
pub fn import(
    paths: &[PathBuf],
    robot: Option<&Robot>,
    config: Option<(&Path, &str)>,
    options: &ImportOptions,
) -> Result<Imported> {
    let settled = config.map(|(path, text)| Ok((path, Config::parse(path, text)?))).transpose()?;
    if let Some((path, settled)) = settled.as_ref().filter(|(_, s)| s.files.len() != paths.len()) {
        let message =
            format!("{} files, but {} is for {}", paths.len(), path.display(), settled.files.len());
        return Err(Error::usage(
            message,
            "give the files in the order they had when it was written",
        ));
    }
    let written = |file: usize| settled.as_ref().map_or(&options.written, |(_, s)| &s.files[file]);
    let tables: Vec<Table> = paths
        .iter()
        .enumerate()
        .map(|(i, path)| Table::read(path, written(i)))
        .collect::<Result<_>>()?;
    let mut warnings: Vec<String> = tables.iter().flat_map(|t| t.warnings.clone()).collect();
    let config = match settled {
        Some((path, settled)) => {
            fits(path, &settled, &tables, robot)?;
            let clues = guess::Clues { tables: &tables, robot, options };
            warnings.extend(guess::contradicted(&clues, &settled)?);
            settled
        }
        None => guess::guess(&guess::Clues { tables: &tables, robot, options }, &mut warnings)?,
    };
    let mut imported = converted(&tables, &config, options, warnings)?;
    imported.warnings.extend(robot.and_then(|robot| refused(&imported.csv, robot)));
    Ok(imported)
}

/// A remark where the reader of a measurements.csv refuses what was written.
fn refused(csv: &str, robot: &Robot) -> Option<String> {
    let error = Measurements::parse(Path::new("measurements.csv"), csv, robot).err()?;
    Some(format!("as it is, other verbs refuse it: {error}; {}", error.help()))
}

fn converted(
    tables: &[Table],
    config: &Config,
    options: &ImportOptions,
    mut warnings: Vec<String>,
) -> Result<Imported> {
    let base = config.file_of_what_was_measured();
    // Said once: the guess joined the same rows.
    let mut said = Vec::new();
    let mut rows = join::rows(tables, &config.join, base, &mut said)?;
    // The arm moved in the order of its own file.
    if let (Join::Key(_), Some(moved)) = (&config.join, config.columns.get("q1")) {
        rows.sort_by_key(|row| (row.rows[moved.file], row.rows[base]));
    }
    warnings.extend(said.into_iter().filter(|w| !warnings.contains(w)).collect::<Vec<_>>());
    let done = convert::convert(tables, config, &rows, options.skip_incomplete)?;
    warnings.extend(done.remarks());
    if done.rows == 0 {
        let help = "every row lacks a joint or a coordinate: are the columns the right ones?";
        return Err(Error::file(&tables[0].path, Place::default(), "no row is complete", help));
    }
    let file = |(table, evidence): (&Table, &Vec<String>)| ImportedFile {
        written: FileConfig { file: table.path.display().to_string(), ..table.settled.clone() },
        rows: table.rows.len(),
        because: evidence.clone(),
    };
    let column = |(to, pick): (&String, &Pick)| ImportedColumn {
        to: to.clone(),
        file: pick.file + 1,
        column: pick.column + 1,
        name: pick.name.clone(),
        unit: convert::unit_word(pick.unit).map(str::to_owned),
        because: pick.because.clone(),
    };
    Ok(Imported {
        csv: done.csv,
        config: config.to_toml(),
        rows: done.rows,
        poses: done.poses,
        files: tables.iter().zip(&config.evidence).map(file).collect(),
        join: (tables.len() > 1).then(|| {
            let how = match &config.join {
                Join::Order => "row by row",
                Join::Key(_) => "on a key",
                Join::Stack => "one below the other",
            };
            format!("{how}, because {}", config.join_because)
        }),
        columns: config.ordered().into_iter().map(column).collect(),
        left_out: left_out(tables, config),
        warnings,
    })
}

/// Columns with a heading that nothing was made of.
fn left_out(tables: &[Table], config: &Config) -> Vec<String> {
    let mut names = Vec::new();
    for (file, table) in tables.iter().enumerate() {
        let picked = |column: usize| {
            let key = matches!(&config.join, Join::Key(keys) if keys.get(file) == Some(&column));
            let of =
                |p: &Pick| p.column == column && (p.file == file || config.join == Join::Stack);
            key || config.columns.values().any(of)
        };
        let free = (0..table.headings.len())
            .filter(|c| !picked(*c) && !table.headings[*c].text.is_empty());
        names.extend(free.map(|c| table.headings[c].text.clone()));
    }
    names
}

/// Whether an import.toml is of such files and of such an arm.
fn fits(path: &Path, config: &Config, tables: &[Table], robot: Option<&Robot>) -> Result<()> {
    let fail = |message: String| {
        let help = "import without --config to guess anew, or mend import.toml";
        Err(Error::file(path, Place::default(), message, help))
    };
    for (to, pick) in config.ordered() {
        if !config::is_name(to) {
            return fail(format!("{to} is no column of measurements.csv"));
        }
        let table = &tables[pick.file];
        match table.headings.get(pick.column) {
            None => {
                return fail(format!(
                    "{to}: {} has no column {}",
                    table.path.display(),
                    pick.column + 1
                ));
            }
            Some(heading) if heading.text != pick.name => {
                return fail(format!(
                    "{to}: {} is \"{}\" here and \"{}\" in {}",
                    config::called(pick),
                    pick.name,
                    heading.text,
                    table.path.display()
                ));
            }
            Some(_) => {}
        }
    }
    let (joints, wanted) = (config.joints().len(), robot.map(|r| r.joints.len()));
    let axes = ["x", "y", "z"].iter().filter(|axis| config.columns.contains_key(**axis)).count();
    // Rows that say another kind need no point.
    let pointed = axes == 3 || axes == 0 && config.columns.contains_key("kind");
    if joints == 0 || !pointed {
        return fail("q1.. and x, y, z must be there".to_owned());
    }
    match wanted {
        Some(n) if n != joints => fail(format!("{joints} joints, but the robot has {n}")),
        _ => Ok(()),
    }
}
