//! Play of every joint, at every friction that sorts the rows another way.

use truearm::effects::Effect;

use super::{Data, Family, Offer};
use crate::identify::Conditions;

const EFFECT: Effect = Effect::Backlash;

pub(super) const FAMILY: Family = Family {
    name: EFFECT.name(),
    offers,
    // A link lags behind its motor, it does not run ahead.
    plausible: -1e-5..2e-2,
    several: false,
};

/// Friction levels tried for a joint.
const MOST_FRICTIONS: usize = 128;
/// And where sides of approach are guessed from the order of the rows.
const FEW_FRICTIONS: usize = 8;

fn offers(data: &Data) -> Result<Vec<Offer>, &'static str> {
    if !data.conditions.direction {
        return Err("columns dir1..");
    }
    let joints = data.joints(EFFECT);
    let most = if data.conditions.direction_from_order { FEW_FRICTIONS } else { MOST_FRICTIONS };
    let mut out = Vec::new();
    for j in &joints {
        let levels = frictions(data.conditions, *j, most);
        let tried = joints.len() * levels.len();
        out.extend(levels.iter().map(|level| Offer::of_arm(EFFECT, &[*j], &[*level], tried)));
    }
    Ok(out)
}

/// Friction torques at which gravity may take over the side of a gap, N m (N):
/// never, and levels between the torques of the rows, each of which sorts the
/// rows another way. A level next to the true one puts a row on the wrong side
/// of the gap, so few rows get every level.
fn frictions(conditions: &Conditions, joint: usize, most: usize) -> Vec<f64> {
    let mut torques: Vec<f64> =
        conditions.rows.iter().filter_map(|r| r.torque.get(joint)).map(|t| t.abs()).collect();
    torques.sort_by(f64::total_cmp);
    let stride = torques.len().div_ceil(most).max(1);
    let mut out = vec![0.0];
    for pair in torques.windows(2).step_by(stride) {
        // A blob holds it in 1/64 N m.
        let level = ((pair[0] + pair[1]) / 2.0 * 64.0).round() / 64.0;
        if out.last().is_some_and(|last| level > *last) {
            out.push(level);
        }
    }
    out
}
