//! What a reader of the model should know of how it came about.

use truearm::effects::MAX_TERMS;

use super::candidates;
use super::node::Node;
use crate::model::{Measurements, ModelTerm};

/// All of them.
pub fn all(data: &Measurements, best: &Node) -> impl Iterator<Item = String> {
    [too_many(best), repeated(data), guessed(data, best)].into_iter().flatten()
}

/// A remark where rows were written more than once.
fn repeated(data: &Measurements) -> Option<String> {
    let again = data.rows.len() - data.distinct().len();
    (again > 0).then(|| {
        format!("{}: {again} rows repeat others in every cell and count once", data.path.display())
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
