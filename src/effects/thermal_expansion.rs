//! Lengths grow with temperature: those of one link, or of all ([`Term::ALL`]).

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, Term, TermInputs};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 8,
    name: "thermal-expansion",
    acts_on: ActsOn::Lengths,
    coupled: false,
    components: &[],
    order: Order::None,
    load: NeedsLoad::Never,
    approach: false,
    warmth: true,
    revolute_only: false,
    units: Units::any("1/K"),
    plausible: 1e-3,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    _: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    Some(inputs.warmth)
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    let growth = &mut folded.growth.0;
    if term.joint == Term::<T>::ALL {
        for growth in growth {
            *growth += term.coefficient;
        }
    } else if let Some(growth) = growth.get_mut(usize::from(term.joint)) {
        *growth += term.coefficient;
    }
}

/// 1/K of each link.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Growth<T, const N: usize>([T; N]);

impl<T: Scalar, const N: usize> Growth<T, N> {
    pub fn none() -> Self {
        Self([T::ZERO; N])
    }

    /// Relative growth of every link at a temperature so far above the reference.
    #[inline]
    pub fn at(&self, warmth: T) -> [T; N] {
        self.0.map(|growth| growth * warmth)
    }

    #[inline]
    pub fn bend(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        out.growth = self.at(inputs.warmth);
    }
}
