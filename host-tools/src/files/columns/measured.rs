//! The columns that say what a row measured: `kind` and those of each kind.

use super::cells::Cells;
use super::header::Header;
use crate::error::Result;
use crate::model::{KindId, Values};
use crate::observations::{Bound, KINDS, Told, by_name};

/// Where they stand.
pub struct MeasuredColumns {
    /// Column `kind`.
    kind: Option<usize>,
    /// Of each kind its columns; `None` where one is missing.
    of: Vec<Option<Vec<usize>>>,
    /// Columns of labels.
    labels: Vec<(&'static str, usize)>,
    /// Without a column `kind`: the kind of rows that have all its columns.
    fuller: Option<KindId>,
}

/// What a row measured, and of what.
#[derive(Default)]
pub struct Measured {
    pub kind: KindId,
    pub values: Values,
    pub refers: Vec<usize>,
    /// The label of what it measured with.
    pub target: String,
    /// What joins it to another row.
    pub pair: Option<String>,
}

impl MeasuredColumns {
    /// Finds them by name. Without a column `kind` rows are points, or poses
    /// where their orientation is told `with_turns`.
    pub fn find(header: &mut Header, with_turns: bool) -> Result<Self> {
        let kind = header.take("kind");
        let (mut of, mut labels) = (Vec::new(), Vec::new());
        for (place, known) in KINDS.iter().enumerate() {
            let columns = known.columns();
            let found: Vec<_> = columns.iter().map(|c| (c, header.place(c.name))).collect();
            let missing = found.iter().find(|(_, at)| at.is_none());
            // Without a column `kind` every row is of the first.
            if let (0, None, Some((column, _))) = (place, kind, missing) {
                return Err(header.missing(column.name, column.missing));
            }
            if kind.is_some() || place == 0 || with_turns {
                for column in columns {
                    let _ = header.take(column.name);
                }
            }
            if kind.is_some() {
                let named = known.labels().iter().filter_map(|l| Some((*l, header.take(l)?)));
                labels.extend(named);
            }
            of.push(found.into_iter().map(|(_, at)| at).collect());
        }
        let fuller = by_name("pose").filter(|_| kind.is_none() && with_turns);
        let fuller = fuller.filter(|id| {
            let columns: &Option<Vec<usize>> = &of[usize::from(id.0)];
            columns.is_some()
        });
        Ok(Self { kind, of, labels, fuller })
    }

    /// Whether orientations make poses of rows.
    pub fn of_poses(&self) -> bool {
        self.kind.is_some() || self.fuller.is_some()
    }

    /// What a row measured, SI.
    pub fn row(
        &self,
        cells: &Cells,
        marker: &str,
        book: &mut dyn crate::observations::Registry,
    ) -> Result<Measured> {
        let id = self.kind_of(cells)?;
        let kind = KINDS[usize::from(id.0)];
        let columns = kind.columns();
        let found = self.of[usize::from(id.0)].as_ref().ok_or_else(|| {
            let names: Vec<_> = columns.iter().map(|c| c.name).collect();
            let message = format!("a row of kind \"{}\" needs {}", kind.name(), names.join(", "));
            let help = columns.first().map_or("", |c| c.missing);
            cells.fail_whole(message, help)
        })?;
        let text = |name: &str| {
            self.labels.iter().find(|(l, _)| *l == name).map_or("", |(_, at)| cells.text(*at))
        };
        let pair = kind.joined_by().map(|column| text(column).to_owned());
        if let (Some(column), Some("")) = (kind.joined_by(), pair.as_deref()) {
            let message = format!("a row of kind \"{}\" without a label", kind.name());
            let help = "give the two rows that belong together one label, and every two their own";
            let at = self.labels.iter().find(|(label, _)| *label == column);
            return Err(match at {
                Some((_, at)) => cells.fail(*at, message, help),
                None => cells.fail_whole(message, help),
            });
        }
        let mut values = Values::default();
        for (column, at) in columns.iter().zip(found) {
            // What two rows tell together stands in either.
            let Some(value) = self.number(cells, *at, pair.is_some())? else { continue };
            let value = value * column.unit();
            let [least, most] = column.within;
            if value < least || value > most {
                return Err(cells.fail(*at, column.too_large(value), column.wrong));
            }
            values = values.iter().copied().chain([value]).collect();
        }
        let target = kind.target(marker);
        let bound = kind.bind(&Told { marker: &target, text: &text }, book);
        let Bound { refers, known } = bound.map_err(|(column, message, help)| {
            let at = self.labels.iter().find(|(l, _)| *l == column);
            match at {
                Some((_, at)) => cells.fail(*at, message, &help),
                None => cells.fail_whole(message, help),
            }
        })?;
        values = values.iter().copied().chain(known).collect();
        Ok(Measured { kind: id, values, refers, target: target.into_owned(), pair })
    }

    fn number(&self, cells: &Cells, at: usize, either: bool) -> Result<Option<f64>> {
        if either { cells.optional(Some(at)) } else { cells.number(at).map(Some) }
    }

    fn kind_of(&self, cells: &Cells) -> Result<KindId> {
        let name = self.kind.map_or("", |column| cells.text(column));
        if name.is_empty() {
            let whole = |id: &KindId| {
                let columns = self.of[usize::from(id.0)].iter().flatten();
                columns.into_iter().all(|at| !cells.text(*at).is_empty())
            };
            return Ok(self.fuller.filter(whole).unwrap_or_default());
        }
        by_name(name).ok_or_else(|| {
            let known: Vec<_> = KINDS.iter().map(|kind| kind.name()).collect();
            let help = format!("give one of {}, or leave it empty for a point", known.join(", "));
            cells.fail(self.kind.unwrap_or(0), format!("kind \"{name}\""), &help)
        })
    }
}
