//! What a model makes of a reading.

use nalgebra::Vector3;

use crate::parameters::Parameter;
use crate::scalar::Scalar;

/// How far a plane or an anchor is from where it is stated to be.
pub(super) struct Moved<T> {
    /// Rotation vector of a plane about its point, rad.
    pub turn: Vector3<T>,
    /// Of a plane along its normal, m.
    pub offset: T,
    /// Of an anchor, m.
    pub shift: Vector3<T>,
}

impl<T: Scalar> Moved<T> {
    /// As `change` of those of the parameters says that are `its` own.
    pub fn by(parameters: &[Parameter], change: &[T], its: impl Fn(Parameter) -> bool) -> Self {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let mut moved = Self { turn: none, offset: T::ZERO, shift: none };
        for (parameter, change) in parameters.iter().zip(change).filter(|(p, _)| its(**p)) {
            match parameter {
                Parameter::PlaneRotation { axis, .. } => moved.turn += axis.unit() * *change,
                Parameter::PlaneOffset(_) => moved.offset += *change,
                Parameter::AnchorTranslation { axis, .. } => moved.shift += axis.unit() * *change,
                _ => {}
            }
        }
        moved
    }
}

/// What a reading is beyond the model, m.
pub(super) enum Rest<T> {
    Point(Vector3<T>),
    Number(T, Modelled<T>),
}

/// A number as the model has it, m, and how it moves.
pub(super) struct Modelled<T> {
    /// m
    pub value: T,
    /// Its derivative to the tool point: a unit vector.
    pub along: Vector3<T>,
    /// To [`Moved::turn`], m per rad.
    pub turned: Vector3<T>,
}

impl<T: Scalar> Modelled<T> {
    /// Its derivative to a parameter of its own plane or anchor, m per unit.
    pub fn derivative(&self, parameter: Parameter) -> T {
        match parameter {
            Parameter::PlaneRotation { axis, .. } => axis.of(self.turned.data.0[0]),
            Parameter::PlaneOffset(_) => -T::ONE,
            Parameter::AnchorTranslation { axis, .. } => -axis.of(self.along.data.0[0]),
            _ => T::ZERO,
        }
    }
}
