//! Lines of unknown order: those already in the model, sharpened, and the
//! strongest that a scan of what is left finds.

use rayon::prelude::*;
use truearm::effects::Effect;

use super::possible::{Numbers, Possible, variants};
use super::scan::Columns;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::policy::POLICY;
use crate::effects::Offer;
use crate::evidence::Aliases;
use crate::evidence::lines::{JointColumn, Line, Orders};
use crate::identify::State;

/// Lines within so many steps of one another may be one: at the ends of what the
/// joint covered their phases are less than a turn apart.
const ONE: f64 = 12.0;

/// Change of phase, rad, at the ends of what a joint covers that is none: a tenth of the line.
/// A line of the UR10's joint 5 moved on by half of this in every round, and the search with it.
const STILL: f64 = 0.1;

/// Steps of a golden section.
const SECTIONS: usize = 16;
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// A line that the model has: its joint, counted from 0, and order.
pub type Held = (usize, f64);

/// Lines that a fitted model has.
#[must_use]
pub fn of(added: &[Candidate]) -> Vec<Held> {
    added.iter().filter_map(line).collect()
}

fn line(candidate: &Candidate) -> Option<Held> {
    let term = candidate.terms.first()?;
    let is_line = candidate.name() == Effect::JointPeriodicError.name();
    is_line.then_some((term.joints().first()? - 1, term.order()?))
}

/// Whether members of a model are what it had, lines at orders that phases at the ends of what
/// their joint covers (least and most, rad) do not tell apart.
#[must_use]
pub fn are_still(members: &[Candidate], added: &[Candidate], covered: &[[f64; 2]]) -> bool {
    let near = |a: Held, b: Held| {
        let [least, most] = covered[a.0];
        a.0 == b.0 && (a.1 - b.1).abs() * (most - least) / 2.0 <= STILL
    };
    let one = |a: &Candidate, b: &Candidate| {
        a.terms == b.terms || line(a).zip(line(b)).is_some_and(|(a, b)| near(a, b))
    };
    // Both ways, or two that are near one stand for it and for what is gone.
    let within =
        |some: &[Candidate], all: &[Candidate]| some.iter().all(|a| all.iter().any(|b| one(a, b)));
    members.len() == added.len() && within(members, added) && within(added, members)
}

/// Lines as candidates: those held and, but of joints that are closed, those of a scan.
pub fn offered(
    state: &State,
    columns: &Columns,
    highest: f64,
    (held, closed): (&[Held], &[usize]),
    numbers: &mut Numbers,
) -> Vec<Possible> {
    let joints = columns.joints();
    let found = joints.par_iter().map(|joint| {
        let column = &columns.joint(*joint);
        let orders = Orders::of(&column.q, highest);
        let near = |a: f64, b: f64| (a - b).abs() < 2.0 * orders.step;
        let known: Vec<f64> = held.iter().filter(|h| h.0 == *joint).map(|h| h.1).collect();
        let mut lines = held_ones(state, column, (*joint, &known), orders.step);
        let aliases = Aliases::of(&column.q, *orders.range().end());
        if closed.contains(joint) {
            return (*joint, orders, aliases, lines);
        }
        for line in orders.lines(column, POLICY.lines_a_joint + known.len()) {
            let fresh = !known.iter().any(|k| near(*k, line.order));
            if fresh && lines.len() < POLICY.lines_a_joint + known.len() {
                lines.push((line, variants(&orders, &line)));
            }
        }
        (*joint, orders, aliases, lines)
    });
    let found: Vec<_> = found.collect();
    let mut out = Vec::new();
    for (joint, orders, aliases, lines) in found {
        let kept: Vec<f64> = lines.iter().map(|(line, _)| line.order).collect();
        for (part, (_, variants)) in lines.into_iter().enumerate() {
            // Orders that no data tell apart: one stands for all, with their prior.
            let alike = kept.iter().filter(|k| aliases.alike(kept[part], **k, orders.step)).count();
            for order in variants {
                let share = aliases.count(order, &orders.range()) as f64 / alike as f64;
                let offer = Offer::of_arm(Effect::JointPeriodicError, &[joint], &[order], 1);
                let candidate = Candidate::from(offer);
                let log_odds = orders.log_odds(joints.len(), order) + share.max(1.0).ln();
                out.push(numbers.line(candidate, part + 1, log_odds));
            }
        }
    }
    out
}

/// Lines that a joint of the model has, each with the orders that it may be of: its own, where it
/// is sharpest, alone or as one with those near it, and whole ones next to these.
fn held_ones(
    state: &State,
    column: &JointColumn,
    (joint, known): (usize, &[f64]),
    step: f64,
) -> Vec<(Line, Vec<f64>)> {
    let mut lines = Vec::new();
    for order in known {
        let own = Wave::of(state, joint, *order);
        let sharp = sharpened(column, *order, step, &[own]);
        let line = Line { order: sharp, strength: 0.0 };
        let mut variants = vec![*order, sharp];
        let close = known.iter().filter(|k| (**k - *order).abs() < ONE * step);
        let waves: Vec<Wave> = close.map(|k| Wave::of(state, joint, *k)).collect();
        if waves.len() > 1 {
            variants.push(sharpened(column, middle(&waves), step, &waves));
        }
        let whole = |n: &f64| (n.round() - n).abs() < step && n.round() > 0.0;
        let wholes: Vec<f64> = variants.iter().filter(|n| whole(n)).map(|n| n.round()).collect();
        variants.extend(wholes);
        variants.sort_by(f64::total_cmp);
        variants.dedup();
        lines.push((line, variants));
    }
    lines
}

/// A line in a state.
pub(super) struct Wave {
    order: f64,
    /// Coefficients of cosine and sine.
    size: [f64; 2],
}

impl Wave {
    fn of(state: &State, joint: usize, order: f64) -> Self {
        Self { order, size: size(state, joint, order) }
    }
}

/// Where several lines would be one, by their squares.
fn middle(waves: &[Wave]) -> f64 {
    let square = |wave: &Wave| wave.size.iter().map(|c| c * c).sum::<f64>();
    let all: f64 = waves.iter().map(square).sum();
    let sum: f64 = waves.iter().map(|wave| square(wave) * wave.order).sum();
    if all > 0.0 { sum / all } else { waves[0].order }
}

/// Coefficients of cosine and sine of a line in a state.
pub(super) fn size(state: &State, joint: usize, order: f64) -> [f64; 2] {
    let mut out = [0.0; 2];
    for term in &state.terms {
        if term.effect_name() == Effect::JointPeriodicError.name()
            && term.joints() == [joint + 1]
            && term.order() == Some(order)
            && let crate::model::ModelTerm::Arm(t) = term
        {
            out[usize::from(t.component != 0)] = t.coefficient;
        }
    }
    out
}

/// The order next to one at which a line explains most, with held ones added back.
pub(super) fn sharpened(column: &JointColumn, order: f64, step: f64, held: &[Wave]) -> f64 {
    let mut right = column.right.clone();
    for Wave { order, size: [cos, sin] } in held {
        for ((right, square), q) in right.iter_mut().zip(&column.square).zip(&column.q) {
            let (s, c) = (order * q).sin_cos();
            *right += square * (cos * c + sin * s);
        }
    }
    let at = |order: f64| column.strength(&right, order);
    let (mut low, mut high) = ((order - step).max(0.1), order + step);
    let within = |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let [mut a, mut b] = within(low, high);
    let [mut at_a, mut at_b] = [a, b].map(at);
    // Of the two inner points one is an inner point of the next section.
    for _ in 0..SECTIONS {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            [a, _] = within(low, high);
            at_a = at(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            [_, b] = within(low, high);
            at_b = at(b);
        }
    }
    // As a blob holds it.
    ((low + high) / 2.0 * 64.0).round() / 64.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(joint: usize, order: f64) -> Candidate {
        Offer::of_arm(Effect::JointPeriodicError, &[joint], &[order], 1).into()
    }

    #[test]
    fn lines_are_still_as_far_as_their_joint_tells() {
        let gap: Candidate = Offer::of_arm(Effect::Backlash, &[1], &[0.0], 1).into();
        let were = [gap.clone(), wave(0, 80.0), wave(1, 128.0)];
        let still =
            |now: &[Candidate], half: f64| are_still(now, &were, &[[1.0 - half, 1.0 + half]; 3]);
        // In any order, and by no more than a tenth of a radian at the ends.
        assert!(still(&[wave(1, 128.0), wave(0, 80.03), gap.clone()], 3.0));
        assert!(!still(&[wave(1, 128.0), wave(0, 80.05), gap.clone()], 3.0));
        assert!(still(&[wave(1, 128.0), wave(0, 80.05), gap.clone()], 0.5));
        // Not at another joint, and nothing that is more or less.
        assert!(!still(&[wave(1, 128.0), wave(2, 80.0), gap.clone()], 3.0));
        assert!(!still(&[wave(1, 128.0), wave(0, 80.0)], 3.0));
        // Two beside one are not it and another.
        assert!(!still(&[gap.clone(), wave(0, 80.0), wave(0, 80.01)], 3.0));
        let twice = [gap.clone(), wave(0, 80.0), wave(0, 80.01)];
        assert!(!are_still(&were, &twice, &[[-3.0, 3.0]; 3]));
        // What is no line is the same or another.
        let other: Candidate = Offer::of_arm(Effect::Backlash, &[1], &[0.01], 1).into();
        assert!(!still(&[other, wave(0, 80.0), wave(1, 128.0)], 3.0));
    }
}
