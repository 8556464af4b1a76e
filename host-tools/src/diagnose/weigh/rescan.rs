//! Lines whose order is found anew without a fold of the poses, and then does not predict
//! those: the strongest of thousands of orders, not the arm's.
//!
//! What one joint scatters looks like that: along its column more is left than the noise
//! scale says, and the best of all orders is believed. Coefficients alone refitted without
//! the fold, at the order that all rows chose, do not show it.

use rayon::prelude::*;

use super::lines::{self, Held, sharpened, size};
use super::scan;
use super::search_result::Searched;
use super::sheet::Weights;
use crate::diagnose::question::Question;
use crate::evidence::lines::{JointColumn, Orders};
use crate::observations::postures;

/// Lines of the model that do not predict poses held out of their scan.
#[must_use]
pub fn ghosts(q: &Question, found: &Searched) -> Vec<Held> {
    let held = lines::of(&found.best.added);
    if held.is_empty() {
        return held;
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
    let of_joint = |joint: &usize| {
        let column = columns.joint(*joint);
        let orders = held.iter().filter(|h| h.0 == *joint).map(|h| h.1);
        let waves = orders.map(|order| (order, wave(&column.q, order, size(state, *joint, order))));
        let mut waves: Vec<(f64, Vec<f64>)> = waves.collect();
        // The strongest first, as a scan finds them.
        let strength = |wave: &[f64]| -> f64 {
            wave.iter().zip(&column.square).map(|(w, square)| w * w * square).sum()
        };
        waves.sort_by(|a, b| strength(&b.1).total_cmp(&strength(&a.1)));
        let mut bare = column.clone();
        waves.iter().for_each(|(_, wave)| bare.move_by(wave, 1.0));
        let orders = Orders::of(&column.q, q.highest_order);
        let believed = believed(&bare, &orders, &folds, waves.len());
        waves.split_off(believed).into_iter().map(|(order, _)| (*joint, order)).collect::<Vec<_>>()
    };
    let joints = columns.joints().par_iter();
    let with_lines = joints.filter(|joint| held.iter().any(|h| h.0 == **joint));
    with_lines.flat_map_iter(of_joint).collect()
}

/// A line at every value of a joint.
fn wave(q: &[f64], order: f64, [cos, sin]: [f64; 2]) -> Vec<f64> {
    let at = |q: &f64| cos * (order * q).cos() + sin * (order * q).sin();
    q.iter().map(at).collect()
}

/// How many lines, found one after another without a fold, predict the squares of the folds
/// best; at most so many.
fn believed(column: &JointColumn, orders: &Orders, folds: &[usize], most: usize) -> usize {
    let count = folds.iter().max().map_or(0, |last| last + 1);
    let mut gains = vec![0.0; most + 1];
    for fold in 0..count {
        let (own, others): (Vec<usize>, Vec<usize>) =
            (0..folds.len()).partition(|i| folds[*i] == fold);
        let mut others = only(column, &others);
        let mut all = vec![0.0; column.q.len()];
        for gain in &mut gains[1..] {
            if let Some(line) = orders.lines(&others, 1).pop() {
                let order = sharpened(&others, line.order, orders.step, &[]);
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
            let found = believed(&column, &orders, &folds, 4);
            assert!((least..=most).contains(&found), "{found} lines of {line} rad");
        }
    }
}
