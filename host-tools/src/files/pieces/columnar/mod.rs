//! Parquet files: columns of numbers and labels, in groups of rows.

mod column;
mod guarded;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::properties::ReaderProperties;
use parquet::file::reader::{FileReader, RowGroupReader};
use parquet::file::serialized_reader::{SerializedFileReader, SerializedRowGroupReader};

use crate::error::{Error, Result};
use crate::files::columns::Record;
use crate::files::instruments::Gathered;
use crate::files::reading::Reading;
use crate::files::source::Source;
use crate::model::{Measurements, Robot};
use column::Column;
use guarded::{broken, guarded};

/// Rows of a group that are held at once.
const HELD: usize = 8192;

/// A file of columns; its pieces are its groups of rows.
pub struct Columnar {
    path: PathBuf,
    metadata: ParquetMetaData,
    names: Vec<String>,
    /// Rows before each group.
    before: Vec<usize>,
    rows: usize,
}

impl Columnar {
    /// Reads what a file says of itself.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|e| Error::io(path, e))?;
        let reader = || SerializedFileReader::new(file).map_err(|e| broken(path, &e));
        let reader = guarded(path, reader)?;
        let metadata = reader.metadata().clone();
        let columns = metadata.file_metadata().schema_descr().columns();
        let names = columns.iter().map(|column| column.path().string().trim().to_owned());
        let names = names.collect();
        let mut rows = 0;
        let mut before = Vec::new();
        for group in metadata.row_groups() {
            before.push(rows);
            rows += usize::try_from(group.num_rows()).unwrap_or_default();
        }
        Ok(Self { path: path.to_owned(), metadata, names, before, rows })
    }

    pub fn pieces(&self) -> usize {
        self.before.len()
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The header as a line of text, for what is wrong with it.
    fn header(&self) -> String {
        self.names.join(",") + "\n"
    }

    /// The measurements, all at once.
    pub fn whole(&self, robot: &Robot, book: Gathered) -> Result<Measurements> {
        let header = self.header();
        let source = Source { path: &self.path, text: &header };
        let mut reading = Reading::begin(source, &self.names, robot, (Some("q"), true), book)?;
        reading.expect(self.rows);
        let unread = reading.unread().to_vec();
        for group in 0..self.pieces() {
            let mut batches = Batches::of(self, group, &unread)?;
            while let Some(batch) = batches.next()? {
                batch.add_to(&mut reading)?;
            }
        }
        reading.end()
    }

    /// Reads a group, some thousands of rows at a time.
    pub fn read(
        &self,
        (path, group): (&Path, usize),
        robot: &Robot,
        book: &Gathered,
        with: &mut dyn FnMut(Measurements) -> Result<()>,
    ) -> Result<()> {
        let header = self.header();
        let source = Source { path, text: &header };
        let asked = (Some("q"), true);
        let begin = || Reading::begin(source, &self.names, robot, asked, book.clone());
        let unread = begin()?.unread().to_vec();
        let mut batches = Batches::of(self, group, &unread)?;
        while let Some(batch) = batches.next()? {
            let mut reading = begin()?.each_by_itself();
            reading.expect(batch.rows);
            batch.add_to(&mut reading)?;
            let mut data = reading.end()?;
            data.remark_unused();
            with(data)?;
        }
        Ok(())
    }
}

/// Some rows of a group.
struct Batch {
    columns: Vec<Column>,
    rows: usize,
    /// Rows of the file before it.
    before: usize,
}

impl Batch {
    fn add_to(&self, reading: &mut Reading) -> Result<()> {
        (0..self.rows).try_for_each(|row| {
            reading.row((self.before + row + 1, None), &RowOf { batch: self, row })
        })
    }
}

struct RowOf<'b> {
    batch: &'b Batch,
    row: usize,
}

impl Record for RowOf<'_> {
    fn text(&self, column: usize) -> &str {
        self.batch.columns[column].text(self.row)
    }

    fn number(&self, column: usize) -> std::result::Result<Option<f64>, &str> {
        self.batch.columns[column].number(self.row)
    }
}

/// A group on the way.
struct Batches<'c> {
    of: &'c Columnar,
    columns: Vec<Option<ColumnReader>>,
    before: usize,
    left: usize,
}

impl<'c> Batches<'c> {
    fn of(of: &'c Columnar, group: usize, unread: &[usize]) -> Result<Self> {
        let file = File::open(&of.path).map_err(|e| Error::io(&of.path, e))?;
        let known = of.metadata.row_group(group);
        let properties = Arc::new(ReaderProperties::builder().build());
        let failed = |e: ParquetError| broken(&of.path, &e);
        let columns = || {
            let reader = SerializedRowGroupReader::new(Arc::new(file), known, None, properties);
            let reader = reader.map_err(failed)?;
            let column = |k: usize| match unread.contains(&k) {
                true => Ok(None),
                false => reader.get_column_reader(k).map(Some).map_err(failed),
            };
            (0..of.names.len()).map(column).collect()
        };
        let columns = guarded(&of.path, columns)?;
        let left = usize::try_from(known.num_rows()).unwrap_or_default();
        Ok(Self { of, columns, before: of.before[group], left })
    }

    fn next(&mut self) -> Result<Option<Batch>> {
        let rows = self.left.min(HELD);
        if rows == 0 {
            return Ok(None);
        }
        let (of, before) = (self.of, self.before);
        let schema = of.metadata.file_metadata().schema_descr();
        let read = |(k, column): (usize, &mut Option<ColumnReader>)| match column {
            None => Ok(Column::Unread),
            Some(reader) => Column::next((&of.path, &of.names[k]), &schema.column(k), reader, rows),
        };
        let all = self.columns.iter_mut().enumerate().map(read);
        let columns = guarded(&of.path, || all.collect::<Result<_>>())?;
        (self.left, self.before) = (self.left - rows, before + rows);
        Ok(Some(Batch { columns, rows, before }))
    }
}
