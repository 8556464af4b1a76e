//! What may be missing: the effects of the repertoire that the data can test,
//! where they may be.

use crate::effects::{self, Data, Offer};
use crate::identify::Problem;
use crate::model::{ModelTerm, Robot};

/// One possible addition to a model: an effect at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its terms, coefficients zero.
    pub terms: Vec<ModelTerm>,
    /// How many alternatives of its kind were tried: the price of choosing.
    pub tried: f64,
}

impl Candidate {
    /// Name of the effect.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.terms.first().map_or("", ModelTerm::effect_name)
    }

    /// Joints as in reports.
    #[must_use]
    pub fn joints(&self) -> Vec<usize> {
        self.terms.first().map_or(Vec::new(), ModelTerm::joints)
    }
}

impl From<Offer> for Candidate {
    fn from(Offer { terms, tried }: Offer) -> Self {
        Self { terms, tried }
    }
}

/// All candidates but those that a scan finds, and what cannot be tested for
/// want of a column. Masses of the robot may be `assumed` only.
#[must_use]
pub fn all(problem: &Problem, robot: &Robot, assumed: bool) -> (Vec<Candidate>, Vec<String>) {
    let conditions = &problem.conditions;
    let (offers, missing) = effects::offers(&Data { robot, conditions, assumed });
    (offers.into_iter().map(Candidate::from).collect(), missing)
}

/// Terms that go into a blob.
#[must_use]
pub fn arm_terms(added: &[Candidate]) -> usize {
    added.iter().map(of_arm).sum()
}

pub(super) fn of_arm(candidate: &Candidate) -> usize {
    candidate.terms.iter().filter(|term| matches!(term, ModelTerm::Arm(_))).count()
}
