//! A column of some rows: numbers or texts.

use std::cell::OnceCell;
use std::path::Path;

use parquet::basic::{LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::schema::types::ColumnDescriptor;

use super::guarded::broken;
use crate::error::{Error, Place, Result};
use crate::files::columns::number;

/// A column of some rows.
pub enum Column {
    Numbers {
        values: Vec<Option<f64>>,
        written: OnceCell<Vec<String>>,
    },
    Texts(Vec<String>),
    /// Nobody asks for it.
    Unread,
}

impl Column {
    /// The next rows of a column of a file.
    pub fn next(
        (path, name): (&Path, &str),
        known: &ColumnDescriptor,
        reader: &mut ColumnReader,
        rows: usize,
    ) -> Result<Self> {
        let refused = |what: &str| {
            let place = Place { field: Some(name.to_owned()), ..Place::default() };
            let help = "write numbers as numbers of 32 or 64 bits, in the unit that the column's \
                        name says, and labels as texts";
            Err(Error::file(path, place, what, help))
        };
        if let Some(what) = refused_as(known) {
            return refused(what);
        }
        let numbers = |values: Vec<Option<f64>>| Self::Numbers { values, written: OnceCell::new() };
        let most = known.max_def_level();
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
                        Self::Texts(texts.into_iter().map(Option::unwrap_or_default).collect())
                    }
                    Err(_) => return refused("texts that are not UTF-8"),
                }
            }
            _ => return refused("a column of other than numbers and texts"),
        })
    }
    /// A cell as text.
    pub fn text(&self, row: usize) -> &str {
        match self {
            Self::Texts(texts) => &texts[row],
            Self::Numbers { values, written } => {
                let text = |value: &Option<f64>| value.map_or_else(String::new, |v| v.to_string());
                &written.get_or_init(|| values.iter().map(text).collect())[row]
            }
            Self::Unread => "",
        }
    }

    /// A cell as a number.
    pub fn number(&self, row: usize) -> std::result::Result<Option<f64>, &str> {
        match self {
            Self::Numbers { values, .. } => Ok(values[row]),
            Self::Texts(texts) => number(&texts[row]),
            Self::Unread => Ok(None),
        }
    }
}

/// Why a column is neither of numbers nor of texts, if so.
fn refused_as(known: &ColumnDescriptor) -> Option<&'static str> {
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
