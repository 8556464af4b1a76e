//! The range along a ray that is fixed to the last frame, to a plane. The ray
//! begins at a point of its own and runs along the z of a frame of its own; both are
//! unknowns unless they are stated, and so is the plane. No target sits there: what
//! other kinds measure of a marker of the same label is another point, turned otherwise.

use std::borrow::Cow;

use nalgebra::DMatrix;

use super::distance::COLUMNS;
use super::partials::any;
use super::{ArmPart, Body, Bound, Column, Kind, Partials, Registry, Seen, Told, Unclear};
use crate::model::{Form, Row, Values};

/// The plane of the column `surface`; without a label there is one.
pub struct Range;

/// What ends the label of a ray.
const RAY: &str = "(ray)";

/// The label under which the ray of rows with this marker is kept.
#[must_use]
pub fn ray_of(marker: &str) -> String {
    format!("{marker} {RAY}").trim_start().to_owned()
}

impl Kind for Range {
    fn name(&self) -> &'static str {
        "range"
    }

    fn columns(&self) -> &'static [Column] {
        &COLUMNS
    }

    fn labels(&self) -> &'static [&'static str] {
        &["surface"]
    }

    fn target<'a>(&self, marker: &'a str) -> Cow<'a, str> {
        Cow::Owned(ray_of(marker))
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        let new = book.known(Form::Turn, told.marker).is_none();
        let ray = book.instrument(&[Form::Turn], told.marker);
        if new {
            // A ray is as it is however it turns about itself.
            book.without(ray, &[2]);
        }
        let surface = book.instrument(&[Form::Plane], (told.text)("surface"));
        Ok(Bound { refers: vec![surface, ray], known: Vec::new() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["range"]
    }

    fn check(&self) -> &'static str {
        "the unit of distance_mm, its zero offset and scale, the labels of surfaces, \
         and the [[rays]] of instruments.toml"
    }

    fn leaves(&self) -> &'static str {
        "where the arm stands; how the ray is turned about itself"
    }

    fn of_target(&self, _row: &Row) -> bool {
        false
    }

    fn turns(&self) -> bool {
        true
    }

    fn distance(&self, row: &Row) -> Option<f64> {
        Some(row.measured[0])
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let (row, pose) = (seen.row(index), seen.pose(index));
        let (plane, ray) = (seen.instrument(row.refers[0]), seen.instrument(row.refers[1]));
        let axes = pose.rotation * ray.place.rotation;
        let way = axes.column(2).into_owned();
        let (local, with_point, with_frame) = plane.local(&pose.translation);
        let turned = plane.place.rotation.tr_mul(&way);
        // Never along the plane: a first guess may be.
        let down = if turned.z.abs() < 1e-6 { 1e-6_f64.copysign(turned.z) } else { turned.z };
        let range = -local.z / down;
        let mut with_local = DMatrix::zeros(1, 3);
        with_local[(0, 2)] = -1.0 / down;
        let mut with_way = DMatrix::zeros(1, 3);
        with_way[(0, 2)] = -range / down;
        // The way turns with the frame of the marker, against that of the plane.
        let turn = any(&(plane.place.rotation.transpose() * way.cross_matrix())) * -1.0;
        let mut pull = DMatrix::zeros(1, 6);
        pull.columns_mut(0, 3).copy_from(&(&with_local * with_point));
        pull.columns_mut(3, 3).copy_from(&(&with_way * turn));
        let mut own = &with_local * with_frame;
        let mut against = own.columns_mut(0, 3);
        against += &with_way * any(&turned.cross_matrix());
        let mut of_ray = DMatrix::zeros(1, 6);
        of_ray.columns_mut(0, 3).copy_from(&(pull.columns(3, 3) * any(&axes)));
        Partials {
            residual: Values::repeat(1, row.measured[0] - range),
            arm: vec![ArmPart { row: index, body: Body::Target, pull }],
            instruments: vec![(row.refers[0], own), (row.refers[1], of_ray)],
        }
    }
}
