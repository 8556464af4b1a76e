//! Half the play of a joint, positive. The link lags behind the motion it came
//! to rest from, unless the gravity torque exceeds the friction (the order of a
//! term; 0: never) and pulls it to the other side of the gap.

use heapless::Vec;

use super::approach::Approach;
use super::descriptor::{ActsOn, Descriptor, NeedsLoad, Order, Units};
use super::{FoldedTerms, MAX_TERMS, Term, TermInputs};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    code: 7,
    name: "backlash",
    acts_on: ActsOn::Joint,
    coupled: false,
    components: &[],
    order: Order::Friction,
    load: NeedsLoad::WithFriction,
    approach: true,
    warmth: false,
    revolute_only: false,
    units: Units::joint("rad", "m"),
    plausible: 5e-2,
    usual: 1e-3,
};

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    let joint = usize::from(term.joint);
    let torque = inputs.load.torque.get(joint)?;
    Some(side_of_gap(term.order, *torque, *inputs.approach.get(joint)?))
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    let Term { joint, order: friction, coefficient: half, .. } = *term;
    // As many places as terms.
    let _ = folded.gaps.0.push(Gap { joint, friction, half });
}

/// The side of the gap a link lies on: +1, -1, or 0 if unknown.
#[inline(never)]
fn side_of_gap<T: Scalar>(friction: T, torque: T, approach: Approach) -> T {
    if friction > T::ZERO && torque.abs() > friction {
        if torque > T::ZERO { T::ONE } else { -T::ONE }
    } else {
        -approach.sign::<T>()
    }
}

/// Joints with play.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Gaps<T>(Vec<Gap<T>, MAX_TERMS>);

/// Play in joint `joint`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gap<T> {
    joint: u8,
    friction: T,
    half: T,
}

impl<T: Scalar> Gaps<T> {
    pub fn none() -> Self {
        Self(Vec::new())
    }

    #[inline]
    pub fn bend<const N: usize>(&self, inputs: &TermInputs<T, N>, out: &mut Deflection<T, N>) {
        for Gap { joint, friction, half } in &self.0 {
            let joint = usize::from(*joint);
            let known = (inputs.load.torque.get(joint), inputs.approach.get(joint));
            if let (Some(out), (Some(torque), Some(approach))) = (out.joints.get_mut(joint), known)
            {
                *out += side_of_gap(*friction, *torque, *approach) * *half;
            }
        }
    }
}
