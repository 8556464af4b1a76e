//! Inclinations: wherever both axes of the inclinometer lean by less than it reads.

use nalgebra::{Matrix3, Vector3};
use rand_chacha::ChaCha8Rng;

use super::{Candidate, Spot};
use crate::error::Result;
use crate::model::{Form, PlannedRow};
use crate::plan::cell::Cell;

/// Sine of what an axis reads at most: 45 degrees.
const MOST: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The only one. Where up is not stated, it is the z of the frame of the files.
pub fn spots(cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    let up = cell.book.of(&[Form::Up]).next();
    let up = up.map_or_else(Vector3::z, |up| up.place.rotation.column(2).into_owned());
    Ok(vec![Box::new(Level { axes: cell.ray("").rotation, up })])
}

struct Level {
    /// Of the inclinometer, in the last frame.
    axes: Matrix3<f64>,
    up: Vector3<f64>,
}

impl Spot for Level {
    fn name(&self) -> String {
        "poses that hold the inclinometer within 45 degrees".to_owned()
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let q = cell.anywhere(rng)?;
        let sines = (cell.flange(&q).rotation * self.axes).tr_mul(&self.up);
        let reads = sines.x.abs().max(sines.y.abs()) <= MOST;
        reads.then(|| vec![PlannedRow { q, labels: Vec::new() }])
    }
}
