//! A full pose of the target in the tracker frame: its point, and how a frame on
//! it is turned. The error of the turn is the rotation vector, about the axes of
//! the tracker, that carries the modelled frame onto the measured one.

use nalgebra::{DMatrix, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::partials::any;
use super::{
    ArmPart, Body, Bound, Column, Kind, Measure, Partials, Registry, Seen, Told, Unclear, point,
};
use crate::model::{Form, Row, Values};

/// How the marker's frame is turned in the last frame is an unknown of its own.
pub struct FullPose;

impl Kind for FullPose {
    fn name(&self) -> &'static str {
        "pose"
    }

    fn columns(&self) -> &'static [Column] {
        const AT: &str = "a pose needs x_mm, y_mm, z_mm and the quaternion qx, qy, qz, qw";
        const UNIT: &str = "give a unit quaternion qx, qy, qz, qw";
        const POINT: [Column; 3] = point::COLUMNS;
        &[
            POINT[0],
            POINT[1],
            POINT[2],
            Column { name: "qx", within: [-1.1, 1.1], missing: AT, wrong: UNIT },
            Column { name: "qy", within: [-1.1, 1.1], missing: AT, wrong: UNIT },
            Column { name: "qz", within: [-1.1, 1.1], missing: AT, wrong: UNIT },
            Column { name: "qw", within: [-1.1, 1.1], missing: AT, wrong: UNIT },
        ]
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        Ok(Bound { refers: vec![book.instrument(&[Form::Turn], told.marker)], known: Vec::new() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["x", "y", "z", "rx", "ry", "rz"]
    }

    fn measure(&self, component: usize) -> Measure {
        if component < 3 { Measure::Length } else { Measure::Angle }
    }

    fn check(&self) -> &'static str {
        "the unit of x_mm, y_mm, z_mm, the quaternion's order (qx, qy, qz, qw) and its \
         sense: of the marker in the tracker's frame"
    }

    fn leaves(&self) -> &'static str {
        "nothing of where the target is and how it is turned"
    }

    fn point(&self, row: &Row) -> Option<Vector3<f64>> {
        Some(row.measured.point())
    }

    fn turn(&self, row: &Row) -> Option<Matrix3<f64>> {
        Some(turn(row))
    }

    fn turns(&self) -> bool {
        true
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let (row, pose) = (seen.row(index), seen.pose(index));
        let place = seen.instrument(row.refers[0]).place;
        let modelled = pose.rotation * place.rotation;
        let error = turn_between(&modelled, &turn(row));
        let off = row.measured.point() - pose.translation;
        let way = [off.x, off.y, off.z, error.x, error.y, error.z];
        // A turn of the modelled frame by w takes the error e to
        // e - inverse(J)(e) w, of which e itself is all but everything.
        let inverse = any(&right_inverse(&error));
        let mut pull = DMatrix::identity(6, 6);
        pull.view_mut((3, 3), (3, 3)).copy_from(&inverse);
        let mut own = DMatrix::zeros(6, 6);
        own.view_mut((3, 0), (3, 3)).copy_from(&(inverse * any(&modelled)));
        Partials {
            residual: Values::from_fn(6, |c| way[c]),
            arm: vec![ArmPart { row: index, body: Body::Target, pull }],
            instruments: vec![(row.refers[0], own)],
        }
    }
}

/// How the measured frame is turned.
fn turn(row: &Row) -> Matrix3<f64> {
    let m = &row.measured;
    let q = UnitQuaternion::new_normalize(Quaternion::new(m[6], m[3], m[4], m[5]));
    q.to_rotation_matrix().into_inner()
}

/// The rotation vector, about the outer axes, from one frame to another, rad.
fn turn_between(from: &Matrix3<f64>, to: &Matrix3<f64>) -> Vector3<f64> {
    let between = Rotation3::from_matrix_unchecked(to * from.transpose());
    UnitQuaternion::from_rotation_matrix(&between).scaled_axis()
}

/// Inverse of the right Jacobian of the rotations at a rotation vector: how
/// `log(exp(e) exp(-w))` moves with -w at w = 0.
fn right_inverse(e: &Vector3<f64>) -> Matrix3<f64> {
    let (angle, cross) = (e.norm(), e.cross_matrix());
    let factor = match angle < 1e-3 {
        true => 1.0 / 12.0,
        false => 1.0 / angle.powi(2) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin()),
    };
    Matrix3::identity() + cross * 0.5 + cross * cross * factor
}
