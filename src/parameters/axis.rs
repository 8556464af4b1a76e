use nalgebra::Vector3;

use crate::scalar::Scalar;

/// An axis of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

impl Axis {
    /// All three.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The element along it.
    pub(crate) fn of<V>(self, [x, y, z]: [V; 3]) -> V {
        match self {
            Self::X => x,
            Self::Y => y,
            Self::Z => z,
        }
    }

    pub(crate) fn unit<T: Scalar>(self) -> Vector3<T> {
        let (o, l) = (T::ZERO, T::ONE);
        self.of([Vector3::new(l, o, o), Vector3::new(o, l, o), Vector3::new(o, o, l)])
    }
}
