use heapless::Vec;

use super::MAX_TERMS;
use super::inputs::TermInputs;
use super::term::{Effect, Term};
use crate::kinematics::Deflection;
use crate::scalar::Scalar;

/// Terms sorted at load time into what a tick has to compute: one sine-cosine
/// for both components of a periodic error, one product a compliant joint. It
/// gives what [`super::deflection`] gives, summed in another order.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldedTerms<T, const N: usize> {
    /// rad per N m of each joint.
    compliance: [T; N],
    /// rad per N m about the base's x and y.
    tilt: [T; 2],
    /// 1/K of each link.
    growth: [T; N],
    waves: Vec<Wave<T>, MAX_TERMS>,
    slopes: Vec<Slope<T>, MAX_TERMS>,
    gaps: Vec<Gap<T>, MAX_TERMS>,
    needs_load: bool,
}

/// Joint `joint` is off by `cos cos(order q) + sin sin(order q)`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave<T> {
    joint: u8,
    order: T,
    cos: T,
    sin: T,
}

/// Joint `joint` turns with joint `source`, itself for a gain.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slope<T> {
    joint: u8,
    source: u8,
    coefficient: T,
}

/// Play in joint `joint`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gap<T> {
    joint: u8,
    friction: T,
    half: T,
}

impl<T: Scalar, const N: usize> FoldedTerms<T, N> {
    /// Sorts terms; a joint that the arm does not have is ignored.
    #[must_use]
    pub fn new(terms: &Vec<Term<T>, MAX_TERMS>) -> Self {
        let mut out = Self {
            compliance: [T::ZERO; N],
            tilt: [T::ZERO; 2],
            growth: [T::ZERO; N],
            waves: Vec::new(),
            slopes: Vec::new(),
            gaps: Vec::new(),
            needs_load: terms.iter().any(Term::needs_load),
        };
        for term in terms {
            out.add(term);
        }
        out
    }

    #[inline(never)]
    fn add(&mut self, term: &Term<T>) {
        let Term { joint, source, order, coefficient, .. } = *term;
        let slot = match term.effect {
            Effect::JointCompliance => self.compliance.get_mut(usize::from(joint)),
            Effect::BaseCompliance => self.tilt.get_mut(usize::from(term.component)),
            Effect::ThermalExpansion if joint == Term::<T>::ALL => {
                for growth in &mut self.growth {
                    *growth += coefficient;
                }
                None
            }
            Effect::ThermalExpansion => self.growth.get_mut(usize::from(joint)),
            Effect::EncoderEccentricity
            | Effect::GearTransmissionError
            | Effect::JointPeriodicError => {
                let known = self.waves.iter_mut().find(|w| w.joint == joint && w.order == order);
                let wave = match known {
                    Some(wave) => Some(wave),
                    None => {
                        let wave = Wave { joint, order, cos: T::ZERO, sin: T::ZERO };
                        // As many places as terms: there is always one left.
                        let _ = self.waves.push(wave);
                        self.waves.last_mut()
                    }
                };
                wave.map(|w| if term.component == 0 { &mut w.cos } else { &mut w.sin })
            }
            Effect::JointGain => {
                let _ = self.slopes.push(Slope { joint, source: joint, coefficient });
                None
            }
            Effect::JointCoupling => {
                let _ = self.slopes.push(Slope { joint, source, coefficient });
                None
            }
            Effect::Backlash => {
                let _ = self.gaps.push(Gap { joint, friction: order, half: coefficient });
                None
            }
        };
        if let Some(slot) = slot {
            *slot += coefficient;
        }
    }

    /// Whether gravity torques have to be computed for [`Self::deflection`].
    #[must_use]
    pub fn needs_load(&self) -> bool {
        self.needs_load
    }

    /// What all terms together do.
    #[must_use]
    #[inline]
    pub fn deflection(&self, inputs: &TermInputs<T, N>) -> Deflection<T, N> {
        let mut out = self.smooth(inputs);
        let _ = self.add_waves(&inputs.q, &mut out.joints);
        out
    }

    /// Relative growth of every link at a temperature so far above the reference.
    pub(crate) fn growth(&self, warmth: T) -> [T; N] {
        self.growth.map(|g| g * warmth)
    }

    /// What all but the periodic terms do: those which hardly change from the
    /// command to the corrected joints.
    #[inline]
    pub(crate) fn smooth(&self, inputs: &TermInputs<T, N>) -> Deflection<T, N> {
        let mut out = Deflection {
            joints: [T::ZERO; N],
            base: [T::ZERO; 2],
            growth: self.growth(inputs.warmth),
        };
        if self.needs_load {
            let compliant = self.compliance.iter().zip(&inputs.load.torque);
            for (out, (compliance, torque)) in out.joints.iter_mut().zip(compliant) {
                *out = *compliance * *torque;
            }
            let tilting = self.tilt.iter().zip(&inputs.load.moment);
            for (out, (tilt, moment)) in out.base.iter_mut().zip(tilting) {
                *out = *tilt * *moment;
            }
        }
        let at = |values: &[T; N], joint: u8| values.get(usize::from(joint)).copied();
        let mut add = |joint: u8, bend: Option<T>| {
            if let (Some(slot), Some(bend)) = (out.joints.get_mut(usize::from(joint)), bend) {
                *slot += bend;
            }
        };
        for Slope { joint, source, coefficient } in &self.slopes {
            add(*joint, at(&inputs.q, *source).map(|q| q * *coefficient));
        }
        for Gap { joint, friction, half } in &self.gaps {
            let torque = at(&inputs.load.torque, *joint);
            let approach = inputs.approach.get(usize::from(*joint));
            let side =
                torque.zip(approach).map(|(t, a)| super::term::side_of_gap(*friction, t, *a));
            add(*joint, side.map(|side| side * *half));
        }
        out
    }

    /// Adds the periodic terms at joint values `q` to what bends the `joints`;
    /// returns by how much these terms change with their own joint.
    #[inline]
    pub(crate) fn add_waves(&self, q: &[T; N], joints: &mut [T; N]) -> [T; N] {
        let mut slopes = [T::ZERO; N];
        for Wave { joint, order, cos, sin } in &self.waves {
            let joint = usize::from(*joint);
            let places = (joints.get_mut(joint), slopes.get_mut(joint), q.get(joint));
            if let (Some(bend), Some(slope), Some(q)) = places {
                let (s, c) = (*q * *order).sin_cos_once();
                *bend += *cos * c + *sin * s;
                *slope += *order * (*sin * c - *cos * s);
            }
        }
        slopes
    }
}
