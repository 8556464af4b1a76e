//! Files of measurements that need not be held at once: they are read a piece at a time, on
//! all cores, as often as is asked.

#[cfg_attr(not(feature = "parquet"), path = "no_columnar.rs")]
mod columnar;
mod sample;
mod text;
mod twice;

use std::collections::HashSet;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::instruments::Gathered;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{KindId, Measurements, Robot, Row};
use crate::observations::kind;
pub(super) use columnar::Columnar;
pub use sample::Sample;
use text::Text;
use twice::Twice;

/// What a Parquet file begins with.
pub(super) const MAGIC: &[u8; 4] = b"PAR1";

/// Whether a file is one of columns. What is no file, such as a pipe, is read once, as a text.
pub(super) fn is_columnar(path: &Path) -> Result<bool> {
    let error = |e| Error::io(path, e);
    if !std::fs::metadata(path).map_err(error)?.is_file() {
        return Ok(false);
    }
    let mut begin = Vec::with_capacity(MAGIC.len());
    let file = std::fs::File::open(path).map_err(error)?;
    file.take(MAGIC.len() as u64).read_to_end(&mut begin).map_err(error)?;
    Ok(begin == MAGIC)
}

/// Where a row is: its file, its piece, its number there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    file: usize,
    piece: usize,
    row: u64,
}

impl Place {
    /// So many rows on.
    fn on(self, rows: usize) -> Self {
        Self { row: self.row + rows as u64, ..self }
    }
}

/// A file, and where its pieces are.
enum Form {
    Text(Text),
    Columnar(Columnar),
}

struct File {
    path: PathBuf,
    form: Form,
    book: Gathered,
}

/// The rows of some files of one arm.
pub struct Pieces<'r> {
    robot: &'r Robot,
    files: Vec<File>,
    /// File and place in it of each piece.
    pieces: Vec<(usize, usize)>,
    /// Rows that are not the first of their like; none was looked for before rows were drawn.
    twice: Option<Twice>,
}

impl<'r> Pieces<'r> {
    /// Of these files.
    ///
    /// # Errors
    /// Files that cannot be read, and headers as for [`Measurements::read`].
    pub fn of(paths: &[&PathBuf], robot: &'r Robot) -> Result<Self> {
        let file = |path: &&PathBuf| {
            if std::fs::metadata(path).is_ok_and(|what| !what.is_file() && !what.is_dir()) {
                let what = format!("{} can be read only once", path.display());
                return Err(Error::usage(what, "give a file: pieces are read several times"));
            }
            let form = match is_columnar(path)? {
                true => Form::Columnar(Columnar::open(path)?),
                false => Form::Text(Text::open(path)?),
            };
            Ok(File { path: (*path).clone(), form, book: Gathered::beside(path, robot)? })
        };
        let files: Vec<File> = paths.iter().map(file).collect::<Result<_>>()?;
        let places = files.iter().enumerate();
        let pieces = places.flat_map(|(k, file)| (0..file.form.pieces()).map(move |p| (k, p)));
        Ok(Self { robot, pieces: pieces.collect(), files, twice: None })
    }

    /// Whether files hold more than so many rows together; headers are not read for it. What
    /// can be read only once is taken for less.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn more_than(rows: usize, paths: &[&PathBuf]) -> Result<bool> {
        let mut seen = 0;
        for path in paths {
            if !path.is_file() {
                return Ok(false);
            }
            seen += match is_columnar(path)? {
                true => Columnar::open(path)?.rows(),
                false => text::rows(path)?,
            };
        }
        Ok(seen > rows)
    }

    /// How many of other rows are rows of these files, too: the same joints, the same measured
    /// values.
    ///
    /// # Errors
    /// As for [`Pieces::fold`].
    pub fn shared(&self, other: &Measurements) -> Result<usize> {
        let wanted: HashSet<Vec<u64>> = other.rows.iter().map(Row::bits).collect();
        let there = |data: Measurements| -> Result<HashSet<Vec<u64>>> {
            Ok(data.rows.iter().map(Row::bits).filter(|bits| wanted.contains(bits)).collect())
        };
        let all = self.fold(&there, &|mut a, b| {
            a.extend(b);
            Ok(a)
        })?;
        Ok(other.rows.iter().filter(|row| all.contains(&row.bits())).count())
    }

    /// The arm.
    #[must_use]
    pub fn robot(&self) -> &'r Robot {
        self.robot
    }

    /// Rows of all files, a row of units among them.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.files.iter().map(|file| file.form.rows()).sum()
    }

    /// All files, for a report.
    #[must_use]
    pub fn names(&self) -> String {
        let paths = self.files.iter().map(|file| file.path.display().to_string());
        paths.collect::<Vec<_>>().join(", ")
    }

    /// What `each` makes of the rows, some thousands at a time, joined in their order: on all
    /// cores, the same whatever their number. Columns without a meaning are not read, pairs
    /// not joined.
    ///
    /// # Errors
    /// As for [`Measurements::read`], and what either function says.
    pub fn fold<T: Send>(
        &self,
        each: &(impl Fn(Measurements) -> Result<T> + Sync),
        join: &(impl Fn(T, T) -> Result<T> + Sync),
    ) -> Result<T> {
        self.blocks(
            &|place, mut data| {
                if let Some(twice) = &self.twice {
                    twice.keep(place, &mut data);
                }
                (!data.rows.is_empty()).then(|| each(data)).transpose()
            },
            join,
        )
    }

    /// The same with the place of the first row, of all rows; nothing of a block that gives none.
    fn blocks<T: Send>(
        &self,
        each: &(impl Fn(Place, Measurements) -> Result<Option<T>> + Sync),
        join: &(impl Fn(T, T) -> Result<T> + Sync),
    ) -> Result<T> {
        let none = || {
            let what = format!("{}: no data rows", self.names());
            Error::data(ErrorKind::NoRows, what, "add rows below the headings")
        };
        self.tree(&self.pieces, each, join)?.ok_or_else(none)
    }

    fn tree<T: Send>(
        &self,
        pieces: &[(usize, usize)],
        each: &(impl Fn(Place, Measurements) -> Result<Option<T>> + Sync),
        join: &(impl Fn(T, T) -> Result<T> + Sync),
    ) -> Result<Option<T>> {
        if let [place] = pieces {
            let mut sum = None;
            let mut first = 0;
            self.read(*place, &mut |data| {
                let rows = data.rows.len() as u64;
                let next = each(Place { file: place.0, piece: place.1, row: first }, data)?;
                first += rows;
                sum = match (sum.take(), next) {
                    (Some(sum), Some(next)) => Some(join(sum, next)?),
                    (sum, next) => sum.or(next),
                };
                Ok(())
            })?;
            return Ok(sum);
        }
        if pieces.is_empty() {
            return Ok(None);
        }
        let (first, second) = pieces.split_at(pieces.len().div_ceil(2));
        let (first, second) =
            rayon::join(|| self.tree(first, each, join), || self.tree(second, each, join));
        // Of two errors the one that stands first in the files.
        Ok(match (first?, second?) {
            (Some(first), Some(second)) => Some(join(first, second)?),
            (first, second) => first.or(second),
        })
    }

    fn read(
        &self,
        (file, piece): (usize, usize),
        with: &mut dyn FnMut(Measurements) -> Result<()>,
    ) -> Result<()> {
        let File { path, form, book } = &self.files[file];
        let points = &mut |data: Measurements| match data
            .rows
            .iter()
            .find(|row| row.kind != KindId::default())
        {
            Some(other) => {
                let (file, line, what) = (path.display(), other.line, kind(other).name());
                let what = format!("{file}:{line}: a {what}; rows read in pieces are points");
                let help = "leave out --in-pieces, or write --in-pieces=never";
                Err(Error::data(ErrorKind::NotPoints, what, help))
            }
            None => with(data),
        };
        match form {
            Form::Text(text) => text.read((path, piece), self.robot, book, points),
            Form::Columnar(columns) => columns.read((path, piece), self.robot, book, points),
        }
    }
}

impl Form {
    fn pieces(&self) -> usize {
        match self {
            Self::Text(text) => text.pieces(),
            Self::Columnar(columns) => columns.pieces(),
        }
    }

    fn rows(&self) -> usize {
        match self {
            Self::Text(text) => text.rows(),
            Self::Columnar(columns) => columns.rows(),
        }
    }
}
