//! What terms do at one moment of a tick, where the sines are known.

use nalgebra::Vector3;

use super::{Arm, State};
use crate::kinematics::{Deflection, Turns};
use crate::scalar::Scalar;

/// What terms do at one moment, and how it changes with the joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bent<T, const N: usize> {
    pub deflection: Deflection<T, N>,
    /// Of each joint's periodic terms and its curve by that joint.
    slopes: [T; N],
}

impl<T: Scalar, const N: usize> Bent<T, N> {
    /// Nothing.
    pub fn none() -> Self {
        Self { deflection: Deflection::none(), slopes: [T::ZERO; N] }
    }

    /// Joints, in `offset` from the command, at which the rigid chain stands
    /// where `rigid` wants it: from the offset at which the terms are known, one
    /// Newton step a joint.
    #[inline]
    pub fn take_back(&self, rigid: &[T; N], offset: &mut [T; N]) {
        let known = self.deflection.joints.iter().zip(&self.slopes);
        for (offset, (rigid, (bend, slope))) in offset.iter_mut().zip(rigid.iter().zip(known)) {
            let step = *rigid - *bend - *offset;
            let mut slope = T::ONE + *slope;
            // Steeper than any gear; the step stays one.
            if slope < T::from_f32(0.5) {
                slope = T::from_f32(0.5);
            }
            *offset += step / slope;
        }
    }

    /// Keeps of what bends each joint what is taken back at one of this `share`, its square as
    /// of the rigid chain's correction; the rest is added to where the rigid chain `stands`.
    #[cold]
    #[inline(never)]
    pub fn share_out(&mut self, share: &[T; N], stands: &mut [T; N]) {
        let bends = self.deflection.joints.iter_mut().zip(&mut self.slopes);
        for ((bend, slope), (share, stands)) in bends.zip(share.iter().zip(stands)) {
            let taken = *share * *share;
            *stands += *bend * (T::ONE - taken);
            *bend *= taken;
            *slope *= taken;
        }
    }
}

impl<T: Scalar, const N: usize> Arm<'_, T, N> {
    /// Whether links grow.
    #[inline]
    pub(crate) fn grows(&self) -> bool {
        self.folded.needs_warmth()
    }

    /// What terms do whatever the joints: links grow.
    #[inline]
    pub(crate) fn grow(&self, state: &State<T, N>, bent: &mut Bent<T, N>) {
        *bent = Bent::none();
        let warmth = state.temperature - self.reference_temperature;
        self.folded.grow(warmth, &mut bent.deflection);
    }

    /// What all terms do near joint values whose sines are known. `offset`, of
    /// the joints from `command`, becomes what takes back at each joint, by the
    /// square of its `share`, what bends it smoothly, so that the rigid chain stands where
    /// `rigid` wants it; there the periodic terms and the curves are taken.
    #[inline(never)]
    pub(crate) fn bend(
        &self,
        turns: &Turns<T, N>,
        state: &State<T, N>,
        [command, rigid, share]: [&[T; N]; 3],
        offset: &mut [T; N],
        bent: &mut Bent<T, N>,
    ) {
        self.folded.smooth(&self.inputs_at(turns, state), &mut bent.deflection);
        let mut joints = [T::ZERO; N];
        let smooth = bent.deflection.joints.iter().zip(share);
        let places = offset.iter_mut().zip(joints.iter_mut().zip(command));
        for ((offset, (joint, q)), (rigid, (bend, share))) in places.zip(rigid.iter().zip(smooth)) {
            *offset = *rigid - *share * *share * *bend;
            *joint = *q + *offset;
        }
        bent.slopes = [T::ZERO; N];
        self.folded.add_waves(&joints, &mut bent.deflection.joints, &mut bent.slopes);
        if !self.curves.is_empty() {
            self.curves.add(&joints, &mut bent.deflection.joints, &mut bent.slopes);
        }
    }

    /// Two axes and the point of the tool of the rigid identified arm, in the frame that its
    /// first joint turns in, at angles whose sines are known, with its base tilted and its
    /// links grown.
    #[inline]
    pub(crate) fn rigid_axes(
        &self,
        turns: &Turns<T, N>,
        bent: Option<&Bent<T, N>>,
    ) -> [Vector3<T>; 3] {
        self.real.axes_at(turns, bent.map(|bent| &bent.deflection), self.grows())
    }
}
