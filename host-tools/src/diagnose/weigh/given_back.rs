//! Rows that were flagged as gross errors and are none: where joints have play, those that
//! one of them came to from the other side.
//!
//! A joint that comes from one side nearly always puts a few rows off by its whole gap.
//! Geometry fits the many and flags the few, and of what is flagged no evidence is left.

use truearm::effects::Effect;

use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::identify::fit::robust::Flags;
use crate::model::ModelTerm;

/// Fewer flagged rows are looked at one by one.
const FEWEST: usize = 3;

/// Geometry fitted beside the gaps of all joints, if that gives at least half of the flagged
/// rows back at no more noise than geometry alone leaves of the others: what a slip spread
/// over all rows would flag none as well.
pub fn given_back(q: &Question, root: &Node) -> Option<Node> {
    let flagged = root.fit.outliers.len();
    let plain = |c: &&Candidate| {
        let gap = |t: &ModelTerm| matches!(t, ModelTerm::Arm(t) if t.effect == Effect::Backlash && t.order == 0.0);
        c.terms.iter().all(gap)
    };
    let gaps: Vec<Candidate> = q.offered.iter().filter(plain).cloned().collect();
    if flagged < FEWEST || gaps.is_empty() {
        return None;
    }
    let none_flagged = Flags { gross: f64::INFINITY, ..q.flags };
    // What is metres off fits nothing: it stays flagged.
    let unflagged = Question { flags: none_flagged, ..*q };
    let all = fitted(&unflagged, gaps.clone(), &root.fit.fit.state).ok()?;
    let node = fitted(q, gaps, &all.fit.fit.state).ok()?;
    let noise = root.reduced.max(f64::MIN_POSITIVE);
    let cost =
        |node: &Node| node.misfit / noise + q.flags.gross.powi(2) * node.fit.outliers.len() as f64;
    let better = 2 * node.fit.outliers.len() <= flagged && cost(&node) < cost(root);
    better.then_some(node)
}
