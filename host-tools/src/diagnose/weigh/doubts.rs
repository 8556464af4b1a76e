//! Why a probable effect is suspected and not named: what makes it probable is that
//! nothing else of the repertoire does the same, not that the data test it.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use truearm::effects::Effect;

use super::nameless::Nameless;
use super::weighed::{Doubt, Unnamed};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::moments::Moments;
use crate::diagnose::node::Node;
use crate::diagnose::question::Question;
use crate::identify::fit::folds;
use crate::model::ModelTerm;

/// Structure without a name is believed from here on, as in a verdict.
const BELIEVED: f64 = 0.5;
/// Angles of one level differ by less than this, rad...
const ONE_LEVEL: f64 = 0.01;
/// ...and a wave's phase there by less than this.
const ONE_PHASE: f64 = 0.3;
/// Of so many poses at most of its angles a joint stood at few of them.
const A_LEVEL: usize = 2;
/// Levels next to each other over more than this share of what the joint covered are no few.
const APART: f64 = 0.5;
/// Functions of a joint's angle that geometry and a gain have: a constant and a slope.
pub const OTHERS: usize = 2;

/// What speaks against an effect, replication apart.
#[must_use]
pub fn of(q: &Question, best: &Node, candidate: &Candidate, nameless: &[Unnamed]) -> Option<Doubt> {
    let (problem, rows) = (q.problem, &best.fit.kept);
    let [joint] = candidate.joints()[..] else { return None };
    let joint = joint - 1;
    let assumed = q.moments.is_some_and(Moments::are_assumed);
    let once = |term: &ModelTerm| term.order() == Some(1.0);
    let eccentric = candidate.name() == Effect::EncoderEccentricity.name();
    if assumed
        && eccentric
        && candidate.terms.iter().all(once)
        && problem.conditions.is_loaded(joint)
    {
        return Some(Doubt::Unweighed);
    }
    let by_load = |term: &ModelTerm| term.friction().is_some();
    let gap = candidate.name() == Effect::Backlash.name();
    let stiffening = Effect::JointStiffening.name();
    let stiffens = |c: &Candidate| c.name() == stiffening && c.joints() == candidate.joints();
    if gap && candidate.terms.iter().any(by_load) && best.added.iter().any(stiffens) {
        return Some(Doubt::Knee);
    }
    let lag = matches!(candidate.terms[..], [ModelTerm::Lag { .. }]);
    let of_a_move = [Effect::Backlash, Effect::JointGain].map(|effect| effect.name());
    if lag || of_a_move.contains(&candidate.name()) {
        let own = |u: &Unnamed| u.what == Nameless::Memory { joint } && u.probability >= BELIEVED;
        return nameless.iter().any(own).then_some(Doubt::Memory);
    }
    let highest = candidate.terms.iter().filter_map(|t| t.order()).fold(0.0, f64::max);
    let angles: Vec<f64> = rows.iter().map(|row| problem.data.rows[*row].q[joint]).collect();
    let few = levels(&angles, highest) <= candidate.terms.len() + OTHERS;
    (highest > 0.0 && few).then_some(Doubt::Levels)
}

/// How many angles a wave of this order can tell apart.
pub fn levels(angles: &[f64], order: f64) -> usize {
    level_of(angles, order).into_iter().max().map_or(0, |last| last + 1)
}

/// Angles within this are one level to a wave of this order, rad.
fn width(order: f64) -> f64 {
    ONE_LEVEL.min(ONE_PHASE / order.max(1.0))
}

/// Of each angle the number of its level, upwards: of those that a wave of this order can tell
/// apart.
pub fn level_of(angles: &[f64], order: f64) -> Vec<usize> {
    let mut upwards: Vec<usize> = (0..angles.len()).collect();
    upwards.sort_by(|a, b| angles[*a].total_cmp(&angles[*b]));
    let width = width(order);
    let mut out = vec![0; angles.len()];
    let (mut level, mut first) = (0, upwards.first().map_or(0.0, |k| angles[*k]));
    for k in upwards {
        if angles[k] - first > width {
            (level, first) = (level + 1, angles[k]);
        }
        out[k] = level;
    }
    out
}

/// Folds of the angles at which a joint stood, where those are few and apart: of every value
/// its fold; values with one of `poses` were read in the same. Where many poses were measured all
/// over a range every level has several, too; where each joint was swept alone, one has nearly all
/// and the others have one each: lines and gears of swept arms were lost.
pub fn folds_of_levels(
    q: &[f64],
    poses: &[usize],
    highest: f64,
    count: usize,
) -> Option<Vec<usize>> {
    let levels = level_of(q, highest);
    let most = levels.iter().max()? + 1;
    let [low, high] = [f64::min, f64::max].map(|of| q.iter().copied().reduce(of));
    let apart = most as f64 * width(highest) < APART * (high? - low?);
    // A pose that was read again is the same pose.
    let mut stood: Vec<(usize, usize)> =
        levels.iter().copied().zip(poses.iter().copied()).collect();
    stood.sort_unstable();
    stood.dedup();
    let often = stood.chunk_by(|a, b| a.0 == b.0).filter(|own| own.len() >= A_LEVEL).count();
    if !apart || 2 * often <= most || most < count {
        return None;
    }
    let mut fold: Vec<usize> = (0..most).map(|level| level % count).collect();
    fold.shuffle(&mut ChaCha8Rng::seed_from_u64(folds::SEED + 3));
    Some(levels.into_iter().map(|level| fold[level]).collect())
}

#[cfg(test)]
mod tests {
    use super::{folds_of_levels, level_of, levels};

    /// Eight angles, most in two poses or more, are few; in one pose each, or all over the
    /// range however many poses there are, they are not.
    #[test]
    fn few_angles_are_apart_and_stood_at_twice() {
        let grid = |count: u32, levels: u32| -> Vec<f64> {
            (0..count).map(|i| f64::from(i % levels) * 0.3).collect()
        };
        let folds_of = |q: &[f64]| {
            let poses: Vec<usize> = (0..q.len()).collect();
            folds_of_levels(q, &poses, 10.0, 5)
        };
        let folds = folds_of(&grid(16, 8)).unwrap();
        // One angle is in one fold, and every fold has one.
        assert!((0..8).all(|k| folds[k] == folds[k + 8]));
        assert!((0..5).all(|fold| folds.contains(&fold)));
        assert_eq!(folds_of(&grid(12, 8)), None);
        let twice: Vec<usize> = (0..16).map(|i| i % 8).collect();
        assert_eq!(folds_of_levels(&grid(16, 8), &twice, 10.0, 5), None, "read twice");
        // Thirty angles once each, and a hundred poses at home.
        let swept: Vec<f64> = grid(30, 30).into_iter().chain(vec![0.0; 100]).collect();
        assert_eq!(folds_of(&swept), None);
        assert_eq!(folds_of(&grid(16, 4)), None, "fewer angles than folds");
        let all: Vec<f64> = (0..20_000).map(|i| f64::from(i) * 3e-4).collect();
        assert_eq!(folds_of(&all), None);
        assert_eq!(folds_of(&[]), None);
    }

    #[test]
    fn angles_that_a_wave_cannot_tell_apart_are_one_level() {
        let grid: Vec<f64> =
            (0..60).map(|i| f64::from(i % 4) * 0.6 + f64::from(i) * 1e-4).collect();
        assert_eq!(levels(&grid, 1.0), 4);
        assert_eq!(levels(&grid, 4000.0), 60);
        assert_eq!(level_of(&[0.3, 0.1, 0.304, 0.2], 1.0), [2, 0, 2, 1]);
        // A joint that went everywhere has no levels.
        let all: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.011).collect();
        assert_eq!(levels(&all, 1.0), 100);
        assert_eq!(levels(&[], 1.0), 0);
    }
}
