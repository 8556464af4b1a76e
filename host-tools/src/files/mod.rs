//! Readers and writers of the files a user meets: robot.toml, measurements.csv,
//! model.toml. What they hold is in [`crate::model`], in SI units.

mod columns;
mod commanded;
mod comment;
mod covariance;
mod digest;
mod edit;
mod identified;
mod instruments;
mod key;
mod measurements;
mod model;
mod model_curves;
mod model_terms;
mod number;
mod numbers;
mod pairs;
mod path;
mod pieces;
mod poses;
mod reading;
mod robot;
mod signed;
mod source;

pub(crate) use columns::{USUAL_SIGMA_ANGLE, USUAL_SIGMA_MM, USUAL_SIGMA_PX};
pub(crate) use comment::on_one_line;
pub use digest::{digest_of_bytes, digest_of_text};
pub use edit::CsvEdit;
pub(crate) use edit::{not_that_text, tables};
pub use instruments::Gathered;
pub use key::read_key;
pub use number::number;
pub use path::Wanted;
pub use pieces::{Pieces, Sample};
pub use poses::{planned_csv, poses_csv};
pub use robot::{RobotDraft, prior_tables, with_priors};
pub use signed::{Comment, foreign, overwritable, overwritable_like, signed};

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::{Error, Place, Result};

/// Reads a text file of truearm's own, UTF-8.
///
/// # Errors
/// What the system says, and text that is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    read(path)
}

/// Reads a text file, without the byte-order mark some programs put in front.
pub(crate) fn read(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let text = String::from_utf8(bytes).map_err(|e| {
        if e.as_bytes().starts_with(pieces::MAGIC) {
            let help = "give the table or TOML file that is asked for; Parquet files hold \
                        measurements of `identify`, `diagnose`, `evaluate` and their like";
            return Error::file(path, Place::default(), "a Parquet file", help);
        }
        if e.as_bytes().starts_with(&truearm::blob::MAGIC) {
            return Error::file(
                path,
                Place::default(),
                "a parameter blob, as a controller holds it",
                "give the table or TOML file that is asked for; of a blob `truearm unpack` makes a \
                 model.toml",
            );
        }
        let line = e.as_bytes()[..e.utf8_error().valid_up_to()].iter().filter(|b| **b == b'\n');
        Error::file(
            path,
            Place::line(line.count() + 1),
            "not UTF-8 text",
            "save the file as UTF-8; `truearm import` reads tables of any encoding, .xlsx and .ods",
        )
    })?;
    match text.strip_prefix('\u{feff}') {
        Some(rest) => Ok(rest.to_owned()),
        None => Ok(text),
    }
}

/// How tables are read, or what follows their headings: lines that begin with `#` are comments.
fn csv_reader(text: &str, headings: bool) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(headings)
        .trim(csv::Trim::All)
        .flexible(true)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes())
}

/// The text of a CSV file; labels are quoted where they must be.
pub fn csv_text<'a>(
    header: impl IntoIterator<Item = &'a str>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let records = std::iter::once(header.into_iter().map(str::to_owned).collect()).chain(rows);
    for record in records {
        let written = writer.write_record(record);
        written.unwrap_or_else(|e| unreachable!("rows as long as the header, in memory: {e}"));
    }
    let bytes = writer.into_inner().unwrap_or_else(|e| unreachable!("memory takes all: {e}"));
    String::from_utf8(bytes).unwrap_or_else(|e| unreachable!("of texts: {e}"))
}

/// A temporary file with the permissions of the one it replaces, or with those
/// that every new file gets: the library's own are for secrets.
#[cfg_attr(not(unix), allow(unused_variables, unused_mut))]
fn temporary(path: &Path) -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(BEGUN.0).suffix(BEGUN.1);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let usual = || std::fs::Permissions::from_mode(0o666);
        builder.permissions(std::fs::metadata(path).map_or_else(|_| usual(), |m| m.permissions()));
    }
    builder
}

/// How a file is called that is not written to its end.
const BEGUN: (&str, &str) = (".truearm-", ".tmp");
/// No run takes as long to write one.
const ABANDONED: std::time::Duration = std::time::Duration::from_secs(3600);

/// Clears away what runs that were killed had begun to write.
fn swept(folder: &Path) {
    let abandoned = |entry: &std::fs::DirEntry| {
        let name = entry.file_name();
        let begun = name.to_str().is_some_and(|n| n.starts_with(BEGUN.0) && n.ends_with(BEGUN.1));
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        begun && age().is_some_and(|age| age > ABANDONED)
    };
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if abandoned(&entry) {
            // Whoever may not remove it need not.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// What is no file, such as a pipe or /dev/stdout.
fn is_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir())
}

/// A file where a folder is meant.
fn refuse_file(folder: &Path) -> Result<()> {
    if !folder.is_file() {
        return Ok(());
    }
    let what = format!("{} is a file, and no folder to write into", folder.display());
    Err(Error::usage(what, "give a folder, or a name that is free"))
}

/// A file to be written, and what will be in it.
pub type ToWrite = (PathBuf, Vec<u8>);

/// A file that is written but for its name.
enum Staged<'a> {
    /// Beside the place that it takes.
    Beside(tempfile::NamedTempFile, PathBuf),
    /// What is no file, such as a pipe or /dev/stdout, is written to as it is.
    Device(&'a Path, &'a [u8]),
}

impl<'a> Staged<'a> {
    /// A link stays a link.
    fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self> {
        if is_device(path) {
            return Ok(Self::Device(path, bytes));
        }
        let error = |e| Error::io(path, e);
        let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        refuse_file(folder)?;
        if target.is_dir() {
            return Err(error(std::io::ErrorKind::IsADirectory.into()));
        }
        std::fs::create_dir_all(folder).map_err(error)?;
        swept(folder);
        let begun = temporary(&target).tempfile_in(folder);
        // What the library says of it names a file that nobody knows.
        let mut file = begun.map_err(|e| error(e.kind().into()))?;
        file.write_all(bytes).map_err(error)?;
        file.as_file().sync_all().map_err(error)?;
        Ok(Self::Beside(file, target))
    }

    fn named(self) -> Result<()> {
        match self {
            Self::Beside(file, path) => {
                file.persist(&path).map(drop).map_err(|e| Error::io(&path, e.error))
            }
            Self::Device(path, bytes) => {
                let device = std::fs::OpenOptions::new().write(true).open(path);
                device.and_then(|mut to| to.write_all(bytes)).map_err(|e| Error::io(path, e))
            }
        }
    }
}

/// Writes a file whole or not at all: into a temporary file beside it, which
/// then takes its name.
///
/// # Errors
/// What the system says; an existing file is then as it was.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    Staged::new(path, bytes)?.named()
}

/// Whether files can be written into a folder, which need not be there yet.
///
/// # Errors
/// What the system says, of the nearest folder that is there.
pub fn writable(folder: &Path) -> Result<()> {
    let here = Path::new(".");
    let there = folder.ancestors().find(|folder| folder.exists() || folder.as_os_str().is_empty());
    let there = there.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(here);
    refuse_file(there)?;
    let begun = tempfile::Builder::new().prefix(BEGUN.0).suffix(BEGUN.1).tempfile_in(there);
    begun.map(drop).map_err(|e| Error::io(there, e.kind().into()))
}

/// Writes files that belong together: all are on the disk before the first takes its
/// name, so that a full disk or a stop leaves no new file beside an old one.
///
/// # Errors
/// As for [`write()`], and two files in one place.
pub fn write_all(files: &[ToWrite]) -> Result<()> {
    let place = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    for (k, (path, _)) in files.iter().enumerate() {
        if !is_device(path) && files[..k].iter().any(|(other, _)| place(other) == place(path)) {
            let what = format!("{}: two outputs in one file", path.display());
            return Err(Error::usage(what, "give each a name of its own"));
        }
    }
    let staged: Result<Vec<Staged>> =
        files.iter().map(|(path, bytes)| Staged::new(path, bytes)).collect();
    staged?.into_iter().try_for_each(Staged::named)
}
