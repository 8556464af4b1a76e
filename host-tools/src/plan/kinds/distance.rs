//! Distances from an anchor: within what its wire, bar or beam reaches, where that is
//! stated.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Candidate, Spot, some};
use crate::error::Result;
use crate::model::{Form, Instrument, PlannedRow};
use crate::plan::cell::Cell;

/// A shorter length has no direction to speak of, m.
pub const LEAST: f64 = 0.01;

/// One an anchor.
pub fn spots(cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    let all = cell.book.of(&[Form::Anchor]).map(|anchor| -> Box<dyn Spot> {
        let reach = cell.book.range_of(Form::Anchor, &anchor.label);
        Box::new(Length { anchor: anchor.clone(), reach })
    });
    let table = "[[anchors]] with label and xyz_mm";
    some(all.collect(), "distance", "point to measure from", table)
}

struct Length {
    anchor: Instrument,
    reach: Option<[f64; 2]>,
}

impl Spot for Length {
    fn name(&self) -> String {
        format!("anchor \"{}\" within its reach", self.anchor.label)
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let [least, most] = self.reach.unwrap_or([LEAST, f64::INFINITY]);
        let start = cell.start(rng);
        let foot = self.anchor.place.translation;
        let way = cell.target(&start).translation - foot;
        let q = match way.norm() {
            far if (least.max(LEAST)..=most).contains(&far) => cell.admitted(start)?,
            far if most.is_finite() => {
                // A bar has one length: few poses have it by chance.
                let length = rng.random_range(least..=most);
                cell.at(&(foot + way * (length / far.max(LEAST))), &start)?
            }
            _ => return None,
        };
        Some(vec![PlannedRow { q, labels: vec![("anchor", self.anchor.label.clone())] }])
    }
}
