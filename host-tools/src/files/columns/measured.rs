//! The columns that say what a row measured: `kind` and those of each kind.

use super::cells::Cells;
use super::header::Header;
use crate::error::Result;
use crate::model::{KindId, Values};
use crate::observations::{KINDS, by_name};

/// Where they stand.
pub struct MeasuredColumns {
    /// Column `kind`.
    kind: Option<usize>,
    /// Of each kind its columns; `None` where one is missing.
    of: Vec<Option<Vec<usize>>>,
}

impl MeasuredColumns {
    /// Finds them by name.
    pub fn find(header: &mut Header) -> Result<Self> {
        let kind = header.take("kind");
        let mut of = Vec::new();
        for (place, known) in KINDS.iter().enumerate() {
            let found: Vec<_> = known.columns().iter().map(|c| (c, header.take(c.name))).collect();
            let missing = found.iter().find(|(_, at)| at.is_none());
            // Without a column `kind` every row is of the first.
            if let (0, None, Some((column, _))) = (place, kind, missing) {
                return Err(header.missing(column.name, column.missing));
            }
            of.push(found.into_iter().map(|(_, at)| at).collect());
        }
        Ok(Self { kind, of })
    }

    /// What a row measured, SI.
    pub fn row(&self, cells: &Cells) -> Result<(KindId, Values)> {
        let name = self.kind.map_or("", |column| cells.text(column));
        let id = if name.is_empty() { Some(KindId::default()) } else { by_name(name) };
        let id = id.ok_or_else(|| {
            let known: Vec<_> = KINDS.iter().map(|kind| kind.name()).collect();
            let help = format!("give one of {}, or leave it empty for a point", known.join(", "));
            cells.fail(self.kind.unwrap_or(0), format!("kind \"{name}\""), &help)
        })?;
        let columns = KINDS[usize::from(id.0)].columns();
        let found = self.of[usize::from(id.0)].as_ref().ok_or_else(|| {
            let names: Vec<_> = columns.iter().map(|c| c.name).collect();
            let message = format!("a row of kind \"{name}\" needs {}", names.join(", "));
            cells.source.in_line(cells.line, cells.start, message, columns[0].missing)
        })?;
        let mut values = Values::default();
        for (column, at) in columns.iter().zip(found) {
            let value = cells.number(*at)? * column.unit();
            if value.abs() > column.most {
                return Err(cells.fail(*at, column.too_large(value), column.wrong));
            }
            values = values.iter().copied().chain([value]).collect();
        }
        Ok((id, values))
    }
}
