use super::FoldedTerms;
use super::inputs::TermInputs;
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

impl<T: Scalar, const N: usize> FoldedTerms<T, N> {
    /// Whether gravity torques have to be computed for [`Self::deflection`].
    #[must_use]
    pub fn needs_load(&self) -> bool {
        self.needs_load
    }

    /// Whether torques of joints are among them, which may be read instead.
    pub(crate) fn needs_torque(&self) -> bool {
        self.needs_torque
    }

    /// Whether [`Self::needs_load`] includes the moments across the axes.
    pub(crate) fn tilts_axes(&self) -> bool {
        self.bearings.any()
    }

    /// Whether the axis of a joint does.
    pub(crate) fn tilts(&self, joint: usize) -> bool {
        self.bearings.tilts(joint)
    }

    /// What all terms together do.
    #[must_use]
    #[inline]
    pub fn deflection(&self, inputs: &TermInputs<T, N>) -> Deflection<T, N> {
        let mut out = Deflection::none();
        self.smooth(inputs, &mut out);
        self.add_waves(&inputs.q, &mut out.joints, &mut [T::ZERO; N]);
        out
    }

    /// Whether the temperature counts.
    pub(crate) fn needs_warmth(&self) -> bool {
        self.growth.any()
    }

    /// What terms do whatever the joints, at a temperature so far above the reference.
    #[inline]
    pub(crate) fn grow(&self, warmth: T, out: &mut Deflection<T, N>) {
        self.growth.grow(warmth, out);
    }

    /// Adds the periodic terms at joint values `q` to what bends the `joints`, and to
    /// `slopes` by how much these terms change with their own joint.
    #[inline]
    pub(crate) fn add_waves(&self, q: &[T; N], joints: &mut [T; N], slopes: &mut [T; N]) {
        self.waves.add(q, joints, slopes);
    }
}
