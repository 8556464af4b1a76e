//! Closures: the target at one point in several postures. From which side a seat is
//! reached nothing states: every posture that the arm has there counts.

use rand_chacha::ChaCha8Rng;

use super::{Candidate, Spot, some};
use crate::error::Result;
use crate::model::{Form, Instrument, PlannedRow};
use crate::plan::cell::Cell;

/// One an anchor.
pub fn spots(cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    let all = cell
        .book
        .of(&[Form::Anchor])
        .map(|anchor| -> Box<dyn Spot> { Box::new(Seat { anchor: anchor.clone() }) });
    some(all.collect(), "closure", "point to come back to", "[[anchors]] with label and xyz_mm")
}

struct Seat {
    anchor: Instrument,
}

impl Spot for Seat {
    fn name(&self) -> String {
        format!("anchor \"{}\"", self.anchor.label)
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let q = cell.at(&self.anchor.place.translation, &cell.start(rng))?;
        Some(vec![PlannedRow { q, labels: vec![("anchor", self.anchor.label.clone())] }])
    }
}
