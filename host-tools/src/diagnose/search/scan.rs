//! Periodic errors of unknown order: every order up to the highest is tested
//! at every joint.

use nalgebra::DMatrix;
use truearm::effects::Effect;

use super::score::{JointColumns, Score};
use crate::diagnose::candidates::{Candidate, periodic};
use crate::diagnose::policy::POLICY;

/// Orders tested in one matrix product.
const BATCH: usize = 64;
/// A blob holds orders in this fraction of a cycle.
const GRID: f64 = 64.0;

/// The best orders of a joint as candidates, priced for all that were tried.
#[must_use]
pub fn scan(
    columns: &JointColumns,
    joint: usize,
    joints: usize,
    highest: f64,
) -> Vec<(Candidate, Score)> {
    let step = columns.step();
    let count = ((highest - POLICY.lowest_order) / step).max(1.0) as usize;
    let order = |k: usize| POLICY.lowest_order + step * k as f64;
    let mut scores = Vec::with_capacity(count);
    for first in (0..count).step_by(BATCH) {
        scores.extend(statistics(columns, order(first), BATCH.min(count - first)));
    }
    let at = |i: usize| scores.get(i).copied().unwrap_or(0.0);
    let peak = |k: &usize| at(*k) >= at(k + 1) && (*k == 0 || at(*k) >= at(k - 1));
    let mut peaks: Vec<usize> = (0..count).filter(peak).collect();
    peaks.sort_by(|a, b| scores[*b].total_cmp(&scores[*a]));
    let candidate = |k: usize| {
        let found = sharpened(columns, order(k));
        let best = statistics(columns, found, 1)[0];
        // A whole number, if the data do not object.
        let whole = found.round().max(1.0);
        let at_whole = statistics(columns, whole, 1)[0];
        let (order, statistic) =
            if at_whole > best - POLICY.whole_order { (whole, at_whole) } else { (found, best) };
        let terms = periodic(Effect::JointPeriodicError, joint, &[order]);
        let tried = (count * joints) as f64;
        (Candidate { terms, tried }, Score { statistic, freedom: 2 })
    };
    peaks.into_iter().take(POLICY.peaks).map(candidate).collect()
}

impl JointColumns {
    /// Distance of tested orders, cycles a turn: small enough that from one to
    /// the next the phase slips by half a radian at either end of the joint's
    /// range.
    fn step(&self) -> f64 {
        let low = self.q.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.q.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (1.0 / (high - low).max(1e-3)).clamp(0.05, 0.5)
    }
}

/// Golden section around a peak, then onto the grid.
fn sharpened(columns: &JointColumns, order: f64) -> f64 {
    let step = columns.step();
    let (mut low, mut high) = ((order - step).max(0.1), order + step);
    for _ in 0..14 {
        let (a, b) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
        let at = |order| statistics(columns, order, 1)[0];
        if at(a) > at(b) { high = b } else { low = a }
    }
    ((low + high) / 2.0 * GRID).round() / GRID
}

/// Score statistics of cosine and sine of `count` orders from `first` on.
fn statistics(columns: &JointColumns, first: f64, count: usize) -> Vec<f64> {
    let (n, step) = (columns.q.len(), columns.step());
    let mut waves = DMatrix::zeros(n, 2 * count);
    for (i, q) in columns.q.iter().enumerate() {
        // From one order to the next by a rotation: no sine for each.
        let (mut sin, mut cos) = (q * first).sin_cos();
        let (step_sin, step_cos) = (q * step).sin_cos();
        for k in 0..count {
            waves[(i, 2 * k)] = cos;
            waves[(i, 2 * k + 1)] = sin;
            (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
        }
    }
    let projected = &columns.projected * &waves;
    let statistic = |k: usize| {
        let (mut cc, mut cs, mut ss, mut rc, mut rs) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for i in 0..n {
            let (cos, sin, square) = (waves[(i, 2 * k)], waves[(i, 2 * k + 1)], columns.square[i]);
            cc += cos * cos * square;
            cs += cos * sin * square;
            ss += sin * sin * square;
            rc += cos * columns.right[i];
            rs += sin * columns.right[i];
        }
        let (pc, ps) = (projected.column(2 * k), projected.column(2 * k + 1));
        let (full_c, full_s) = (cc, ss);
        cc -= pc.norm_squared();
        ss -= ps.norm_squared();
        cs -= pc.dot(&ps);
        // Hardly anything left that geometry cannot imitate: no test.
        let determinant = cc * ss - cs * cs;
        if cc < 1e-4 * full_c || ss < 1e-4 * full_s || determinant < 1e-6 * cc * ss {
            return 0.0;
        }
        (ss * rc * rc - 2.0 * cs * rc * rs + cc * rs * rs) / determinant
    };
    (0..count).map(statistic).collect()
}
