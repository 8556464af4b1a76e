//! Play of every joint, at every friction that sorts the rows another way.

use truearm::Approach;
use truearm::effects::Effect;

use super::{Data, Family, Offer};
use crate::identify::Conditions;
use crate::model::arm::RowInputs;

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
        // Half of what is believed is of a gap that gravity has no part in.
        let rubbing = levels.len() - 1;
        let tried = |level: f64| match (level > 0.0, rubbing) {
            (_, 0) => joints.len(),
            (false, _) => 2 * joints.len(),
            (true, _) => 2 * joints.len() * rubbing,
        };
        let ways = data.conditions.ways_of_sides(*j);
        let offer = |level: &f64| {
            let offer = Offer::of_arm(EFFECT, &[*j], &[*level], tried(*level));
            Offer { tried: ways * offer.tried, ..offer }
        };
        out.extend(levels.iter().map(offer));
    }
    Ok(out)
}

/// Friction torques at which gravity may take over the side of a gap, N m (N):
/// never, always, and levels between the torques of the rows that gravity and motion put on
/// different sides, each of which sorts the rows another way, in the middle of all that sort
/// them alike. A level next to the true one puts a row on the wrong side of the gap, so few
/// rows get every level.
fn frictions(conditions: &Conditions, joint: usize, most: usize) -> Vec<f64> {
    let torque = |row: &RowInputs| {
        let torque = *row.torque.get(joint)?;
        let pulled = if torque > 0.0 { Approach::Negative } else { Approach::Positive };
        (row.approach.get(joint) != Some(&pulled)).then_some(torque.abs())
    };
    let mut torques: Vec<f64> = conditions.rows.iter().filter_map(torque).collect();
    torques.sort_by(f64::total_cmp);
    let stride = torques.len().div_ceil(most).max(1);
    let always = torques.first().map(|least| least / 2.0);
    let between = torques.windows(2).step_by(stride).map(|pair| (pair[0] + pair[1]) / 2.0);
    let mut out = vec![0.0];
    for level in always.into_iter().chain(between) {
        // As a blob holds it.
        let step = EFFECT.order().step(level);
        let level = (level / step).round() * step;
        if out.last().is_some_and(|last| level > *last) {
            out.push(level);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn conditions(rows: &[(f64, Approach)]) -> Conditions {
        let row = |(torque, approach): &(f64, Approach)| RowInputs {
            torque: vec![*torque],
            approach: vec![*approach],
            ..RowInputs::default()
        };
        Conditions { rows: rows.iter().map(row).collect(), ..Conditions::default() }
    }

    /// Gravity and motion put a link on one side where it came to rest against gravity, at any
    /// friction: of levels that differ in such rows alone the middle is one level.
    #[test]
    fn levels_lie_in_the_middle_of_what_sorts_rows_alike() {
        use Approach::{Negative, Positive, Unknown};
        let told = [(8.0, Positive), (-16.0, Negative), (40.0, Unknown)];
        let untold = [(9.0, Negative), (-11.0, Positive), (39.0, Negative), (2.0, Negative)];
        let all = [&told[..], &untold[..]].concat();
        assert_eq!(frictions(&conditions(&all), 0, 128), [0.0, 4.0, 12.0, 28.0]);
        assert_eq!(frictions(&conditions(&untold), 0, 128), [0.0]);
        assert_eq!(frictions(&conditions(&[]), 0, 128), [0.0]);
        // A joint that nothing loads.
        assert_eq!(frictions(&conditions(&[(0.0, Positive), (0.0, Negative)]), 0, 128), [0.0]);
    }

    /// Of many rows some levels are tried, with the one at which gravity always decides.
    #[test]
    fn many_rows_have_no_more_levels_than_are_tried() {
        let rows: Vec<_> = (1..=1000).map(|k| (0.5 * f64::from(k), Approach::Positive)).collect();
        let levels = frictions(&conditions(&rows), 0, MOST_FRICTIONS);
        assert!(levels.len() <= MOST_FRICTIONS + 2, "{}", levels.len());
        assert!(levels[0] == 0.0 && levels[1] == 0.25, "{levels:?}");
        assert!(levels.is_sorted());
    }
}
