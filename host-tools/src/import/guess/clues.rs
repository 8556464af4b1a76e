//! What a guess is made of.

use crate::headings::{Quantity, Unit};
use crate::import::config::Pick;
use crate::import::join::RowRef;
use crate::import::options::ImportOptions;
use crate::import::table::Table;
use crate::model::Robot;

/// A column before its unit is known.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::import) struct Place {
    pub file: usize,
    pub column: usize,
    pub because: String,
}

/// Everything a guess is made of.
pub(in crate::import) struct Clues<'a> {
    pub tables: &'a [Table],
    pub robot: Option<&'a Robot>,
    pub options: &'a ImportOptions,
}

/// Joints and point, found; in the order of joints and of x, y, z.
pub(in crate::import) struct Found {
    pub joints: Vec<Place>,
    pub point: Vec<Place>,
}

impl Clues<'_> {
    /// The unit that a heading says.
    pub fn said(&self, place: &Place) -> Option<Unit> {
        self.tables[place.file].headings[place.column].unit
    }

    /// What a heading is, as a pick of a known unit.
    pub fn pick(&self, place: &Place, unit: Unit, because: String) -> Pick {
        let name = self.tables[place.file].headings[place.column].text.clone();
        Pick { file: place.file, column: place.column, name, unit, because }
    }

    /// Kind of a joint as far as it is known: what the heading's unit or the
    /// arm says, an angle otherwise.
    pub fn joint_quantity(&self, joint: usize, place: &Place) -> Quantity {
        let kind = self.robot.and_then(|r| r.joints.get(joint)).map(|j| j.link.kind);
        match (kind, self.said(place).map(Unit::quantity)) {
            (Some(truearm::JointKind::Prismatic), _) | (None, Some(Quantity::Length)) => {
                Quantity::Length
            }
            _ => Quantity::Angle,
        }
    }

    /// Numbers of some columns in rows that have them all.
    pub fn numbers(&self, places: &[&Place], rows: &[RowRef]) -> Vec<Vec<f64>> {
        let row = |row: &RowRef| -> Vec<f64> {
            let value = |place: &&Place| {
                let (file, at) = row.at(place.file);
                self.tables[file].number(at, place.column).unwrap_or(f64::NAN)
            };
            places.iter().map(value).collect()
        };
        rows.iter().map(row).filter(|values| values.iter().all(|v| v.is_finite())).collect()
    }
}
