//! Parquet files: columns of numbers and labels, in groups of rows.

use std::cell::{Cell, OnceCell};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Once};

use parquet::basic::{LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::properties::ReaderProperties;
use parquet::file::reader::{FileReader, RowGroupReader};
use parquet::file::serialized_reader::{SerializedFileReader, SerializedRowGroupReader};

use crate::error::{Error, Place, Result};
use crate::files::columns::{Record, number};
use crate::files::instruments::Gathered;
use crate::files::reading::Reading;
use crate::files::source::Source;
use crate::model::{Measurements, Robot};

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

thread_local! {
    /// Whether a panic of this thread is that of what reads columns, and is said as an error.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}
static QUIET: Once = Once::new();

/// What reads columns panics over some damaged files: that is an error of the file.
fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T>) -> Result<T> {
    QUIET.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !GUARDED.get() {
                usual(info);
            }
        }));
    });
    let damaged = |_| {
        let help = "write it anew: its bytes are not what was written";
        Err(Error::file(path, Place::default(), "a damaged Parquet file", help))
    };
    GUARDED.set(true);
    let read = std::panic::catch_unwind(std::panic::AssertUnwindSafe(read));
    GUARDED.set(false);
    read.unwrap_or_else(damaged)
}

fn broken(path: &Path, error: &ParquetError) -> Error {
    let help = "write it anew: a column a number or label, compressed by Snappy, gzip, LZ4 or \
                Zstandard";
    Error::file(path, Place::default(), error.to_string(), help)
}

/// A column of some rows.
enum Column {
    Numbers {
        values: Vec<Option<f64>>,
        written: OnceCell<Vec<String>>,
    },
    Texts(Vec<String>),
    /// Nobody asks for it.
    Unread,
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
        match &self.batch.columns[column] {
            Column::Texts(texts) => &texts[self.row],
            Column::Numbers { values, written } => {
                let text = |value: &Option<f64>| value.map_or_else(String::new, |v| v.to_string());
                &written.get_or_init(|| values.iter().map(text).collect())[self.row]
            }
            Column::Unread => "",
        }
    }

    fn number(&self, column: usize) -> std::result::Result<Option<f64>, &str> {
        match &self.batch.columns[column] {
            Column::Numbers { values, .. } => Ok(values[self.row]),
            Column::Texts(texts) => number(&texts[self.row]),
            Column::Unread => Ok(None),
        }
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
        let read = |(k, column): (usize, &mut Option<ColumnReader>)| match column {
            None => Ok(Column::Unread),
            Some(reader) => of.column(k, reader, rows),
        };
        let all = self.columns.iter_mut().enumerate().map(read);
        let columns = guarded(&of.path, || all.collect::<Result<_>>())?;
        (self.left, self.before) = (self.left - rows, before + rows);
        Ok(Some(Batch { columns, rows, before }))
    }
}

impl Columnar {
    /// Why a column is neither of numbers nor of texts, if so.
    fn refused(&self, k: usize) -> Option<&'static str> {
        let known = self.metadata.file_metadata().schema_descr().column(k);
        if known.max_rep_level() > 0 || known.path().parts().len() > 1 {
            return Some("a column of lists or records");
        }
        let plain = matches!(
            known.logical_type_ref(),
            None | Some(LogicalType::Integer { .. } | LogicalType::String | LogicalType::Enum)
        );
        let of_numbers_or_texts = matches!(
            known.physical_type(),
            Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE | Type::BYTE_ARRAY
        );
        (!plain || !of_numbers_or_texts)
            .then_some("a column of dates, times, decimals or other than numbers and texts")
    }

    /// The next rows of a column.
    fn column(&self, k: usize, reader: &mut ColumnReader, rows: usize) -> Result<Column> {
        let known = self.metadata.file_metadata().schema_descr().column(k);
        let refused = |what: &str| {
            let place = Place { field: Some(self.names[k].clone()), ..Place::default() };
            let help = "write numbers as numbers of 32 or 64 bits, in the unit that the column's \
                        name says, and labels as texts";
            Err(Error::file(&self.path, place, what, help))
        };
        if let Some(what) = self.refused(k) {
            return refused(what);
        }
        let numbers =
            |values: Vec<Option<f64>>| Column::Numbers { values, written: OnceCell::new() };
        let (path, most) = (self.path.as_path(), known.max_def_level());
        Ok(match reader {
            ColumnReader::Int32ColumnReader(r) => {
                numbers(values(path, r, (rows, most), |v| f64::from(*v))?)
            }
            ColumnReader::Int64ColumnReader(r) => {
                numbers(values(path, r, (rows, most), |v| *v as f64)?)
            }
            ColumnReader::FloatColumnReader(r) => {
                numbers(values(path, r, (rows, most), |v| f64::from(*v))?)
            }
            ColumnReader::DoubleColumnReader(r) => numbers(values(path, r, (rows, most), |v| *v)?),
            ColumnReader::ByteArrayColumnReader(r) => {
                let text = |v: &ByteArray| v.as_utf8().map(|text| text.trim().to_owned());
                let texts = values(path, r, (rows, most), text)?;
                let texts = texts.into_iter().map(|text| text.transpose()).collect();
                let texts: std::result::Result<Vec<Option<String>>, _> = texts;
                match texts {
                    Ok(texts) => {
                        Column::Texts(texts.into_iter().map(Option::unwrap_or_default).collect())
                    }
                    Err(_) => return refused("texts that are not UTF-8"),
                }
            }
            _ => return refused("a column of other than numbers and texts"),
        })
    }
}

/// The next rows of a column; nothing where there is nothing.
fn values<T: DataType, V>(
    path: &Path,
    reader: &mut ColumnReaderImpl<T>,
    (rows, most): (usize, i16),
    of: impl Fn(&T::T) -> V,
) -> Result<Vec<Option<V>>> {
    let (mut levels, mut found) = (Vec::with_capacity(rows), Vec::with_capacity(rows));
    let asked = (most > 0).then_some(&mut levels);
    let read = reader.read_records(rows, asked, None, &mut found);
    let (records, ..) = read.map_err(|e| broken(path, &e))?;
    if records != rows {
        let help = "write the file anew: its columns are of different lengths";
        return Err(Error::file(path, Place::default(), "a column ends before the others", help));
    }
    if most == 0 {
        return Ok(found.iter().map(|value| Some(of(value))).collect());
    }
    let mut found = found.iter();
    let next = |level: &i16| if *level == most { found.next().map(&of) } else { None };
    Ok(levels.iter().map(next).collect())
}
