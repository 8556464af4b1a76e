//! Ranges along a ray that is fixed to the last frame: it meets a plane from the front,
//! not too flat, within what it measures.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;

use super::{Candidate, Spot, placed, some};
use crate::error::Result;
use crate::model::{Form, Instrument, PlannedRow};
use crate::observations::ray_of;
use crate::plan::cell::Cell;

/// What a ray measures where `reach_mm` does not say it, m.
const REACH: [f64; 2] = [0.05, 2.0];
/// Least cosine between a ray and the normal of what it meets: 60 degrees.
const STEEP: f64 = 0.5;

/// One a plane.
pub fn spots(cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    let planes: Vec<&Instrument> = cell.book.of(&[Form::Plane]).collect();
    let table = "[[surfaces]] with label, point_mm and normal";
    let ray = cell.ray(&ray_of(""));
    let reach = cell.book.range_of(Form::Turn, &ray_of("")).unwrap_or(REACH);
    let spot = |plane: &Instrument| -> Result<Box<dyn Spot>> {
        placed(plane, "surfaces", "point_mm and normal")?;
        Ok(Box::new(Range { plane: plane.clone(), ray, reach }))
    };
    some(planes, "range", "plane to range to", table)?.into_iter().map(spot).collect()
}

struct Range {
    plane: Instrument,
    /// In the last frame, along z.
    ray: Pose<f64>,
    reach: [f64; 2],
}

impl Spot for Range {
    fn name(&self) -> String {
        format!("a ray on plane \"{}\"", self.plane.label)
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let q = cell.anywhere(rng)?;
        let range = self.range(&cell.flange(&q).compose(&self.ray))?;
        let [least, most] = self.reach;
        let labels = vec![("surface", self.plane.label.clone())];
        (least..=most).contains(&range).then(|| vec![PlannedRow { q, labels }])
    }
}

impl Range {
    fn range(&self, ray: &Pose<f64>) -> Option<f64> {
        let above = self.plane.local(&ray.translation).0.z;
        let way: Vector3<f64> = ray.rotation.column(2).into_owned();
        let down = -self.plane.place.rotation.tr_mul(&way).z;
        (above > 0.0 && down >= STEEP).then(|| above / down)
    }
}
