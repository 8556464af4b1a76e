//! What readings of one pose may differ by, and how much each counts.

use crate::identify::Problem;
use crate::model::ModelTerm;
use crate::observations::by_pose;

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
    for readings in by_pose(&problem.data.rows, rows) {
        let own = 1.0 / (1.0 - common + readings.len() as f64 * common);
        readings.iter().for_each(|k| out[*k] = own);
    }
    out
}
