//! Plates: the target in a hole or on a ball, from the side that the z of the plate's
//! frame points to. Only plates that stand still have holes that the arm reaches.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;

use super::{Candidate, Spot, placed, some};
use crate::error::Result;
use crate::model::{Form, Instrument, PlannedRow};
use crate::plan::cell::Cell;

/// One a hole.
pub fn spots(cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    let fixed = cell.book.of(&[Form::Plate]).filter(|plate| !plate.on_flange).collect();
    let table = "[[plates]] with label, xyz_mm, rpy_deg and holes";
    let plates: Vec<&Instrument> = some(fixed, "plate", "plate that stands still", table)?;
    plates.iter().try_for_each(|plate| placed(plate, "plates", "xyz_mm and rpy_deg"))?;
    let of = |plate: &&Instrument| {
        let hole = |(label, hole): (String, Vector3<f64>)| -> Box<dyn Spot> {
            let (point, side) = (plate.place.transform_point(&hole), plate.place.rotation);
            let side = side.column(2).into_owned();
            Box::new(Hole { plate: plate.label.clone(), label, point, side })
        };
        cell.book.holes_of(&plate.label).into_iter().map(hole).collect::<Vec<_>>()
    };
    some(plates.iter().flat_map(of).collect(), "plate", "hole", table)
}

struct Hole {
    plate: String,
    label: String,
    point: Vector3<f64>,
    side: Vector3<f64>,
}

impl Spot for Hole {
    fn name(&self) -> String {
        format!("hole \"{}\" of plate \"{}\"", self.label, self.plate)
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let q = cell.at_from(&self.point, &self.side, &cell.start(rng))?;
        let labels = vec![("plate", self.plate.clone()), ("hole", self.label.clone())];
        Some(vec![PlannedRow { q, labels }])
    }
}
