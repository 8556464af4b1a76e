//! What may be missing: the effects of the repertoire that the data can test,
//! where they may be.

use truearm::effects::Order;

use crate::effects::{self, Data, Offer};
use crate::identify::Problem;
use crate::model::{Measurements, ModelTerm, Robot, Row};

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

    /// With which the arm follows its temperature, s; 0: at once, or it does not depend on it.
    #[must_use]
    pub fn time_constant(&self) -> f64 {
        self.terms.iter().find_map(ModelTerm::time_constant).unwrap_or(0.0)
    }

    /// The same of an arm that follows its temperature with this time constant, s.
    #[must_use]
    pub fn late(&self, time_constant: f64) -> Self {
        let mut out = self.clone();
        for term in &mut out.terms {
            if let ModelTerm::Arm(term) = term
                && term.effect.order() == Order::TimeConstant
            {
                term.order = time_constant;
            }
        }
        out
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
pub fn all(
    problem: &Problem,
    robot: &Robot,
    assumed: bool,
    holdout: Option<&Measurements>,
) -> (Vec<Candidate>, Vec<String>) {
    let conditions = &problem.conditions;
    let (offers, mut missing) = effects::offers(&Data { robot, conditions, assumed });
    let mut all: Vec<Candidate> = offers.into_iter().map(Candidate::from).collect();
    // What a hold-out file cannot judge is not looked for.
    let untimed = |row: &Row| row.temperature.is_some() && row.warming.is_none();
    let judged = holdout.is_none_or(|held| !held.rows.iter().any(untimed));
    if conditions.temperature && (conditions.warming.is_none() || !judged) {
        let file = if judged { "" } else { " of the hold-out file" };
        missing.push(format!("thermal-expansion that is late: needs time_s in every row{file}"));
        all.retain(|candidate| candidate.time_constant() == 0.0);
    }
    (all, missing)
}

/// Terms that go into a blob.
#[must_use]
pub fn arm_terms(added: &[Candidate]) -> usize {
    added.iter().map(of_arm).sum()
}

pub(super) fn of_arm(candidate: &Candidate) -> usize {
    candidate.terms.iter().filter(|term| matches!(term, ModelTerm::Arm(_))).count()
}
