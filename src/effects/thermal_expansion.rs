//! Lengths grow with temperature: those of one link, or of all ([`Term::ALL`]). Where
//! the arm warms up later than the place at which its temperature is read, the order of
//! its terms is the time constant of [`crate::ThermalLag`], which makes of readings what
//! the terms depend on.

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
    order: Order::TimeConstant,
    load: NeedsLoad::Never,
    approach: false,
    warmth: true,
    revolute_only: false,
    units: Units::any("1/K"),
    plausible: 1e-3,
    usual: 2e-5,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    _: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    Some(inputs.warmth)
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    let Growth { any, by_link } = &mut folded.growth;
    if term.joint == Term::<T>::ALL {
        for growth in by_link {
            *growth += term.coefficient;
        }
        *any = true;
    } else if let Some(growth) = by_link.get_mut(usize::from(term.joint)) {
        *growth += term.coefficient;
        *any = true;
    }
}

/// One product a link, if any grows: without a term the temperature is not looked at.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Growth<T, const N: usize> {
    any: bool,
    /// 1/K.
    by_link: [T; N],
}

/// Time constant, s, with which an arm of these terms follows its temperature: all its terms
/// have one; 0 of an arm that follows it at once, or does not grow.
#[must_use]
pub fn time_constant<T: Scalar>(terms: &[Term<T>]) -> T {
    let grows = |term: &&Term<T>| matches!(term.effect.order(), Order::TimeConstant);
    terms.iter().find(grows).map_or(T::ZERO, |term| term.order)
}

impl<T: Scalar, const N: usize> Growth<T, N> {
    pub fn none() -> Self {
        Self { any: false, by_link: [T::ZERO; N] }
    }

    /// Whether any grows.
    pub fn any(&self) -> bool {
        self.any
    }

    /// Relative growth of every link at a temperature so far above the reference.
    #[inline]
    pub fn grow(&self, warmth: T, out: &mut Deflection<T, N>) {
        if self.any {
            out.growth = self.by_link.map(|growth| growth * warmth);
        }
    }

    #[inline]
    pub fn bend(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        self.grow(inputs.warmth, out);
    }
}
