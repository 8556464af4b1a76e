//! The spring of a joint that stiffens under load, or softens: the joint turns
//! by c t |t| under its gravity torque t, beside its compliance. A strain-wave
//! gear's spring does.

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, Term, TermInputs};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 9,
    name: "joint-stiffening",
    acts_on: ActsOn::Joint,
    coupled: false,
    components: &[],
    order: Order::None,
    load: NeedsLoad::Torque,
    approach: false,
    warmth: false,
    revolute_only: false,
    units: Units::joint("rad/(N m)^2", "m/N^2"),
    // 600 urad at 10 N m is 6e-6.
    plausible: 1e-4,
    usual: 2e-6,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    inputs.load.torque.get(usize::from(term.joint)).map(|torque| *torque * torque.abs())
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    if let Some(stiffening) = folded.stiffening.by_joint.get_mut(usize::from(term.joint)) {
        *stiffening += term.coefficient;
        folded.stiffening.any = true;
    }
}

/// Two products a joint, if any stiffens.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stiffening<T, const N: usize> {
    any: bool,
    /// rad per (N m)^2, or m per N^2.
    by_joint: [T; N],
}

impl<T: Scalar, const N: usize> Stiffening<T, N> {
    pub fn none() -> Self {
        Self { any: false, by_joint: [T::ZERO; N] }
    }

    #[inline]
    pub fn bend(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        if self.any {
            let stiffening = self.by_joint.iter().zip(&inputs.load.torque);
            for (out, (stiffening, torque)) in out.joints.iter_mut().zip(stiffening) {
                *out += *stiffening * (*torque * torque.abs());
            }
        }
    }
}
