//! The elementary transforms that conventions are made of.

use nalgebra::{Matrix3, Rotation3, Vector3};
use truearm::{Link, Pose};

fn turn(axis: Vector3<f64>, angle: f64) -> Pose<f64> {
    let rotation: Matrix3<f64> = Rotation3::from_scaled_axis(axis * angle).into_inner();
    Pose { rotation, translation: Vector3::zeros() }
}

/// A turn about x, rad.
pub(super) fn about_x(angle: f64) -> Pose<f64> {
    turn(Vector3::x(), angle)
}

/// A turn about y, rad.
pub(super) fn about_y(angle: f64) -> Pose<f64> {
    turn(Vector3::y(), angle)
}

/// A turn about z, rad.
pub(super) fn about_z(angle: f64) -> Pose<f64> {
    turn(Vector3::z(), angle)
}

/// `Rx(alpha) Tx(a)`: from the frame of a link to the axis of the next joint.
pub(super) fn twist(alpha: f64, a: f64) -> Pose<f64> {
    about_x(alpha).compose(&Pose::translation(a, 0.0, 0.0))
}

/// `Rz(theta) Tz(d)`: along the axis of a joint.
pub(super) fn screw(theta: f64, d: f64) -> Pose<f64> {
    about_z(theta).compose(&Pose::translation(0.0, 0.0, d))
}

/// A link at joint value zero without its beta: its z is the joint's axis.
pub(super) fn to_axis(link: &Link<f64>) -> Pose<f64> {
    let p = &link.parameters;
    twist(p.alpha, p.a).compose(&screw(p.theta, p.d))
}

/// Angle of the rotation between two frames, rad; good for small ones too.
pub(super) fn angle_between(a: &Pose<f64>, b: &Pose<f64>) -> f64 {
    a.inverse().compose(b).rotation_vector().norm()
}
