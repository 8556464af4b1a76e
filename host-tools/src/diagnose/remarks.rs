//! What a reader of the model should know of how it came about.

use truearm::effects::{Effect, MAX_TERMS};

use super::candidates;
use super::node::Node;
use crate::model::{Measurements, ModelTerm};

/// All of them.
pub fn all(data: &Measurements, best: &Node) -> impl Iterator<Item = String> {
    [too_many(best), guessed(data, best), loads(data, best)].into_iter().flatten()
}

/// A remark where springs give way against the torques of the file.
fn loads(data: &Measurements, best: &Node) -> Option<String> {
    let spring =
        |t: &ModelTerm| matches!(t, ModelTerm::Arm(t) if t.effect == Effect::JointCompliance);
    let mut springs = best.fit.fit.state.terms.iter().filter(|t| spring(t));
    springs.any(|t| t.coefficient() < 0.0).then(|| {
        format!(
            "{}: springs of negative coefficients: its torques are those that load the joints, not \
             those that the joints hold",
            data.path.display()
        )
    })
}

/// A remark where sides of approach that no column says are in the model.
fn guessed(data: &Measurements, best: &Node) -> Option<String> {
    let depends = |term: &ModelTerm| match term {
        ModelTerm::Arm(term) => term.effect.needs_approach(),
        ModelTerm::Lag { .. } => true,
        ModelTerm::Drift { .. } | ModelTerm::Remount { .. } => false,
    };
    let any = best.fit.fit.state.terms.iter().any(depends);
    (data.directions_from_order && any).then(|| {
        format!(
            "{}: no columns dir1..: the sides from which joints came to rest are taken from the \
             order of the rows",
            data.path.display()
        )
    })
}

/// A remark where a controller has no room for the model.
fn too_many(best: &Node) -> Option<String> {
    let terms = candidates::arm_terms(&best.added);
    (terms > MAX_TERMS).then(|| {
        format!(
            "{terms} terms of the arm where a controller takes {MAX_TERMS}: --most-terms \
             {MAX_TERMS} gives the best model that can be packed"
        )
    })
}
