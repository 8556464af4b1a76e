//! Pairs: any two places of the target. What measures the way between them, a bar or an
//! interferometer, is stated nowhere.

use rand_chacha::ChaCha8Rng;

use super::distance::LEAST;
use super::{Candidate, Spot};
use crate::error::Result;
use crate::model::PlannedRow;
use crate::plan::cell::Cell;

/// The only one.
pub fn spots(_cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    Ok(vec![Box::new(Ends)])
}

struct Ends;

impl Spot for Ends {
    fn name(&self) -> String {
        "two places of the target".to_owned()
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let ends = [cell.anywhere(rng)?, cell.anywhere(rng)?];
        let [from, to] = [0, 1].map(|k| cell.target(&ends[k]).translation);
        let row = |q| PlannedRow { q, labels: Vec::new() };
        ((to - from).norm() > LEAST).then(|| ends.into_iter().map(row).collect())
    }
}
