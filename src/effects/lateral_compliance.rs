//! The axis of a joint tilts under the gravity moment across it: its bearing and the
//! link that carries it give way, as far in either direction. The first joint's
//! does what the base does.

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, Term, TermInputs};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 10,
    name: "lateral-compliance",
    acts_on: ActsOn::Axis,
    coupled: false,
    components: &[],
    order: Order::None,
    load: NeedsLoad::Moments,
    approach: false,
    warmth: false,
    revolute_only: true,
    units: Units::any("rad/Nm"),
    plausible: 1e-1,
    usual: 2e-4,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    let [size, ..] = inputs.load.across_axis(usize::from(term.joint))?;
    Some(size)
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    if let Some(compliance) = folded.bearings.compliance.get_mut(usize::from(term.joint)) {
        *compliance += term.coefficient;
        folded.bearings.tilting |= 1_u16.wrapping_shl(u32::from(term.joint));
    }
}

/// Two products a joint, if the axis of any tilts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bearings<T, const N: usize> {
    /// A bit a joint, whatever its compliance: what a term would do is asked of zero, too.
    tilting: u16,
    /// rad per N m.
    compliance: [T; N],
}

impl<T: Scalar, const N: usize> Bearings<T, N> {
    pub fn none() -> Self {
        Self { tilting: 0, compliance: [T::ZERO; N] }
    }

    /// Whether any tilts.
    pub fn any(&self) -> bool {
        self.tilting != 0
    }

    /// Whether that of a joint does.
    pub fn tilts(&self, joint: usize) -> bool {
        self.tilting.wrapping_shr(joint as u32) & 1 == 1
    }

    #[inline]
    pub fn bend(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        if self.any() {
            let Some(mut tilts) = inputs.load.across else { return };
            for (tilt, compliance) in tilts.iter_mut().zip(&self.compliance) {
                *tilt = tilt.map(|moment| moment * *compliance);
            }
            out.axes = Some(tilts);
        }
    }
}
