//! The arm closes on itself: the target is at the same point in several postures.
//! The point is an unknown unless it is stated.

use nalgebra::DMatrix;

use super::partials::InFrame;
use super::{Bound, Column, Kind, Partials, Registry, Seen, Told, Unclear};
use crate::model::{Form, Values};

/// The point of the column `anchor`; without a label there is one.
pub struct Closure;

impl Kind for Closure {
    fn name(&self) -> &'static str {
        "closure"
    }

    fn columns(&self) -> &'static [Column] {
        &[]
    }

    fn labels(&self) -> &'static [&'static str] {
        &["anchor"]
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        let anchor = book.instrument(&[Form::Anchor], (told.text)("anchor"));
        Ok(Bound { refers: vec![anchor], known: Vec::new() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["x", "y", "z"]
    }

    fn check(&self) -> &'static str {
        "the labels of anchors, and that the target is at the very same point each time"
    }

    fn leaves(&self) -> &'static str {
        "where the arm stands and its overall scale; much of the arm where few points are touched"
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let row = seen.row(index);
        let instrument = (row.refers[0], seen.instrument(row.refers[0]));
        let at = InFrame { row: index, target: seen.point(index), instrument };
        let residual: Values = (-at.local()).into();
        at.partials(residual, &DMatrix::identity(3, 3), &[])
    }
}
