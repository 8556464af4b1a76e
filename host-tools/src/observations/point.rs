//! A point of the target in the tracker frame: three coordinates.

use nalgebra::{DMatrix, Vector3};

use super::{Column, Kind, Moving, Seen};
use crate::model::{Row, Values};

/// The kind of a row without a `kind` of its own.
pub struct Point;

impl Kind for Point {
    fn name(&self) -> &'static str {
        "point"
    }

    fn columns(&self) -> &'static [Column] {
        const AT: &str = "the measured point needs x_mm, y_mm, z_mm";
        const FAR: &str = "give the point in mm";
        &[
            Column { name: "x_mm", most: 1e3, missing: AT, wrong: FAR },
            Column { name: "y_mm", most: 1e3, missing: AT, wrong: FAR },
            Column { name: "z_mm", most: 1e3, missing: AT, wrong: FAR },
        ]
    }

    fn components(&self) -> &'static [&'static str] {
        &["x", "y", "z"]
    }

    fn point(&self, row: &Row) -> Option<Vector3<f64>> {
        Some(row.measured.point())
    }

    fn residual(&self, index: usize, seen: &dyn Seen) -> Values {
        (seen.row(index).measured.point() - seen.point(index)).into()
    }

    fn linearised(&self, index: usize, seen: &dyn Moving) -> (Values, DMatrix<f64>) {
        let (point, moved) = seen.moved(index);
        ((seen.row(index).measured.point() - point).into(), moved)
    }
}
