use crate::scalar::Scalar;

/// How far an arm is from rigid at one moment: what its joints, its base, its axes and
/// its lengths do beyond their geometry. Kinematics does not ask why; the terms of
/// [`crate::effects`] produce it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Deflection<T, const N: usize> {
    /// Added to each joint value, rad or m.
    pub joints: [T; N],
    /// Rotation of the base about its own x and y axes, rad.
    pub base: [T; 2],
    /// Rotation of each joint's axis about the x and y of the frame that the joint turns
    /// in, behind its link's alpha and a, rad; `None` if no axis tilts.
    pub axes: Option<[[T; 2]; N]>,
    /// Relative growth of each link's lengths `a` and `d`.
    pub growth: [T; N],
}

impl<T: Scalar, const N: usize> Deflection<T, N> {
    /// A rigid arm.
    #[must_use]
    pub const fn none() -> Self {
        Self { joints: [T::ZERO; N], base: [T::ZERO; 2], axes: None, growth: [T::ZERO; N] }
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
