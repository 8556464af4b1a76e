use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use truearm_host::error::Place;
use truearm_host::files::{foreign, overwritable_like, read_text, write_all};
use truearm_host::headings::Unit;
use truearm_host::import::{FileConfig, ImportOptions, JoinAsked, import};
use truearm_host::model::Robot;
use truearm_host::report::{ImportReport, to_json};
use truearm_host::{Error, Result};

use super::{Said, overwrite, warn, words};

/// Turn measurement files as they come (CSV, TSV, columns, .xlsx, .ods; any
/// encoding, decimal commas) into measurements.csv, and write import.toml beside
/// it: what every column was taken for, and why.
#[derive(Args)]
pub struct Import {
    /// Tables of joints and measured points, one file or several
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The nominal arm, robot.toml: its limits, reach and lengths settle units
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// What an earlier import settled, import.toml
    #[arg(long, value_name = "FILE", conflicts_with_all = [
        "angles", "lengths", "columns", "orientation", "join", "encoding", "delimiter", "decimal",
        "header", "sheet",
    ])]
    config: Option<PathBuf>,
    /// The measurements.csv to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Unit of the joints that turn
    #[arg(long, value_enum)]
    angles: Option<Angles>,
    /// Unit of the points, and of joints that slide
    #[arg(long, value_enum)]
    lengths: Option<Lengths>,
    /// What columns mean: q1=J1,x="Pos X",station=2:Stand or q=1-6,xyz=7-9
    #[arg(long, value_name = "NAME=COLUMN,...", value_delimiter = ',')]
    columns: Vec<String>,
    /// How the target's orientation is given: none, xyzw, wxyz, rpy-deg,
    /// rpy-rad, vector-deg, vector-rad, matrix
    #[arg(long, value_name = "FORM")]
    orientation: Option<String>,
    /// How several files belong together: order, stack, the heading of a key, or
    /// ONE=OTHER where the files call it differently
    #[arg(long, value_name = "HOW")]
    join: Option<String>,
    /// Encoding of text files: utf-8, windows-1252, utf-16le, ...
    #[arg(long, value_name = "NAME")]
    encoding: Option<String>,
    /// What stands between cells: comma, semicolon, tab, bar, blanks
    #[arg(long, value_name = "SIGN")]
    delimiter: Option<String>,
    /// The decimal sign: point or comma
    #[arg(long, value_name = "SIGN")]
    decimal: Option<String>,
    /// Line of the headings, 0 if there are none
    #[arg(long, value_name = "LINE")]
    header: Option<usize>,
    /// Sheet of a spreadsheet
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// Leave rows out that lack a joint or a coordinate
    #[arg(long)]
    skip_incomplete: bool,
    /// Write over files that truearm did not write, and an import.toml that says
    /// something else
    #[arg(long)]
    force: bool,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Angles {
    Deg,
    Rad,
    Gon,
}

#[derive(Clone, Copy, ValueEnum)]
enum Lengths {
    Mm,
    M,
    Cm,
    Um,
    Inch,
    Foot,
}

impl Import {
    pub fn run(self) -> Result<Said> {
        let robot = self.robot.as_deref().map(Robot::read).transpose()?;
        let text = self.config.as_deref().map(read_text).transpose()?;
        let config = self.config.as_deref().zip(text.as_deref());
        let done = import(&self.files, robot.as_ref(), config, &self.options())?;
        let beside = self.out.with_file_name("import.toml");
        if self.config.is_none() && self.out == beside {
            let help = "give the table another name, as measurements.csv: import.toml beside it says how \
                        it was read";
            return Err(Error::usage("--out import.toml is the name of what says how", help));
        }
        let wrote = match &self.config {
            Some(path) => path.clone(),
            None => {
                self.keep(&beside, &done.config)?;
                beside
            }
        };
        self.spared(&wrote, &done.csv)?;
        let mut made = vec![(self.out.clone(), done.csv.clone().into_bytes())];
        if self.config.is_none() {
            made.push((wrote.clone(), done.config.clone().into_bytes()));
        }
        write_all(&made)?;
        let show = |path: &Path| path.display().to_string();
        let report = ImportReport::new(done, show(&self.out), show(&wrote));
        warn(&report.made.warnings);
        Ok(if self.json { to_json(&report) } else { words::import(&report) }.into())
    }

    /// No input is written over, and no measurements.csv but one that an import
    /// made: it has the same columns, and the import.toml that made it is there.
    fn spared(&self, config: &Path, csv: &str) -> Result<()> {
        let outputs = [self.out.as_path()].into_iter();
        let outputs = outputs.chain((self.config.is_none()).then_some(config));
        let inputs = self.files.iter().chain(&self.robot).chain(&self.config);
        overwrite::apart(outputs, inputs.map(PathBuf::as_path))?;
        overwritable_like(&self.out, csv, self.force)?;
        // A device may never end.
        if self.force || config.is_file() || !self.out.is_file() {
            return Ok(());
        }
        let same = std::fs::read(&self.out).is_ok_and(|old| old == csv.as_bytes());
        if same { Ok(()) } else { Err(foreign(&self.out)) }
    }

    /// An import.toml that somebody edited is not written over.
    fn keep(&self, path: &Path, text: &str) -> Result<()> {
        let old = std::fs::read(path).ok().filter(|old| old != text.as_bytes() && !self.force);
        match old {
            Some(_) => Err(Error::file(
                path,
                Place::default(),
                "the file says something else than would be written",
                format!("use it with --config {}, or write over it with --force", path.display()),
            )),
            None => Ok(()),
        }
    }

    fn options(&self) -> ImportOptions {
        ImportOptions {
            written: FileConfig {
                encoding: self.encoding.clone(),
                delimiter: self.delimiter.clone(),
                decimal: self.decimal.clone(),
                sheet: self.sheet.clone(),
                header_line: self.header,
                ..FileConfig::default()
            },
            angles: self.angles.map(|angles| match angles {
                Angles::Deg => Unit::Deg,
                Angles::Rad => Unit::Rad,
                Angles::Gon => Unit::Gon,
            }),
            lengths: self.lengths.map(|lengths| match lengths {
                Lengths::Mm => Unit::Mm,
                Lengths::M => Unit::M,
                Lengths::Cm => Unit::Cm,
                Lengths::Um => Unit::Um,
                Lengths::Inch => Unit::Inch,
                Lengths::Foot => Unit::Foot,
            }),
            columns: self.columns.clone(),
            orientation: self.orientation.clone(),
            join: match self.join.as_deref() {
                None => JoinAsked::Find,
                Some("order") => JoinAsked::Order,
                Some("stack") => JoinAsked::Stack,
                Some(key) => JoinAsked::Key(key.to_owned()),
            },
            skip_incomplete: self.skip_incomplete,
        }
    }
}
