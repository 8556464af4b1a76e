//! The distance of the target from a point that does not move: a ballbar, a draw
//! wire, an interferometer. The point is an unknown unless it is stated. What the
//! instrument adds to every length is nothing unless it is stated, known or unknown.

use nalgebra::{DMatrix, Vector3};

use super::partials::InFrame;
use super::{Bound, Column, Kind, Partials, Registry, Seen, Told, Unclear};
use crate::model::{Form, Row, Values};

/// A length, m.
pub(super) const COLUMNS: [Column; 1] = [Column {
    name: "distance_mm",
    within: [0.0, 1e3],
    missing: "a distance needs distance_mm",
    wrong: "give it in mm, 0 to a million",
}];

/// Of the column `anchor`; without a label there is one.
pub struct Distance;

impl Kind for Distance {
    fn name(&self) -> &'static str {
        "distance"
    }

    fn columns(&self) -> &'static [Column] {
        &COLUMNS
    }

    fn labels(&self) -> &'static [&'static str] {
        &["anchor"]
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        let label = (told.text)("anchor");
        let mut refers = vec![book.instrument(&[Form::Anchor], label)];
        refers.extend(book.known(Form::Zero, label));
        Ok(Bound { refers, known: Vec::new() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["distance"]
    }

    fn check(&self) -> &'static str {
        "the unit of distance_mm, its zero offset and scale, and the labels of anchors"
    }

    fn leaves(&self) -> &'static str {
        "where the arm stands, unless three anchors that are not on a line are known"
    }

    fn distance(&self, row: &Row) -> Option<f64> {
        Some(row.measured[0])
    }

    fn has_zero(&self) -> bool {
        true
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let row = seen.row(index);
        let instrument = (row.refers[0], seen.instrument(row.refers[0]));
        let at = InFrame { row: index, target: seen.point(index), instrument };
        let local = at.local();
        let zero = row.refers.get(1).map(|zero| (*zero, seen.instrument(*zero).numbers[0]));
        let added = zero.map_or(0.0, |(_, added)| added);
        let residual = Values::repeat(1, row.measured[0] - local.norm() - added);
        let mut out = at.partials(residual, &along(&local), &[]);
        if let Some((zero, _)) = zero {
            let mut own = DMatrix::zeros(1, 7);
            own[(0, 6)] = 1.0;
            out.instruments.push((zero, own));
        }
        out
    }
}

/// How the length of a vector moves with it.
pub(super) fn along(v: &Vector3<f64>) -> DMatrix<f64> {
    DMatrix::from_row_slice(1, 3, (v / v.norm().max(1e-9)).as_slice())
}
