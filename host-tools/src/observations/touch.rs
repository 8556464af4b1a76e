//! The target, or the ball on it, touches a plane, a sphere or a cylinder. A plane
//! is touched from where its z points; spheres and cylinders from outside, or
//! from inside where the radius is less than nothing.

use nalgebra::{DMatrix, Vector3};

use super::distance::along;
use super::partials::InFrame;
use super::{Bound, Column, Kind, Partials, Registry, Seen, Told, Unclear};
use crate::model::{Form, Values};

/// The surface of the column `surface`; without a label there is one.
pub struct Touch;

/// Forms that can be touched; what is not stated is a plane.
const SURFACES: [Form; 3] = [Form::Plane, Form::Sphere, Form::Cylinder];

impl Kind for Touch {
    fn name(&self) -> &'static str {
        "touch"
    }

    fn columns(&self) -> &'static [Column] {
        &[]
    }

    fn labels(&self) -> &'static [&'static str] {
        &["surface"]
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        let surface = book.instrument(&SURFACES, (told.text)("surface"));
        let probe = book.known(Form::Probe, told.marker);
        Ok(Bound { refers: std::iter::once(surface).chain(probe).collect(), known: Vec::new() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["touch"]
    }

    fn check(&self) -> &'static str {
        "the labels of surfaces, the radius of the probe ([[probes]]) and of spheres \
         and cylinders, and from which side they are touched"
    }

    fn leaves(&self) -> &'static str {
        "where the arm stands; its overall scale, which a plate of known coordinates or one known \
         length closes, and known planes where they share no point"
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let row = seen.row(index);
        let surface = seen.instrument(row.refers[0]);
        let at =
            InFrame { row: index, target: seen.point(index), instrument: (row.refers[0], surface) };
        let local = at.local();
        let probe = row.refers.get(1).map(|i| (*i, seen.instrument(*i).numbers[0]));
        let radius = probe.map_or(0.0, |(_, radius)| radius);
        let axis = Vector3::new(local.x, local.y, 0.0);
        let (gap, way, numbers) = match surface.form {
            Form::Sphere => (local.norm() - surface.numbers[0].abs(), along(&local), true),
            Form::Cylinder => (axis.norm() - surface.numbers[0].abs(), along(&axis), true),
            _ => (local.z, DMatrix::from_row_slice(1, 3, &[0.0, 0.0, 1.0]), false),
        };
        // From inside the ball is on the other side of the wall.
        let inside = numbers && surface.numbers[0] < 0.0;
        let side = if inside { -1.0 } else { 1.0 };
        let with_radius = if inside { [1.0] } else { [-1.0] };
        let residual = Values::repeat(1, side * radius - gap);
        let mut out =
            at.partials(residual, &way, if numbers { with_radius.as_slice() } else { &[] });
        if let Some((probe, _)) = probe {
            let mut own = DMatrix::zeros(1, 7);
            own[(0, 6)] = -side;
            out.instruments.push((probe, own));
        }
        out
    }
}
