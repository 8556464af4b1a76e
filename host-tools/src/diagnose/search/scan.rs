//! Periodic errors of unknown order: every order up to the highest is tested
//! at every joint, the best ones then on a fine grid. Rows pass in groups;
//! what is held is as long as the list of orders, not as the data.

use nalgebra::DMatrix;
use rayon::prelude::*;
use truearm::effects::Effect;

use super::score::{JointRows, Score, Scorer};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::policy::POLICY;
use crate::effects::Offer;

const EFFECT: Effect = Effect::JointPeriodicError;
/// Orders tested in one matrix product.
const BATCH: usize = 64;
/// Rows that pass together.
const GROUP: usize = 512;
/// A blob holds orders in this fraction of a cycle.
const GRID: f64 = 64.0;

/// Evenly spaced orders.
#[derive(Debug, Clone, Copy)]
struct Orders {
    first: f64,
    step: f64,
    count: usize,
}

impl Orders {
    fn at(&self, k: usize) -> f64 {
        self.first + self.step * k as f64
    }
}

/// The best orders of every joint as candidates, priced for all that were tried.
#[must_use]
pub fn scan(scorer: &Scorer, highest: f64) -> Vec<(Candidate, Score)> {
    let joints = scorer.joints();
    let coarse: Vec<Orders> = (0..joints).map(|joint| coarse(scorer, joint, highest)).collect();
    let turning = coarse.iter().filter(|orders| orders.count > 0).count();
    let lists: Vec<Vec<Orders>> = coarse.iter().map(|orders| vec![*orders]).collect();
    let scores = statistics(scorer, &lists);
    let around = |(orders, scores): (&Orders, &Vec<Vec<f64>>)| {
        peaks(&scores[0]).into_iter().map(|k| fine(orders, k)).collect::<Vec<_>>()
    };
    let fine: Vec<Vec<Orders>> = coarse.iter().zip(&scores).map(around).collect();
    let scores = statistics(scorer, &fine);
    let mut out = Vec::new();
    for (joint, (lists, scores)) in fine.iter().zip(&scores).enumerate() {
        let tried = coarse[joint].count * turning;
        for (orders, scores) in lists.iter().zip(scores) {
            let (order, statistic) = sharpest(orders, scores, coarse[joint].step);
            let found = Offer::of_arm(EFFECT, &[joint], &[order], tried);
            out.push((found.into(), Score { statistic, freedom: 2 }));
        }
    }
    out
}

/// All orders of a joint: so close that from one to the next the phase slips by
/// half a radian at either end of the joint's range. None of a joint that slides.
fn coarse(scorer: &Scorer, joint: usize, highest: f64) -> Orders {
    let [low, high] = scorer.range(joint);
    let step = (1.0 / (high - low).max(1e-3)).clamp(0.05, 0.5);
    let first = POLICY.lowest_order;
    let count = ((highest - first) / step).max(1.0) as usize;
    Orders { first, step, count: if EFFECT.suits(scorer.kind(joint)) { count } else { 0 } }
}

/// Places of the highest peaks.
fn peaks(scores: &[f64]) -> Vec<usize> {
    let at = |i: usize| scores.get(i).copied().unwrap_or(0.0);
    let peak = |k: &usize| at(*k) >= at(k + 1) && (*k == 0 || at(*k) >= at(k - 1));
    let mut peaks: Vec<usize> = (0..scores.len()).filter(peak).collect();
    peaks.sort_by(|a, b| scores[*b].total_cmp(&scores[*a]));
    peaks.truncate(POLICY.peaks);
    peaks
}

/// The blob's orders to the next coarse one on either side, and as far beyond
/// as the nearest whole number may lie.
fn fine(coarse: &Orders, peak: usize) -> Orders {
    let reach = coarse.step + 0.5;
    let first = ((coarse.at(peak) - reach).max(0.1) * GRID).ceil() / GRID;
    let last = coarse.at(peak) + reach;
    Orders { first, step: 1.0 / GRID, count: ((last - first) * GRID) as usize + 1 }
}

/// The best order within a coarse step of the middle, or a whole number next to
/// it, if the data do not object; and its statistic.
fn sharpest(orders: &Orders, scores: &[f64], step: f64) -> (f64, f64) {
    let middle = orders.at(orders.count - 1) - step - 0.5;
    let within = |k: &usize| (orders.at(*k) - middle).abs() <= step + 1.0 / GRID;
    let best = (0..orders.count).filter(within).max_by(|a, b| scores[*a].total_cmp(&scores[*b]));
    let best = best.unwrap_or(0);
    let whole = orders.at(best).round().max(1.0);
    let place = ((whole - orders.first) * GRID).round();
    match scores.get(place as usize) {
        Some(at_whole) if place >= 0.0 && *at_whole > scores[best] - POLICY.whole_order => {
            (whole, *at_whole)
        }
        _ => (orders.at(best), scores[best]),
    }
}

/// Sums over rows for the cosine and sine of each of some orders.
struct Waves {
    orders: Vec<Orders>,
    /// Products with the fitted columns, two columns an order.
    products: DMatrix<f64>,
    /// cos cos, cos sin, sin sin, cos r, sin r.
    sums: Vec<[f64; 5]>,
}

/// Score statistics of cosine and sine of every order of every joint's lists.
fn statistics(scorer: &Scorer, lists: &[Vec<Orders>]) -> Vec<Vec<Vec<f64>>> {
    let mut waves: Vec<Option<Waves>> = lists.iter().map(|_| None).collect();
    for group in scorer.rows().chunks(GROUP) {
        let rows = scorer.joint_rows(group);
        waves.par_iter_mut().zip(&rows).zip(lists).for_each(|((waves, rows), orders)| {
            let unknowns = rows.products.nrows();
            waves.get_or_insert_with(|| Waves::new(unknowns, orders)).add(rows);
        });
    }
    let scored = waves.into_par_iter().map(|w| w.map_or(Vec::new(), |w| w.statistics(scorer)));
    scored.collect()
}

impl Waves {
    fn new(unknowns: usize, orders: &[Orders]) -> Self {
        let count: usize = orders.iter().map(|o| o.count).sum();
        Self {
            orders: orders.to_vec(),
            products: DMatrix::zeros(unknowns, 2 * count),
            sums: vec![[0.0; 5]; count],
        }
    }

    fn add(&mut self, rows: &JointRows) {
        let mut place = 0;
        for orders in self.orders.clone() {
            for first in (0..orders.count).step_by(BATCH) {
                let count = BATCH.min(orders.count - first);
                self.add_batch(rows, place + first, orders.at(first), orders.step, count);
            }
            place += orders.count;
        }
    }

    /// `count` orders from `first` on.
    fn add_batch(&mut self, rows: &JointRows, place: usize, first: f64, step: f64, count: usize) {
        let mut waves = DMatrix::zeros(rows.q.len(), 2 * count);
        for (i, q) in rows.q.iter().enumerate() {
            // From one order to the next by a rotation: no sine for each.
            let (mut sin, mut cos) = (q * first).sin_cos();
            let (step_sin, step_cos) = (q * step).sin_cos();
            for k in 0..count {
                waves[(i, 2 * k)] = cos;
                waves[(i, 2 * k + 1)] = sin;
                (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
            }
        }
        let mut target = self.products.columns_mut(2 * place, 2 * count);
        target.gemm(1.0, &rows.products, &waves, 1.0);
        for (k, [cc, cs, ss, rc, rs]) in self.sums[place..place + count].iter_mut().enumerate() {
            let (cosine, sine) = (waves.column(2 * k), waves.column(2 * k + 1));
            for (i, (cos, sin)) in cosine.iter().zip(sine.iter()).enumerate() {
                let (square, right) = (rows.square[i], rows.right[i]);
                *cc += cos * cos * square;
                *cs += cos * sin * square;
                *ss += sin * sin * square;
                *rc += cos * right;
                *rs += sin * right;
            }
        }
    }

    fn statistics(mut self, scorer: &Scorer) -> Vec<Vec<f64>> {
        scorer.project(&mut self.products);
        let statistic = |(k, sums): (usize, &[f64; 5])| {
            let [full_c, cs, full_s, rc, rs] = *sums;
            let (pc, ps) = (self.products.column(2 * k), self.products.column(2 * k + 1));
            let (cc, ss) = (full_c - pc.norm_squared(), full_s - ps.norm_squared());
            let cs = cs - pc.dot(&ps);
            // Hardly anything left that geometry cannot imitate: no test.
            let determinant = cc * ss - cs * cs;
            if cc < 1e-4 * full_c || ss < 1e-4 * full_s || determinant < 1e-6 * cc * ss {
                return 0.0;
            }
            (ss * rc * rc - 2.0 * cs * rc * rs + cc * rs * rs) / determinant
        };
        let mut all = self.sums.iter().enumerate().map(statistic);
        self.orders.iter().map(|o| all.by_ref().take(o.count).collect()).collect()
    }
}
