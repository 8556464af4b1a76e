//! Touches: the target, or the ball on it, on a plane, a sphere or a cylinder, carried
//! from the side that is touched. Planes and cylinders have no end in instruments.toml;
//! the box of the workspace may give them one.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;

use super::{Candidate, Spot, placed, some};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Form, Instrument, PlannedRow};
use crate::plan::cell::{Cell, direction};

const SURFACES: [Form; 3] = [Form::Plane, Form::Sphere, Form::Cylinder];

/// One a surface.
pub fn spots(cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    let all: Vec<&Instrument> = cell.book.of(&SURFACES).collect();
    let spot = |surface: &Instrument| -> Result<Box<dyn Spot>> {
        let keys = match surface.form {
            Form::Sphere => "point_mm, its centre,",
            _ => "point_mm and normal",
        };
        placed(surface, "surfaces", keys)?;
        if surface.form != Form::Plane && surface.numbers[0] == 0.0 {
            return Err(Error::data(
                ErrorKind::NoPoses,
                format!("{} \"{}\" has no radius", surface.form.name(), surface.label),
                "add radius_mm to its [[surfaces]] in instruments.toml",
            ));
        }
        Ok(Box::new(Touch { surface: surface.clone() }))
    };
    some(all, "touch", "surface to touch", "[[surfaces]] with label, shape, point_mm and normal")?
        .into_iter()
        .map(spot)
        .collect()
}

struct Touch {
    surface: Instrument,
}

impl Spot for Touch {
    fn name(&self) -> String {
        format!("{} \"{}\"", self.surface.form.name(), self.surface.label)
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let start = cell.start(rng);
        let (point, side) = self.touched(cell, &start, rng);
        let q = cell.at_from(&point, &side, &start)?;
        Some(vec![PlannedRow { q, labels: vec![("surface", self.surface.label.clone())] }])
    }
}

impl Touch {
    /// Where the target is to be, and the side from which it comes: below where the pose
    /// has it, and of a sphere anywhere on it.
    fn touched(
        &self,
        cell: &Cell,
        start: &[f64],
        rng: &mut ChaCha8Rng,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let place = &self.surface.place;
        let local = self.surface.local(&cell.target(start).translation).0;
        let probe = cell.probe();
        if self.surface.form == Form::Plane {
            let side = place.rotation.column(2).into_owned();
            return (place.transform_point(&Vector3::new(local.x, local.y, probe)), side);
        }
        let (foot, way) = match self.surface.form {
            Form::Sphere => (Vector3::zeros(), direction(rng)),
            _ => {
                let across = direction(rng);
                let across = Vector3::new(across.x, across.y, 0.0);
                (Vector3::new(0.0, 0.0, local.z), across / across.norm().max(1e-9))
            }
        };
        let radius = self.surface.numbers[0];
        // From inside the ball is on the other side of the wall.
        let inwards = if radius < 0.0 { -1.0 } else { 1.0 };
        let there = foot + way * (radius.abs() + inwards * probe);
        (place.transform_point(&there), place.rotation * way * inwards)
    }
}
