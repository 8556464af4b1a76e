//! Cosine (component 0) and sine (component 1) of so many cycles per turn of a
//! joint: what the encoder's, the gear's and the unnamed periodic error share.

use heapless::Vec;

use super::{FoldedTerms, MAX_TERMS, Term, TermInputs};
use crate::scalar::Scalar;

pub(super) fn basis<T: Scalar, const N: usize>(
    term: &Term<T>,
    inputs: &TermInputs<T, N>,
) -> Option<T> {
    inputs.q.get(usize::from(term.joint)).map(|q| {
        let (sin, cos) = (*q * term.order).sin_cos();
        if term.component == 0 { cos } else { sin }
    })
}

pub(super) fn fold<T: Scalar, const N: usize>(term: &Term<T>, folded: &mut FoldedTerms<T, N>) {
    let Term { joint, order, coefficient, .. } = *term;
    let waves = &mut folded.waves.0;
    let wave = match waves.iter_mut().find(|w| w.joint == joint && w.order == order) {
        Some(wave) => Some(wave),
        None => {
            // As many places as terms: there is always one left.
            let _ = waves.push(Wave { joint, order, cos: T::ZERO, sin: T::ZERO });
            waves.last_mut()
        }
    };
    if let Some(wave) = wave {
        *if term.component == 0 { &mut wave.cos } else { &mut wave.sin } += coefficient;
    }
}

/// One sine-cosine for both components of an order at a joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Waves<T>(Vec<Wave<T>, MAX_TERMS>);

/// Joint `joint` is off by `cos cos(order q) + sin sin(order q)`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave<T> {
    joint: u8,
    order: T,
    cos: T,
    sin: T,
}

impl<T: Scalar> Waves<T> {
    pub fn none() -> Self {
        Self(Vec::new())
    }

    /// Adds the waves at joint values `q` to what bends the `joints`, and to `slopes`
    /// by how much they change with their own joint.
    #[inline]
    pub fn add<const N: usize>(&self, q: &[T; N], joints: &mut [T; N], slopes: &mut [T; N]) {
        for Wave { joint, order, cos, sin } in &self.0 {
            let joint = usize::from(*joint);
            let places = (joints.get_mut(joint), slopes.get_mut(joint), q.get(joint));
            if let (Some(bend), Some(slope), Some(q)) = places {
                let (s, c) = (*q * *order).sin_cos_once();
                *bend += *cos * c + *sin * s;
                *slope += *order * (*sin * c - *cos * s);
            }
        }
    }
}
