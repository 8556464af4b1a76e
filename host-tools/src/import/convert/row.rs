//! A row of the tables, read cell by cell.

use std::collections::BTreeMap;

use super::column::{Kind, Output};
use crate::error::{Error, Result};
use crate::headings::Quantity;
use crate::import::config::{Config, Pick};
use crate::import::join::RowRef;
use crate::import::native::has_point;
use crate::import::number::plain;
use crate::import::table::Table;
use crate::import::turn::{Form, quaternion};

/// Decimals of angles and lengths: 2e-9 rad and 10 nm, finer than any encoder
/// or tracker.
const ANGLE: usize = 7;
const LENGTH: usize = 5;
const OTHER: usize = 9;
/// One row being read.
pub struct Reader<'a> {
    pub tables: &'a [Table],
    pub row: &'a RowRef,
    /// Seconds in the session.
    pub time: Option<f64>,
    /// The column that says the date of a time of day.
    pub date: Option<&'a Pick>,
    /// The column that says what a row measured.
    pub kind: Option<&'a Pick>,
}

impl Reader<'_> {
    pub fn text(&self, pick: &Pick) -> &str {
        let (file, at) = self.row.at(pick.file);
        self.tables[file].text(at, pick.column)
    }

    pub fn line(&self, pick: &Pick) -> usize {
        let (file, at) = self.row.at(pick.file);
        self.tables[file].rows[at].number
    }

    fn fail(&self, pick: &Pick, message: String, help: &str) -> Error {
        let (file, at) = self.row.at(pick.file);
        self.tables[file].fail(at, pick.column, message, help)
    }

    /// A table without points has no row of one.
    pub fn has_its_point(&self, config: &Config) -> Result<()> {
        let Some(kind) = self.kind.filter(|_| !config.columns.contains_key("x")) else {
            return Ok(());
        };
        if !has_point(self.text(kind)) {
            return Ok(());
        }
        let message = "a row of a point, but there are no columns x, y, z".to_owned();
        Err(self.fail(kind, message, "say what the row measured, or import without --config"))
    }

    pub fn missing(&self, output: &Output) -> bool {
        let number = || {
            let (file, at) = self.row.at(output.pick.file);
            self.tables[file].number(at, output.pick.column)
        };
        self.needed(output) && number().is_none()
    }

    fn needed(&self, output: &Output) -> bool {
        match output.kind {
            Kind::Point => self.kind.is_none_or(|pick| has_point(self.text(pick))),
            kind => kind == Kind::Needed,
        }
    }

    /// In the unit of the files; `None` of an empty cell.
    pub fn number(&self, pick: &Pick) -> Result<Option<f64>> {
        let (file, at) = self.row.at(pick.file);
        let table = &self.tables[file];
        match table.number(at, pick.column) {
            Some(value) => Ok(Some(pick.unit.to_file(value))),
            None if self.text(pick).is_empty() => Ok(None),
            None => {
                let message = format!("\"{}\" is not a number", self.text(pick));
                let help = "mend or delete the row; --skip-incomplete leaves such rows out; --decimal point \
                            or comma says how numbers are written";
                Err(self.fail(pick, message, help))
            }
        }
    }

    pub fn cell(&self, output: &Output) -> Result<String> {
        let pick = output.pick;
        if output.kind == Kind::Label {
            return Ok(self.text(pick).to_owned());
        }
        if output.kind == Kind::Time {
            if self.time.is_none() && !self.text(pick).is_empty() {
                let message = match self.date {
                    Some(date) => {
                        format!("\"{}\" on \"{}\" is no time", self.text(pick), self.text(date))
                    }
                    None => format!("\"{}\" is no time", self.text(pick)),
                };
                return Err(self.fail(
                    pick,
                    message,
                    "give seconds, 12:03:55 or 2021-03-05 12:03:55; of 03/05/2021 nothing says which is the \
                     month",
                ));
            }
            return Ok(self.time.map_or(String::new(), |time| plain(time, 6)));
        }
        let decimals = match pick.unit.quantity() {
            Quantity::Angle => ANGLE,
            Quantity::Length => LENGTH,
            _ => OTHER,
        };
        match self.number(pick)? {
            Some(value) => Ok(plain(value, decimals)),
            None if !self.needed(output) => Ok(String::new()),
            None => {
                let help = "fill it in or delete the row; --skip-incomplete leaves such rows out";
                Err(self.fail(pick, "empty cell".to_owned(), help))
            }
        }
    }

    /// Quaternion x, y, z, w; empty where any part is.
    pub fn orientation(&self, form: Form, columns: &BTreeMap<String, Pick>) -> Result<Vec<String>> {
        let picks: Vec<&Pick> = form.columns().iter().filter_map(|c| columns.get(*c)).collect();
        let values = picks.iter().map(|pick| self.number(pick)).collect::<Result<Vec<_>>>()?;
        let Some(values) = values.into_iter().collect::<Option<Vec<f64>>>() else {
            return Ok(vec![String::new(); 4]);
        };
        let scale = |(value, pick): (f64, &&Pick)| {
            if pick.unit.quantity() == Quantity::Angle { value.to_radians() } else { value }
        };
        let values: Vec<f64> = values.into_iter().zip(&picks).map(scale).collect();
        match form.rotation(&values) {
            Some(rotation) => Ok(quaternion(&rotation).iter().map(|v| plain(*v, OTHER)).collect()),
            None => {
                let help = "a quaternion has length 1, a rotation matrix orthogonal rows of length 1; \
                            --orientation none leaves it out";
                Err(self.fail(picks[0], format!("{values:?} is no orientation"), help))
            }
        }
    }
}
