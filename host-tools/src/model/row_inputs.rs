//! What terms depend on at a row of an arm whose number of joints is known at run time.

use truearm::Approach;
use truearm::effects::{Load, Term, TermInputs, deflection, time_constant};
use truearm::kinematics::Deflection;
use truearm_sized::{fixed, with_joints};

use super::Warming;

/// What terms depend on at one row, for any number of joints; SI units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RowInputs {
    /// Gravity torque of each joint; empty without masses.
    pub torque: Vec<f64>,
    /// Overturning moment about the base's x and y.
    pub moment: [f64; 2],
    /// Moment across each joint's axis; empty without masses.
    pub across: Vec<[f64; 2]>,
    /// How each joint came to rest; empty if unknown.
    pub approach: Vec<Approach>,
    /// Temperature above reference as it was read, K.
    pub warmth: f64,
    /// What an arm that follows it late makes of it.
    pub warming: Option<Warming>,
    /// What the curves of a model add to each joint here, rad; empty without.
    pub curves: Vec<f64>,
}

impl RowInputs {
    /// Where nothing is known.
    pub(crate) const RIGID: Self = Self {
        torque: Vec::new(),
        moment: [0.0; 2],
        across: Vec::new(),
        approach: Vec::new(),
        warmth: 0.0,
        warming: None,
        curves: Vec::new(),
    };

    /// What the coefficient of a spring is multiplied by; 0 without loads.
    #[must_use]
    pub fn load(&self, spring: &Term<f64>) -> f64 {
        let still = vec![0.0; self.torque.len()];
        if still.is_empty() {
            return 0.0;
        }
        with_joints!(still.len(), N => spring.basis(&self.fixed::<N>(&still)))
    }

    /// Temperature above reference of an arm with this time constant, s, K.
    #[must_use]
    pub fn warmth_at(&self, time_constant: f64) -> f64 {
        match &self.warming {
            Some(warming) if time_constant > 0.0 => self.warmth + warming.ahead(time_constant),
            _ => self.warmth,
        }
    }

    /// For so many joints; what is not known is zero or [`Approach::Unknown`].
    pub(crate) fn fixed<const N: usize>(&self, q: &[f64]) -> TermInputs<f64, N> {
        let or_zero = |v: &[f64]| v.try_into().unwrap_or([0.0; N]);
        TermInputs {
            q: fixed(q),
            load: Load {
                torque: or_zero(&self.torque),
                moment: self.moment,
                across: self.across.as_slice().try_into().ok(),
            },
            approach: self.approach.as_slice().try_into().unwrap_or([Approach::Unknown; N]),
            warmth: self.warmth,
        }
    }

    /// The same as a term has it.
    pub(crate) fn fixed_for<const N: usize>(
        &self,
        q: &[f64],
        term: &Term<f64>,
    ) -> TermInputs<f64, N> {
        TermInputs { warmth: self.warmth_of(term), ..self.fixed::<N>(q) }
    }

    /// Temperature above reference that a term depends on, K.
    pub(crate) fn warmth_of(&self, term: &Term<f64>) -> f64 {
        self.warmth_at(time_constant(std::slice::from_ref(term)))
    }

    /// What terms and curves do to an arm.
    pub(super) fn deflection<const N: usize>(
        &self,
        terms: &[Term<f64>],
        inputs: &TermInputs<f64, N>,
    ) -> Deflection<f64, N> {
        let warmth = self.warmth_at(time_constant(terms));
        let mut out = deflection(terms, &TermInputs { warmth, ..*inputs });
        out.joints.iter_mut().zip(&self.curves).for_each(|(joint, curve)| *joint += curve);
        out
    }
}

impl RowInputs {
    /// Basis of a term at joint values `q`.
    #[must_use]
    pub fn basis(&self, q: &[f64], term: &Term<f64>) -> f64 {
        with_joints!(q.len(), N => term.basis(&self.fixed_for::<N>(q, term)))
    }
}
