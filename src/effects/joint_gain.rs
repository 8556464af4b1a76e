//! The encoder's scale: a joint turns more or less than it says.

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, Term, TermInputs};
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 5,
    name: "joint-gain",
    acts_on: ActsOn::Joint,
    coupled: false,
    components: &[],
    order: Order::None,
    load: NeedsLoad::Never,
    approach: false,
    warmth: false,
    revolute_only: false,
    units: Units::joint("rad/rad", "m/m"),
    plausible: 5e-2,
    usual: 1e-3,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    inputs.q.get(usize::from(term.joint)).copied()
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    folded.slopes.push(term.joint, term.joint, term.coefficient);
}
