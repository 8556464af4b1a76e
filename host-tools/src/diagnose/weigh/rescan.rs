//! Lines whose order is found anew without a fold of the poses, and then does not predict
//! those: the strongest of thousands of orders, not the arm's.
//!
//! What one joint scatters looks like that: along its column more is left than the noise
//! scale says, and the best of all orders is believed. Coefficients alone refitted without
//! the fold, at the order that all rows chose, do not show it.

//! Where a joint stood at a few angles only, in cones of poses about some places, any of
//! thousands of orders fits whatever it did there, and poses at the same angles say so again:
//! there folds are of its angles, and lines of the gear are asked as well. Sessions of cones
//! over an arm with a smooth curve, or with a payload that nobody wrote down, got lines of P 1.00
//! that trebled the error between those angles.

use rayon::prelude::*;
use truearm::effects::Effect;

use super::between;
use super::doubts::folds_of_levels;
use super::lines::sharpened;
use super::scan;
use super::search_result::Searched;
use super::sheet::Weights;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::question::Question;
use crate::evidence::lines::{JointColumn, Orders};
use crate::identify::State;
use crate::model::ModelTerm;
use crate::observations::postures;

/// Lines of the model that do not predict poses held out of their scan, and what else goes with
/// the angle of a joint in waves and does not predict other angles, where those are few.
#[must_use]
pub fn ghosts(q: &Question, found: &Searched) -> Vec<Candidate> {
    let waves: Vec<&Candidate> =
        found.best.added.iter().filter(|c| orders_of(c).is_some()).collect();
    if waves.is_empty() {
        return Vec::new();
    }
    let problem = found.bent.problem(q.problem);
    let (state, rows) = (&found.best.fit.fit.state, &found.best.fit.kept);
    let noise = (q.flags.lambda, found.found.scale);
    // What rows count for was learned with the lines, from the poses held out as well.
    let scattering = found.weights.scattering.clone();
    let alike = Weights { scattering, ..Weights::alike(problem.data.rows.len()) };
    let columns = scan::columns(&problem, state, rows, &alike, noise, &[]);
    let mut fold_of = vec![0; problem.data.rows.len()];
    for (k, fold) in q.folds.iter().enumerate() {
        fold.held_out.iter().for_each(|row| fold_of[*row] = k);
    }
    let stood = postures(&problem.data.rows, rows);
    let folds: Vec<usize> = stood.iter().map(|row| fold_of[*row]).collect();
    let poses: Vec<usize> = stood.iter().map(|row| problem.data.rows[*row].pose).collect();
    let of_joint = |joint: &usize| {
        let column = columns.joint(*joint);
        let own = waves.iter().filter(|c| c.joints() == [joint + 1]);
        let highest = own.clone().filter_map(|c| orders_of(c)).flatten().fold(0.0, f64::max);
        let by_level = folds_of_levels(&column.q, &poses, highest, q.folds.len());
        // Poses at many angles tell what has an order that is known by themselves.
        let asked = own.filter(|c| by_level.is_some() || is_line(c));
        let folds = by_level.as_ref().unwrap_or(&folds);
        let mut asked: Vec<(&Candidate, Vec<f64>)> =
            asked.map(|c| (*c, drawn(&column.q, c, state))).collect();
        // The strongest first, as a scan finds them.
        let strength = |wave: &[f64]| -> f64 {
            wave.iter().zip(&column.square).map(|(w, square)| w * w * square).sum()
        };
        asked.sort_by(|a, b| strength(&b.1).total_cmp(&strength(&a.1)));
        let mut bare = column.clone();
        asked.iter().for_each(|(_, wave)| bare.move_by(wave, 1.0));
        let orders = Orders::of(&column.q, q.highest_order);
        let ways: Vec<Way> = asked.iter().map(|(c, _)| Way::of(c)).collect();
        let believed = believed(&bare, &orders, folds, &ways);
        asked.split_off(believed).into_iter().map(|(c, _)| c.clone()).collect::<Vec<_>>()
    };
    let joints = columns.joints().par_iter();
    let with_waves = joints.filter(|j| waves.iter().any(|c| c.joints() == [**j + 1]));
    with_waves.flat_map_iter(of_joint).collect()
}

fn is_line(candidate: &Candidate) -> bool {
    candidate.name() == Effect::JointPeriodicError.name()
}

/// Orders of a candidate that goes in waves with the angle of its joint; `None` of others.
fn orders_of(candidate: &Candidate) -> Option<Vec<f64>> {
    // An eccentricity is told apart from geometry by many angles together: left out, some of
    // them say nothing of it.
    let waves = [Effect::JointPeriodicError, Effect::GearTransmissionError];
    let is = waves.iter().any(|effect| effect.name() == candidate.name());
    let mut orders: Vec<f64> = candidate.terms.iter().filter_map(|term| term.order()).collect();
    orders.dedup();
    is.then_some(orders)
}

/// Its waves in a state, at every value of its joint.
fn drawn(q: &[f64], candidate: &Candidate, state: &State) -> Vec<f64> {
    let is_own = |term: &&ModelTerm| candidate.terms.contains(&term.at_zero());
    let own: Vec<&ModelTerm> = state.terms.iter().filter(is_own).collect();
    q.iter().map(|q| own.iter().map(|term| between::wave(term, *q)).sum()).collect()
}

/// A wave at every value of a joint.
fn wave(q: &[f64], order: f64, [cos, sin]: [f64; 2]) -> Vec<f64> {
    let at = |q: &f64| cos * (order * q).cos() + sin * (order * q).sin();
    q.iter().map(at).collect()
}

/// How orders are found without a fold.
enum Way {
    /// By a scan.
    Scan,
    /// They are known.
    Known(Vec<f64>),
}

impl Way {
    fn of(candidate: &Candidate) -> Self {
        match is_line(candidate) {
            true => Self::Scan,
            false => Self::Known(orders_of(candidate).unwrap_or_default()),
        }
    }

    fn orders(&self, others: &JointColumn, orders: &Orders) -> Vec<f64> {
        match self {
            Self::Known(known) => known.clone(),
            Self::Scan => {
                let line = orders.lines(others, 1).pop();
                line.map(|l| sharpened(others, l.order, orders.step, &[])).into_iter().collect()
            }
        }
    }
}

/// How many of these, found one after another without a fold, predict the squares of the folds
/// best.
fn believed(column: &JointColumn, orders: &Orders, folds: &[usize], ways: &[Way]) -> usize {
    let count = folds.iter().max().map_or(0, |last| last + 1);
    let mut gains = vec![0.0; ways.len() + 1];
    for fold in 0..count {
        let (own, others): (Vec<usize>, Vec<usize>) =
            (0..folds.len()).partition(|i| folds[*i] == fold);
        let mut others = only(column, &others);
        let mut all = vec![0.0; column.q.len()];
        for (gain, way) in gains[1..].iter_mut().zip(ways) {
            for order in way.orders(&others, orders) {
                let size = others.fitted(order);
                others.move_by(&wave(&others.q, order, size), -1.0);
                let line = wave(&column.q, order, size);
                all.iter_mut().zip(line).for_each(|(all, line)| *all += line);
            }
            let explained =
                |i: &usize| all[*i] * (2.0 * column.right[*i] - column.square[*i] * all[*i]);
            *gain += own.iter().map(explained).sum::<f64>();
        }
    }
    // The fewest of those that predict as well: a scan that found no line adds nothing.
    let better = |best: usize, n: usize| if gains[n] > gains[best] { n } else { best };
    (1..gains.len()).fold(0, better)
}

/// A column at some of its values.
fn only(column: &JointColumn, these: &[usize]) -> JointColumn {
    let some = |of: &[f64]| these.iter().map(|i| of[*i]).collect();
    JointColumn {
        q: some(&column.q),
        square: some(&column.square),
        right: some(&column.right),
        imitated: column.imitated.select_columns(these),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// What 150 poses of a joint leave: scatter of its zero far above the noise, and a line.
    fn column(line: f64, rng: &mut ChaCha8Rng) -> JointColumn {
        let q: Vec<f64> = (0..150).map(|_| rng.random_range(-2.5..2.5)).collect();
        let square: Vec<f64> = (0..150).map(|_| rng.random_range(50.0..150.0)).collect();
        let zero =
            |q: &f64| line * (37.3 * q).sin() + if rng.random_bool(0.5) { 0.3 } else { -0.3 };
        let zeros: Vec<f64> = q.iter().map(zero).collect();
        let right = square.iter().zip(zeros).map(|(square, zero)| square * zero).collect();
        JointColumn { q, square, right, imitated: DMatrix::zeros(1, 150) }
    }

    #[test]
    fn scatter_has_no_lines_and_a_line_has_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for (line, least, most) in [(0.0, 0, 0), (0.0, 0, 0), (0.0, 0, 0), (0.4, 1, 2), (0.4, 1, 2)]
        {
            let column = column(line, &mut rng);
            let folds: Vec<usize> = (0..150).map(|i| i % 5).collect();
            let orders = Orders::of(&column.q, 420.0);
            let found = believed(&column, &orders, &folds, &[const { Way::Scan }; 4]);
            assert!((least..=most).contains(&found), "{found} lines of {line} rad");
        }
    }
}
