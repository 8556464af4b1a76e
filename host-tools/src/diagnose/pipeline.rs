//! From a registered arm to what the data hold beyond geometry.

use super::node::{self, Node};
use super::policy::POLICY;
use super::question::Question;
use super::weigh::{Weighed, weigh};
use crate::error::Result;
use crate::identify::certainty::scale;
use crate::identify::{Problem, State};

/// Geometry alone, at a lambda that it bears out, and what is weighed beyond it.
///
/// # Errors
/// When a fit does not converge.
pub fn answered(
    question: &mut Question,
    start: &State,
    progress: &dyn Fn(&'static str),
) -> Result<(Node, Weighed)> {
    progress("geometry");
    question.flags.lambda = 1.0;
    let first = node::geometry(question, start)?;
    question.flags.lambda = believable_lambda(question.problem, &first);
    let root = node::geometry(question, &first.fit.fit.state)?;
    progress("weighing effects");
    let weighed = weigh(question, &root, &|| progress("weighing effects"))?;
    Ok((root, weighed))
}

/// The tolerances of the prior are a guess; corrections that are larger all
/// over say that the arm was made to wider ones (one step towards the maximum of
/// the marginal likelihood).
fn believable_lambda(problem: &Problem, node: &Node) -> f64 {
    // Where nothing but the tolerances holds the scale they keep their weight.
    if scale::is_open(problem, &node.fit.fit.state) {
        return 1.0;
    }
    let norm = problem.corrections(&node.fit.fit.state).norm_squared();
    let count = 5.0 * problem.nominal.len() as f64;
    (count / norm.max(1e-9)).clamp(POLICY.least_lambda, 1.0)
}
