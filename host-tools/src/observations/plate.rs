//! The target sits in a hole, or on a ball, of a plate: its place in the frame of
//! the plate is one of the known coordinates. Where the plate lies is an unknown
//! unless it is stated.

use nalgebra::{DMatrix, Vector3};

use super::partials::InFrame;
use super::{Bound, Column, Kind, Partials, Registry, Seen, Told, Unclear};
use crate::model::{Form, Row, Values};

/// Of the columns `plate` and `hole`.
pub struct Plate;

impl Kind for Plate {
    fn name(&self) -> &'static str {
        "plate"
    }

    fn columns(&self) -> &'static [Column] {
        &[]
    }

    fn labels(&self) -> &'static [&'static str] {
        &["plate", "hole"]
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        let (plate, known) = hole(told, book)?;
        Ok(Bound { refers: vec![plate], known: known.iter().copied().collect() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["x", "y", "z"]
    }

    fn check(&self) -> &'static str {
        "the coordinates of the holes in instruments.toml (mm, their order and sense) \
         and the labels of the rows"
    }

    fn leaves(&self) -> &'static str {
        "where the arm stands; nothing of its scale"
    }

    fn hole(&self, row: &Row) -> Option<Vector3<f64>> {
        Some(row.measured.point())
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let row = seen.row(index);
        let instrument = (row.refers[0], seen.instrument(row.refers[0]));
        let at = InFrame { row: index, target: seen.point(index), instrument };
        let residual: Values = (row.measured.point() - at.local()).into();
        at.partials(residual, &DMatrix::identity(3, 3), &[])
    }
}

/// The plate of a row and the coordinates of the hole, m.
pub(super) fn hole(told: &Told, book: &mut dyn Registry) -> Result<(usize, Vector3<f64>), Unclear> {
    let [plate, hole] = ["plate", "hole"].map(told.text);
    let known = book.known(Form::Plate, plate).zip(book.hole(plate, hole));
    known.ok_or_else(|| {
        let help = "give its coordinates in instruments.toml: [[plates]] with label and holes";
        ("hole", format!("hole \"{hole}\" of plate \"{plate}\" is not known"), help.to_owned())
    })
}
