//! The base tilts under the overturning moment: about its x axis (component 0)
//! or its y axis (component 1).

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, Term, TermInputs};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 1,
    name: "base-compliance",
    acts_on: ActsOn::Base,
    coupled: false,
    components: &["x", "y"],
    order: Order::None,
    load: NeedsLoad::Moments,
    approach: false,
    warmth: false,
    revolute_only: false,
    units: Units::any("rad/Nm"),
    plausible: 1e-1,
    usual: 2e-4,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    inputs.load.moment.get(usize::from(term.component)).copied()
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    if let Some(tilt) = folded.tilt.0.get_mut(usize::from(term.component)) {
        *tilt += term.coefficient;
    }
}

/// rad per N m about the base's x and y.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tilt<T>([T; 2]);

impl<T: Scalar> Tilt<T> {
    pub fn none() -> Self {
        Self([T::ZERO; 2])
    }

    #[inline]
    pub fn bend<const N: usize>(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        let tilting = self.0.iter().zip(&inputs.load.moment);
        for (out, (tilt, moment)) in out.base.iter_mut().zip(tilting) {
            *out = *tilt * *moment;
        }
    }
}
