//! `import.toml`: what every column means, with the evidence as comments.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Place, Result};
use crate::files::on_one_line;
use crate::headings::Unit;

use super::native::own;

/// The schema of the file.
const SCHEMA: &str = "truearm-import-config-1";

/// How a file is written; what is `None` is found.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FileConfig {
    /// The file it was made from; another of the same layout may be read.
    #[serde(default)]
    pub file: String,
    /// Encoding of a text, as WHATWG names it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoding: Option<String>,
    /// comma, semicolon, tab, bar or blanks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delimiter: Option<String>,
    /// point or comma.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decimal: Option<String>,
    /// Sheet of a spreadsheet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sheet: Option<String>,
    /// Line of the headings, counted from 1; 0 if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub header_line: Option<usize>,
    /// Line of the units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_line: Option<usize>,
    /// First line of data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data_line: Option<usize>,
}

/// Where a column of measurements.csv comes from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pick {
    /// Which file, from 0.
    pub file: usize,
    /// Which column, from 0.
    pub column: usize,
    /// Its heading; empty without.
    pub name: String,
    pub unit: Unit,
    /// What says so.
    pub because: String,
}

/// How several files become one table.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Join {
    /// Row by row.
    Order,
    /// Where a column of each has the same label; a column a file.
    Key(Vec<usize>),
    /// One below the other.
    Stack,
}

/// All of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Config {
    pub files: Vec<FileConfig>,
    /// Why the files are read so; lines a file.
    pub evidence: Vec<Vec<String>>,
    pub join: Join,
    pub join_because: String,
    /// By the name in truearm: q1.., x, y, z, station, qw, roll, r11 ...
    pub columns: BTreeMap<String, Pick>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConfigFile {
    schema: String,
    join: Option<String>,
    #[serde(default)]
    keys: Vec<usize>,
    files: Vec<FileConfig>,
    columns: BTreeMap<String, PickFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PickFile {
    #[serde(default = "first")]
    file: usize,
    column: usize,
    #[serde(default)]
    name: String,
    unit: Option<String>,
}

fn first() -> usize {
    1
}

const HELP: &str = "an import.toml is written by `truearm import FILE... --out measurements.csv`";

impl Config {
    /// The file whose rows are the rows: that says what was measured.
    #[must_use]
    pub(super) fn file_of_what_was_measured(&self) -> usize {
        self.columns.get("x").or(self.columns.get("kind")).map_or(0, |pick| pick.file)
    }

    /// Reads an import.toml.
    ///
    /// # Errors
    /// Names file, key and remedy.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let fail = |message: String| Error::file(path, Place::default(), message, HELP);
        let file: ConfigFile = toml::from_str(text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            Error::file(path, Place::offset(text, span.start), e.message(), HELP)
                .showing(text, span)
        })?;
        if file.schema != SCHEMA {
            return Err(fail(format!("schema {} where {SCHEMA} is read", file.schema)));
        }
        let mut columns = BTreeMap::new();
        for (to, pick) in file.columns {
            let unit = pick.unit.as_deref().map_or(Some(Unit::Plain), Unit::of_word);
            let unit = unit.ok_or_else(|| {
                fail(format!("{to}: unit \"{}\"", pick.unit.as_deref().unwrap_or_default()))
            })?;
            if pick.column == 0 || !(1..=file.files.len()).contains(&pick.file) {
                return Err(fail(format!("{to}: files and columns count from 1")));
            }
            let because = format!("{} says so", path.display());
            let pick = Pick {
                file: pick.file - 1,
                column: pick.column - 1,
                name: pick.name,
                unit,
                because,
            };
            columns.insert(to, pick);
        }
        let keys = file.keys.iter().map(|k| k.saturating_sub(1)).collect();
        let join = match file.join.as_deref() {
            Some("order") | None => Join::Order,
            Some("stack") => Join::Stack,
            Some("key") if file.keys.len() == file.files.len() => Join::Key(keys),
            Some("key") => {
                return Err(fail("join = \"key\" needs keys, a column a file".to_owned()));
            }
            Some(other) => {
                return Err(fail(format!("join = \"{other}\" is not order, key or stack")));
            }
        };
        let evidence = vec![Vec::new(); file.files.len()];
        let join_because = format!("{} says so", path.display());
        Ok(Self { files: file.files, evidence, join, join_because, columns })
    }

    /// As a text, each guess with its evidence above it.
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# How `truearm import` reads these files; edit what is wrong, then import again with\n\
             # --config and this file. Lines, columns and files count from 1.\n",
        );
        let mut line = |what: String| text += &(what + "\n");
        line(format!("schema = \"{SCHEMA}\""));
        if self.files.len() > 1 {
            line(format!("# {}", on_one_line(&self.join_because)));
            match &self.join {
                Join::Order => line("join = \"order\"".to_owned()),
                Join::Stack => line("join = \"stack\"".to_owned()),
                Join::Key(keys) => {
                    let keys: Vec<usize> = keys.iter().map(|k| k + 1).collect();
                    line(format!("join = \"key\"\nkeys = {keys:?}"));
                }
            }
        }
        for (file, evidence) in self.files.iter().zip(&self.evidence) {
            line("\n[[files]]".to_owned());
            evidence.iter().for_each(|why| line(format!("# {}", on_one_line(why))));
            line(toml::to_string(file).unwrap_or_default().trim_end().to_owned());
        }
        text += "\n[columns]\n";
        for (to, pick) in self.ordered() {
            let called = called(pick);
            let unit = if pick.unit == Unit::Plain { "" } else { pick.unit.word() };
            let what: Vec<&str> =
                [called.as_str(), unit].into_iter().filter(|w| !w.is_empty()).collect();
            let _ = writeln!(
                text,
                "# {to}: {}, because {}",
                what.join(", "),
                on_one_line(&pick.because)
            );
            let file = if self.files.len() > 1 {
                format!("file = {}, ", pick.file + 1)
            } else {
                String::new()
            };
            let name = toml::Value::String(pick.name.clone());
            let unit = if unit.is_empty() { String::new() } else { format!(", unit = \"{unit}\"") };
            let _ = writeln!(
                text,
                "{to} = {{ {file}column = {}, name = {name}{unit} }}",
                pick.column + 1
            );
        }
        text
    }

    /// Joints, point, then the rest.
    pub fn ordered(&self) -> Vec<(&String, &Pick)> {
        let mut all: Vec<_> = self.columns.iter().collect();
        all.sort_by_key(|(to, _)| place(to));
        all
    }

    /// Columns of the joints, in order.
    pub fn joints(&self) -> Vec<&Pick> {
        (1..).map_while(|j| self.columns.get(&format!("q{j}"))).collect()
    }
}

/// `column 3 "J1"`.
pub(super) fn called(pick: &Pick) -> String {
    let number = pick.column + 1;
    if pick.name.is_empty() {
        format!("column {number}")
    } else {
        format!("column {number} \"{}\"", on_one_line(&pick.name))
    }
}

/// The names of measurements.csv beyond joints, in the order of its columns.
pub(super) const ORDER: [&str; 28] = [
    "x",
    "y",
    "z",
    "station",
    "marker",
    "series",
    "order",
    "date",
    "time",
    "temperature",
    "payload",
    "sigma",
    "qx",
    "qy",
    "qz",
    "qw",
    "roll",
    "pitch",
    "yaw",
    "rx",
    "ry",
    "rz",
    "r11",
    "r12",
    "r13",
    "r21",
    "r22",
    "r23",
];

fn place(to: &str) -> (usize, usize, String) {
    let number = |prefix: &str| to.strip_prefix(prefix).and_then(|n| n.parse::<usize>().ok());
    let known = ORDER.iter().position(|name| *name == to);
    match (known, number("q"), number("dir")) {
        (Some(at), _, _) => (1, at, String::new()),
        (_, Some(joint), _) => (0, joint, String::new()),
        (_, _, Some(joint)) => (2, joint, String::new()),
        _ => (3, 0, to.to_owned()),
    }
}

/// Whether import.toml and `--columns` know a name.
pub(super) fn is_name(to: &str) -> bool {
    let joint = |n: Option<&str>| {
        n.and_then(|n| n.parse::<usize>().ok())
            .is_some_and(|n| (1..=truearm::MAX_JOINTS).contains(&n))
    };
    ORDER.contains(&to)
        || ["r31", "r32", "r33"].contains(&to)
        || own(to).is_some()
        || joint(to.strip_prefix('q'))
        || joint(to.strip_prefix("dir"))
}
