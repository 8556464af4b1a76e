//! Orientations in every form they are published in, as matrix and quaternion.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::error::{Error, Result};
use crate::headings::{Quantity, Unit};

/// A form of orientation, by the names of its columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// `qx, qy, qz, qw`, wherever each stands in the file.
    Quaternion,
    /// `roll, pitch, yaw` about the fixed axes x, y, z: R = Rz Ry Rx. The same
    /// as KUKA's A, B, C about z, y, x of the moving frame.
    Rpy,
    /// `rx, ry, rz`: axis times angle.
    Vector,
    /// `r11..r33`, row by row.
    Matrix,
}

impl Form {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Quaternion, Self::Rpy, Self::Vector, Self::Matrix];

    /// Names of its columns.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Quaternion => &["qx", "qy", "qz", "qw"],
            Self::Rpy => &["roll", "pitch", "yaw"],
            Self::Vector => &["rx", "ry", "rz"],
            Self::Matrix => &["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"],
        }
    }

    /// The unit of its columns where nothing else says it.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Quaternion | Self::Matrix => Quantity::Plain,
            Self::Rpy | Self::Vector => Quantity::Angle,
        }
    }

    /// The rotation; `None` of numbers that are none: a quaternion or a matrix
    /// that is not of length one within a hundredth.
    pub fn rotation(self, values: &[f64]) -> Option<Matrix3<f64>> {
        match (self, values) {
            (Self::Quaternion, &[x, y, z, w]) => {
                let q = nalgebra::Quaternion::new(w, x, y, z);
                ((q.norm() - 1.0).abs() < 1e-2)
                    .then(|| UnitQuaternion::new_normalize(q).to_rotation_matrix().into_inner())
            }
            (Self::Rpy, &[roll, pitch, yaw]) => {
                Some(Rotation3::from_euler_angles(roll, pitch, yaw).into_inner())
            }
            (Self::Vector, &[x, y, z]) => Some(Rotation3::new(Vector3::new(x, y, z)).into_inner()),
            (Self::Matrix, v) if v.len() == 9 => {
                let m = Matrix3::from_row_slice(v);
                let off = (m * m.transpose() - Matrix3::identity()).abs().max();
                (off < 1e-2 && m.determinant() > 0.0).then_some(m)
            }
            _ => None,
        }
    }
}

/// What `--orientation` takes: the form, and the unit of its angles or the
/// order of its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Asked {
    pub form: Form,
    pub unit: Unit,
    /// The scalar stands first.
    pub scalar_first: bool,
}

/// `none` is `None`.
pub(super) fn asked(word: &str) -> Result<Option<Asked>> {
    let of = |form, unit, scalar_first| Ok(Some(Asked { form, unit, scalar_first }));
    match word {
        "none" => Ok(None),
        "xyzw" => of(Form::Quaternion, Unit::Plain, false),
        "wxyz" => of(Form::Quaternion, Unit::Plain, true),
        "rpy-deg" => of(Form::Rpy, Unit::Deg, false),
        "rpy-rad" => of(Form::Rpy, Unit::Rad, false),
        "vector-deg" => of(Form::Vector, Unit::Deg, false),
        "vector-rad" => of(Form::Vector, Unit::Rad, false),
        "matrix" => of(Form::Matrix, Unit::Plain, false),
        _ => Err(Error::usage(
            format!("--orientation {word}"),
            "give none, xyzw, wxyz, rpy-deg, rpy-rad, vector-deg, vector-rad or matrix",
        )),
    }
}

/// The quaternion x, y, z, w of a rotation, w not negative.
pub(super) fn quaternion(rotation: &Matrix3<f64>) -> [f64; 4] {
    let q = UnitQuaternion::from_matrix(rotation);
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    [q.i * sign, q.j * sign, q.k * sign, q.w * sign]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One rotation in all forms.
    #[test]
    fn forms_agree() {
        for (roll, pitch, yaw) in
            [(0.3, -0.4, 2.9), (-3.0, 1.2, 0.1), (0.0, 0.0, 3.1), (1.0, 1.5, -2.0)]
        {
            let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
            let q = UnitQuaternion::from_rotation_matrix(&turn);
            let v = turn.scaled_axis();
            let m = turn.into_inner();
            let entries: Vec<f64> = m.transpose().iter().copied().collect();
            for (form, values) in [
                (Form::Quaternion, vec![q.i, q.j, q.k, q.w]),
                (Form::Rpy, vec![roll, pitch, yaw]),
                (Form::Vector, vec![v.x, v.y, v.z]),
                (Form::Matrix, entries),
            ] {
                let found = form.rotation(&values).unwrap();
                assert!((found - m).abs().max() < 1e-9, "{form:?}");
                let [x, y, z, w] = quaternion(&found);
                assert!(w >= 0.0);
                let again = Form::Quaternion.rotation(&[x, y, z, w]).unwrap();
                assert!((again - m).abs().max() < 1e-9, "{form:?}");
            }
        }
        assert_eq!(Form::Quaternion.rotation(&[1.0, 1.0, 0.0, 0.0]), None);
        assert_eq!(Form::Matrix.rotation(&[2.0; 9]), None);
    }
}
