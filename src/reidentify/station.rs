//! Where an unknown tracker stands.

use nalgebra::{Matrix3, Vector3};

use super::ReidentifyError;
use crate::arm::Arm;
use crate::kinematics::{Pose, cross, dot, from_axes};
use crate::measurement::{Measurement, Reading};
use crate::scalar::Scalar;

/// Where the tracker stands, from three of the measured points: the first, the one
/// farthest from it, the one farthest from the line of these two.
pub(super) fn place<T: Scalar, const N: usize>(
    arm: &Arm<T, N>,
    all: impl Iterator<Item = Measurement<T, N>> + Clone,
) -> Result<Pose<T>, ReidentifyError> {
    let points = all.filter_map(|measurement| match measurement.reading {
        Reading::Point(point) => Some((measurement.predicted(arm), point)),
        _ => None,
    });
    let Some(origin) = points.clone().next() else {
        return Err(ReidentifyError::PointsOnALine);
    };
    let farthest = |measure: &dyn Fn(&Vector3<T>) -> T| {
        let mut most = (T::ZERO, origin);
        for (predicted, point) in points.clone() {
            let size = measure(&(predicted - origin.0));
            if size > most.0 {
                most = (size, (predicted, point));
            }
        }
        (most.1.0 - origin.0, most.1.1 - origin.1)
    };
    let along = farthest(&|v| dot(v, v));
    let aside = farthest(&|v| {
        let c = cross(&along.0, v);
        dot(&c, &c)
    });
    let (there, here) = (frame(&along.0, &aside.0), frame(&along.1, &aside.1));
    let (Some(there), Some(here)) = (there, here) else {
        return Err(ReidentifyError::PointsOnALine);
    };
    let turn = Pose { rotation: here, ..Pose::identity() }
        .compose(&Pose { rotation: there.transpose(), ..Pose::identity() });
    Ok(Pose { translation: origin.1 - turn.transform_point(&origin.0), ..turn })
}

/// Right-handed axes: x along the first vector, y towards the second; `None`
/// where the two are within a milliradian of one line.
fn frame<T: Scalar>(along: &Vector3<T>, aside: &Vector3<T>) -> Option<Matrix3<T>> {
    let normal = cross(along, aside);
    let (length, height) = (dot(along, along).sqrt(), dot(&normal, &normal).sqrt());
    // Written so that a NaN is none, either.
    (height > T::from_f32(1e-3) * length * length).then(|| {
        let (x, z) = (along / length, normal / height);
        from_axes([x, cross(&z, &x), z])
    })
}
