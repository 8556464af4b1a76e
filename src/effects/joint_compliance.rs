//! A joint gives way to its gravity torque like a spring.

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, Term, TermInputs};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 0,
    name: "joint-compliance",
    acts_on: ActsOn::Joint,
    coupled: false,
    components: &[],
    order: Order::None,
    load: NeedsLoad::Torque,
    approach: false,
    warmth: false,
    revolute_only: false,
    units: Units::joint("rad/Nm", "m/N"),
    plausible: 1e-1,
    usual: 2e-4,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    inputs.load.torque.get(usize::from(term.joint)).copied()
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    if let Some(compliance) = folded.springs.compliance.get_mut(usize::from(term.joint)) {
        *compliance += term.coefficient;
    }
}

/// One product a joint, if any is compliant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Springs<T, const N: usize> {
    /// rad per N m, or m per N.
    compliance: [T; N],
}

impl<T: Scalar, const N: usize> Springs<T, N> {
    pub fn none() -> Self {
        Self { compliance: [T::ZERO; N] }
    }

    #[inline]
    pub fn bend(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        let compliant = self.compliance.iter().zip(&inputs.load.torque);
        for (out, (compliance, torque)) in out.joints.iter_mut().zip(compliant) {
            *out = *compliance * *torque;
        }
    }
}
