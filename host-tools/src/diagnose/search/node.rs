//! A fitted explanation, and how two are compared.

use crate::diagnose::candidates::Candidate;
use crate::diagnose::policy::POLICY;
use crate::effects;
use crate::identify::robust::RobustFit;
use crate::model::ModelTerm;

/// A fitted explanation.
#[derive(Debug, Clone)]
pub struct Node {
    /// What was added, in order.
    pub added: Vec<Candidate>,
    /// The fit.
    pub fit: RobustFit,
    /// Weighted sum of squares of the kept rows and penalty of the prior.
    pub misfit: f64,
    /// Price of terms and flags.
    pub price: f64,
    /// Weighted sum of squares of the kept rows over degrees of freedom.
    pub reduced: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

impl Node {
    /// What this explains beyond a node with fewer terms, less the price of the
    /// difference; structure that is left counts as noise.
    #[must_use]
    pub fn worth(&self, fewer: &Self) -> f64 {
        (fewer.misfit - self.misfit) / self.reduced.max(1.0) - (self.price - fewer.price)
    }

    /// The lower the better, for comparing explanations.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.misfit + self.price
    }

    /// Signs and sizes that the physics allows.
    #[must_use]
    pub fn plausible(&self) -> bool {
        self.fit.fit.state.terms.iter().all(plausible)
    }

    /// The additions of which a term has an impossible sign or size.
    pub(super) fn implausible(&self) -> Vec<Candidate> {
        let mut terms = self.fit.fit.state.terms.iter();
        let mut bad = |c: &&Candidate| {
            // Every term is taken, or the next addition would see this one's.
            c.terms.iter().filter_map(|_| terms.next()).filter(|t| !plausible(t)).count() > 0
        };
        self.added.iter().filter(|c| bad(c)).cloned().collect()
    }
}

/// A sign and size that the physics of its effect allows.
fn plausible(term: &ModelTerm) -> bool {
    let family = effects::family(term.effect_name());
    family.is_none_or(|family| family.plausible.contains(&term.coefficient()))
}

/// Whether the residuals are what the stated noise leaves: chi-square over
/// degrees of freedom within its scatter, with room for a sigma that is stated
/// to one digit; and not for the price of many flagged rows.
pub fn at_floor(node: &Node) -> bool {
    !crowded(node)
        && node.reduced
            < 1.0 + (POLICY.floor_deviations * (2.0 / node.freedom).sqrt()).max(POLICY.floor_share)
}

/// Whether more rows are flagged than can be gross errors.
#[must_use]
pub fn crowded(node: &Node) -> bool {
    let flagged = node.fit.outliers.len() as f64;
    let rows = flagged + node.fit.kept.len() as f64;
    flagged > (POLICY.crowd_share * rows).max(POLICY.crowd_rows)
}
