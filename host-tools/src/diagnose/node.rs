//! A fitted explanation.

use truearm::effects::Effect;

use super::bending::bends;
use super::candidates::Candidate;
use super::question::Question;
use crate::effects;
use crate::error::Result;
use crate::identify::fit::robust::{RobustFit, robust_fit, robust_fit_near};
use crate::identify::{Conditions, Problem, State};
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
    /// Weighted sum of squares of the kept rows over degrees of freedom.
    pub reduced: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

impl Node {
    /// The additions of which a term has an impossible sign or size.
    pub fn implausible(&self, conditions: &Conditions) -> Vec<Candidate> {
        let mut terms = self.fit.fit.state.terms.iter();
        let mut bad = |c: &&Candidate| {
            // Every term is taken, or the next addition would see this one's.
            let own = c.terms.iter().filter_map(|_| terms.next());
            own.filter(|t| !plausible(t, conditions)).count() > 0
        };
        self.added.iter().filter(|c| bad(c)).cloned().collect()
    }
}

/// What noise may make of a spring that is none: so much against its largest load, rad.
const AGAINST: f64 = 1e-5;

/// No spring gives way by more beside its compliance, rad or m, at its largest torque.
const GIVES: f64 = 5e-3;

/// A spring above it, rad/Nm or m/N, is that of an arm so small that it gives way by less
/// than [`SOFT_GIVES`], rad or m, at its largest load: 0.03 rad/Nm and 0.1 N m in the wrist
/// of an arm that reaches 0.3 m.
const SOFT: f64 = 1e-2;
const SOFT_GIVES: f64 = 2e-2;

/// A sign and size that the physics of its effect allows, where torques may count
/// either way one of both signs.
fn plausible(term: &ModelTerm, conditions: &Conditions) -> bool {
    let Some(family) = effects::family(term.effect_name()) else { return true };
    let mut range = family.plausible.clone();
    let loaded = matches!(term, ModelTerm::Arm(own) if own.needs_load());
    if let (ModelTerm::Arm(own), true) = (term, bends(term.effect_name())) {
        range.start -= AGAINST / conditions.largest_load(own);
    }
    if let ModelTerm::Arm(own) = term {
        let size = term.coefficient().abs();
        let gives = match own.effect {
            Effect::JointStiffening => GIVES,
            _ if bends(term.effect_name()) && size > SOFT => SOFT_GIVES,
            _ => f64::INFINITY,
        };
        if size * conditions.largest_load(own) > gives {
            return false;
        }
    }
    let either = conditions.torques_of_either_sign && loaded;
    range.contains(&term.coefficient()) || either && range.contains(&-term.coefficient())
}

/// Fits geometry alone, from a registered arm.
///
/// # Errors
/// When the fit does not converge.
pub fn geometry(q: &Question, start: &State) -> Result<Node> {
    let fit = robust_fit(q.problem, q.rows, start, q.flags)?;
    Ok(node(q, Vec::new(), q.problem, fit))
}

/// Fits an explanation from a state that has some of its terms.
///
/// # Errors
/// When the fit does not converge.
pub fn fitted(q: &Question, added: Vec<Candidate>, near: &State) -> Result<Node> {
    let terms: Vec<ModelTerm> = added.iter().flat_map(|c| c.terms.iter().cloned()).collect();
    let problem = q.problem.with_terms(terms.len());
    let mut start = State { terms, ..near.clone() };
    for term in &mut start.terms {
        if let Some(old) = near.terms.iter().find(|old| old.at_zero() == term.at_zero()) {
            *term = old.clone();
        }
    }
    let fit = robust_fit_near(&problem, q.rows, &start, q.flags)?;
    Ok(node(q, added, &problem, fit))
}

fn node(q: &Question, added: Vec<Candidate>, problem: &Problem, fit: RobustFit) -> Node {
    let at = problem.linearise(&fit.fit.state);
    let square: f64 = fit.kept.iter().map(|r| at.scaled_residual(*r).norm_squared()).sum();
    let prior = q.flags.lambda * problem.corrections(&fit.fit.state).norm_squared();
    let unknowns = problem.unknowns.list().len() as f64;
    let freedom = (problem.equations(&fit.kept) as f64 - unknowns).max(1.0);
    Node { added, misfit: square + prior, reduced: square / freedom, freedom, fit }
}

#[cfg(test)]
mod tests {
    use truearm::effects::Term;

    use super::*;
    use crate::model::arm::RowInputs;

    /// What may be a spring depends on what it gives way by, above what large arms have.
    #[test]
    fn soft_springs_are_those_of_small_arms() {
        let spring = |effect, coefficient| {
            ModelTerm::Arm(Term {
                effect,
                joint: 0,
                source: 0,
                component: 0,
                order: 0.0,
                coefficient,
            })
        };
        let at = |torque: f64| {
            let row = RowInputs { torque: vec![torque], ..RowInputs::default() };
            Conditions { rows: vec![row], ..Conditions::default() }
        };
        let may = |size, torque| plausible(&spring(Effect::JointCompliance, size), &at(torque));
        assert!(may(0.03, 0.1) && may(0.03, 0.66) && !may(0.03, 0.67) && !may(0.03, -0.67));
        assert!(may(0.0999, 0.2) && !may(0.1001, 0.1));
        // As it always was.
        assert!(may(0.0099, 50.0) && !may(-0.0099, 0.1));
    }
}
