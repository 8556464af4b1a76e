//! The distance between two places of one target: two rows, joined by a label of
//! the column `pair`, either with the distance.

use super::distance::{COLUMNS, along};
use super::{ArmPart, Body, Column, Kind, Partials, Seen};
use crate::model::Values;

/// The second row of the two holds the equation.
pub struct Pair;

impl Kind for Pair {
    fn name(&self) -> &'static str {
        "pair"
    }

    fn columns(&self) -> &'static [Column] {
        &COLUMNS
    }

    fn labels(&self) -> &'static [&'static str] {
        &["pair"]
    }

    fn joined_by(&self) -> Option<&'static str> {
        Some("pair")
    }

    fn components(&self) -> &'static [&'static str] {
        &["distance"]
    }

    fn check(&self) -> &'static str {
        "the unit of distance_mm and its scale, and which rows a label of `pair` joins"
    }

    fn leaves(&self) -> &'static str {
        "where the arm stands, and how the last frame is turned about the target"
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let row = seen.row(index);
        let Some(partner) = row.partner else {
            let (residual, none) = (Values::default(), Vec::new());
            return Partials { residual, arm: Vec::new(), instruments: none };
        };
        let apart = seen.point(index) - seen.point(partner);
        let pull = along(&apart);
        let end = |row: usize, sign: f64| ArmPart { row, body: Body::Target, pull: &pull * sign };
        Partials {
            residual: Values::repeat(1, row.measured[0] - apart.norm()),
            arm: vec![end(index, 1.0), end(partner, -1.0)],
            instruments: Vec::new(),
        }
    }
}
