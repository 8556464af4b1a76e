//! All that is weighed in a round at a model.

use super::lines::{self, Held};
use super::nameless::Nameless;
use super::possible::{Numbers, Possible, revolute};
use super::sheet::Weights;
use super::{lags, late, scan, screen, settling, slips};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::Node;
use crate::diagnose::policy::POLICY;
use crate::diagnose::question::Question;

/// Candidates of known form, lines near those that the model had, and what stands in for a
/// refused one.
pub fn offered(
    q: &Question,
    node: &Node,
    weights: &Weights,
    noise: (f64, f64),
    (held, closed, refused): (&[Held], &[usize], &[Candidate]),
) -> Vec<Possible> {
    let (state, rows) = (&node.fit.fit.state, &node.fit.kept);
    let mut numbers = Numbers::default();
    let mut out: Vec<Possible> =
        q.offered.iter().map(|candidate| numbers.offered(candidate.clone())).collect();
    out.extend(settling::near(&node.added, q.offered).map(|c| numbers.offered(c)));
    let late = late::near(q, node, weights, noise.1);
    out.extend(late.into_iter().map(|c| numbers.offered(c)));
    out.extend(lags::offered(q.problem, refused, &mut numbers));
    let columns = scan::columns(q.problem, state, rows, weights, noise, &scan::cell(q.problem));
    out.extend(lines::offered(state, &columns, q.highest_order, (held, closed), &mut numbers));
    out.extend(slips::offered(q.problem, rows, &columns, &mut numbers));
    out.extend(screen::offered(q.problem, rows, &columns, &mut numbers));
    let joints = revolute(q.problem);
    for (nameless, tried) in Nameless::all(q.problem, &joints, POLICY.wobbles) {
        out.push(numbers.nameless(nameless, tried));
    }
    out.retain(|p| !p.is(refused) && !lags::is_refused(p, refused));
    out
}
