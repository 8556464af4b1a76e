//! Rows that are readings of one target in one pose from one station.

use crate::identify::Problem;
use crate::model::ModelTerm;
use crate::observations::Reading;

/// Places of rows that are readings of one pose, a list each.
#[must_use]
pub fn by_pose(problem: &Problem, rows: &[usize]) -> Vec<Vec<usize>> {
    let key = |k: usize| Reading::of(&problem.data.rows, rows[k]);
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by_cached_key(|k| (key(*k), *k));
    order.chunk_by(|a, b| key(*a) == key(*b)).map(<[usize]>::to_vec).collect()
}

/// Whether a term may differ between readings of a pose; of variants of an effect, which
/// differ alike, the plainest.
#[must_use]
pub fn differs(term: &ModelTerm) -> bool {
    match term {
        ModelTerm::Arm(term) => {
            let effect = term.effect;
            let state = effect.needs_approach() || effect.needs_warmth() || term.needs_torque();
            state && term.order == 0.0
        }
        ModelTerm::Drift { course, .. } => course.settling.is_none(),
        ModelTerm::Lag { .. } | ModelTerm::Remount { .. } => true,
    }
}

/// How much each of these rows counts as one of its own: of r readings of a pose that have a
/// share h of their variance in common, `1' V^-1` is 1 / (1 - h + r h) of each.
#[must_use]
pub fn counted(problem: &Problem, rows: &[usize], common: f64) -> Vec<f64> {
    let mut out = vec![1.0; rows.len()];
    for readings in by_pose(problem, rows) {
        let own = 1.0 / (1.0 - common + readings.len() as f64 * common);
        readings.iter().for_each(|k| out[*k] = own);
    }
    out
}
