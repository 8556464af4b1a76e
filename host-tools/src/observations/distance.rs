//! The distance of the target from a known point of the tracker frame. It
//! stands here for tests only, to show that a kind is one file, one row of the
//! table and its columns.

use nalgebra::{DMatrix, Vector3};

use super::{Column, Kind, Moving, Seen};
use crate::model::{Row, Values};

/// Columns `distance_mm` and the place of the known point.
pub struct Distance;

/// From the known point to the target.
fn apart(row: &Row, target: Vector3<f64>) -> Vector3<f64> {
    target - Vector3::new(row.measured[1], row.measured[2], row.measured[3])
}

impl Kind for Distance {
    fn name(&self) -> &'static str {
        "distance"
    }

    fn columns(&self) -> &'static [Column] {
        const AT: &str = "a distance needs distance_mm, anchor_x_mm, anchor_y_mm, anchor_z_mm";
        const FAR: &str = "give it in mm";
        &[
            Column { name: "distance_mm", most: 1e3, missing: AT, wrong: FAR },
            Column { name: "anchor_x_mm", most: 1e3, missing: AT, wrong: FAR },
            Column { name: "anchor_y_mm", most: 1e3, missing: AT, wrong: FAR },
            Column { name: "anchor_z_mm", most: 1e3, missing: AT, wrong: FAR },
        ]
    }

    fn components(&self) -> &'static [&'static str] {
        &["distance"]
    }

    fn residual(&self, index: usize, seen: &dyn Seen) -> Values {
        let row = seen.row(index);
        Values::repeat(1, row.measured[0] - apart(row, seen.point(index)).norm())
    }

    fn linearised(&self, index: usize, seen: &dyn Moving) -> (Values, DMatrix<f64>) {
        let row = seen.row(index);
        let (point, moved) = seen.moved(index);
        let apart = apart(row, point);
        let along = apart / apart.norm().max(1e-9);
        let residual = Values::repeat(1, row.measured[0] - apart.norm());
        let along = DMatrix::from_row_slice(1, 3, along.as_slice());
        (residual, along * moved)
    }
}
