//! Lines of unknown order: those already in the model, sharpened, and the
//! strongest that a scan of what is left finds.

use rayon::prelude::*;
use truearm::effects::Effect;

use super::possible::{Numbers, Possible, variants};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::policy::POLICY;
use crate::effects::Offer;
use crate::evidence::lines::{JointColumn, Line, Orders, strengths};
use crate::identify::State;

/// Steps of a golden section.
const SECTIONS: usize = 16;

/// A line that the model has: its joint, counted from 0, and order.
pub type Held = (usize, f64);

/// Lines as candidates.
pub fn offered(
    state: &State,
    columns: &[(usize, JointColumn)],
    highest: f64,
    held: &[Held],
    numbers: &mut Numbers,
) -> Vec<Possible> {
    let found = columns.par_iter().map(|(joint, column)| {
        let orders = Orders::of(&column.q, highest);
        let near = |a: f64, b: f64| (a - b).abs() < 2.0 * orders.step;
        let known: Vec<f64> = held.iter().filter(|h| h.0 == *joint).map(|h| h.1).collect();
        let mut lines: Vec<(Line, Vec<f64>)> = Vec::new();
        for order in &known {
            let coefficients = wave(state, *joint, *order);
            let sharp = sharpened(column, *order, orders.step, coefficients);
            let line = Line { order: sharp, strength: 0.0 };
            let mut variants = vec![*order, sharp];
            if (sharp.round() - sharp).abs() < orders.step && sharp.round() > 0.0 {
                variants.push(sharp.round());
            }
            variants.sort_by(f64::total_cmp);
            variants.dedup();
            lines.push((line, variants));
        }
        for line in orders.lines(column, POLICY.lines_a_joint + known.len()) {
            let fresh = !known.iter().any(|k| near(*k, line.order));
            if fresh && lines.len() < POLICY.lines_a_joint + known.len() {
                lines.push((line, variants(&orders, &line)));
            }
        }
        (*joint, orders, lines)
    });
    let found: Vec<_> = found.collect();
    let mut out = Vec::new();
    for (joint, orders, lines) in found {
        for (part, (_, variants)) in lines.into_iter().enumerate() {
            for order in variants {
                let offer = Offer::of_arm(Effect::JointPeriodicError, &[joint], &[order], 1);
                let candidate = Candidate::from(offer);
                out.push(numbers.line(candidate, part + 1, columns.len(), &orders, order));
            }
        }
    }
    out
}

/// Cosine and sine coefficients of a line in a state.
fn wave(state: &State, joint: usize, order: f64) -> [f64; 2] {
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

/// The order at which a held line explains most, with its own part added back.
fn sharpened(column: &JointColumn, order: f64, step: f64, [cos, sin]: [f64; 2]) -> f64 {
    let mut column = column.clone();
    for ((right, square), q) in column.right.iter_mut().zip(&column.square).zip(&column.q) {
        let (s, c) = (order * q).sin_cos();
        *right += square * (cos * c + sin * s);
    }
    let at = |order: f64| strengths(&column, order, step, 1)[0];
    let (mut low, mut high) = ((order - step).max(0.1), order + step);
    for _ in 0..SECTIONS {
        let (a, b) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
        if at(a) > at(b) { high = b } else { low = a }
    }
    // As a blob holds it.
    ((low + high) / 2.0 * 64.0).round() / 64.0
}
