//! Values of a blob's fields in the reader's scalar. Calls, not copies: a blob is
//! read once.

use nalgebra::Vector3;

use super::fields::Field;
use crate::kinematics::MdhParameters;
use crate::scalar::Scalar;

#[inline(never)]
pub(super) fn real<T: Scalar>(field: &Field, bytes: &[u8]) -> T {
    let [value] = field.read(bytes);
    T::from_f32(value)
}

#[inline(never)]
pub(super) fn vector<T: Scalar>(field: &Field, bytes: &[u8]) -> Vector3<T> {
    let [x, y, z] = field.read(bytes).map(T::from_f32);
    Vector3::new(x, y, z)
}

#[inline(never)]
pub(super) fn mdh<T: Scalar>(field: &Field, bytes: &[u8]) -> MdhParameters<T> {
    MdhParameters::from_array(field.read(bytes).map(T::from_f32))
}

#[inline(never)]
pub(super) fn range<T: Scalar>(field: &Field, bytes: &[u8], present: bool) -> Option<[T; 2]> {
    present.then_some(field.read(bytes).map(T::from_f32))
}
