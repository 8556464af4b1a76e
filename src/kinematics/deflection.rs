use crate::scalar::Scalar;

/// How far an arm is from rigid at one moment: what its joints, its base and its
/// lengths do beyond their geometry. Kinematics does not ask why; the terms of
/// [`crate::effects`] produce it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Deflection<T, const N: usize> {
    /// Added to each joint value, rad or m.
    pub joints: [T; N],
    /// Rotation of the base about its own x and y axes, rad.
    pub base: [T; 2],
    /// Relative growth of each link's lengths `a` and `d`.
    pub growth: [T; N],
}

impl<T: Scalar, const N: usize> Deflection<T, N> {
    /// A rigid arm.
    #[must_use]
    pub const fn none() -> Self {
        Self { joints: [T::ZERO; N], base: [T::ZERO; 2], growth: [T::ZERO; N] }
    }

    /// Where the joints are at encoder readings `q`, rad or m.
    #[must_use]
    #[inline]
    pub fn deflected(&self, q: &[T; N]) -> [T; N] {
        let mut joints = *q;
        for (q, deflection) in joints.iter_mut().zip(&self.joints) {
            *q += *deflection;
        }
        joints
    }
}
