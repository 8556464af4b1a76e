//! A point of the target in the tracker frame: three coordinates.

use nalgebra::{DMatrix, Vector3};

use super::{ArmPart, Body, Column, Kind, Moving, Partials, Seen};
use crate::model::{Row, Values};

const AT: &str = "the measured point needs x_mm, y_mm, z_mm";
const FAR: &str = "give the point in mm";
/// Where it is, m.
pub(super) const COLUMNS: [Column; 3] = [
    Column { name: "x_mm", within: [-1e3, 1e3], missing: AT, wrong: FAR },
    Column { name: "y_mm", within: [-1e3, 1e3], missing: AT, wrong: FAR },
    Column { name: "z_mm", within: [-1e3, 1e3], missing: AT, wrong: FAR },
];

/// The kind of a row without a `kind` of its own.
pub struct Point;

impl Kind for Point {
    fn name(&self) -> &'static str {
        "point"
    }

    fn columns(&self) -> &'static [Column] {
        &COLUMNS
    }

    fn components(&self) -> &'static [&'static str] {
        &["x", "y", "z"]
    }

    fn point(&self, row: &Row) -> Option<Vector3<f64>> {
        Some(row.measured.point())
    }

    fn check(&self) -> &'static str {
        "the unit of x_mm, y_mm, z_mm, the order and handedness of the tracker's axes, \
         and the labels of stations and markers"
    }

    fn leaves(&self) -> &'static str {
        "how the last frame is turned about the target"
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let pull = DMatrix::identity(3, 3);
        Partials {
            residual: self.residual(index, seen),
            arm: vec![ArmPart { row: index, body: Body::Target, pull }],
            instruments: Vec::new(),
        }
    }

    fn residual(&self, index: usize, seen: &dyn Seen) -> Values {
        (seen.row(index).measured.point() - seen.point(index)).into()
    }

    fn linearised(&self, index: usize, seen: &dyn Moving) -> (Values, DMatrix<f64>) {
        let (point, moved) = seen.moved(index);
        ((seen.row(index).measured.point() - point).into(), moved)
    }
}
