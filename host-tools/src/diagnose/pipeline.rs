//! From a registered arm to what the data hold beyond geometry.

use super::moments::Moments;
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

/// An answer, or the one with a hand where the masses stated of the wrist are refuted and
/// poses whose fold took no part in anything are missed by less then.
#[must_use]
pub fn with_hand(
    question: &Question,
    start: &State,
    answer: (Node, Weighed),
    progress: &dyn Fn(&'static str),
) -> (Node, Weighed) {
    let Some(moments) = answer.1.moments.as_ref().and_then(Moments::with_hand) else {
        return answer;
    };
    let mut question = Question { moments: Some(&moments), ..*question };
    // Where that does not converge the first answer stands.
    let Ok(other) = answered(&mut question, start, progress) else { return answer };
    // Of rows that both keep: whoever flags more has less to miss.
    let kept = &answer.1.best.fit.kept;
    let others = &other.1.best.fit.kept;
    let both: Vec<usize> =
        kept.iter().copied().filter(|row| others.binary_search(row).is_ok()).collect();
    match other.1.nested_rms_mm(&both).zip(answer.1.nested_rms_mm(&both)) {
        Some((with, without)) if with < without => other,
        _ => answer,
    }
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
