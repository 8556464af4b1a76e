//! A joint turns with another one, its source.

use heapless::Vec;

use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, MAX_TERMS, Term, TermInputs};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 6,
    name: "joint-coupling",
    acts_on: ActsOn::Joint,
    coupled: true,
    components: &[],
    order: Order::None,
    load: NeedsLoad::Never,
    approach: false,
    warmth: false,
    revolute_only: false,
    units: Units::joints([["rad/rad", "rad/m"], ["m/rad", "m/m"]]),
    plausible: 5e-2,
    usual: 1e-3,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    inputs.q.get(usize::from(term.source)).copied()
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    folded.slopes.push(term.joint, term.source, term.coefficient);
}

/// Joints that turn with a joint, themselves or another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slopes<T>(Vec<Slope<T>, MAX_TERMS>);

/// Joint `joint` turns with joint `source`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slope<T> {
    joint: u8,
    source: u8,
    coefficient: T,
}

impl<T: Scalar> Slopes<T> {
    pub fn none() -> Self {
        Self(Vec::new())
    }

    pub fn push(&mut self, joint: u8, source: u8, coefficient: T) {
        // As many places as terms.
        let _ = self.0.push(Slope { joint, source, coefficient });
    }

    #[inline]
    pub fn bend<const N: usize>(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        for Slope { joint, source, coefficient } in &self.0 {
            let source = inputs.q.get(usize::from(*source));
            if let (Some(out), Some(q)) = (out.joints.get_mut(usize::from(*joint)), source) {
                *out += *q * *coefficient;
            }
        }
    }
}
