//! Choosing lambda: L-curve corner, then the paper's two steps (decades, then
//! ten steps inside the best decade), judged on held-out poses. The paper
//! judges on the training residual, whose minimum is always lambda = 0.

use serde::Serialize;

use super::folds::Fold;
use super::problem::Problem;
use super::unknowns::State;
use crate::tikhonov::{Factorised, Triangle};

/// How lambda is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LambdaRule {
    /// 1: the maximum a posteriori estimate of the prior scaling.
    #[default]
    MaximumAPosteriori,
    /// The corner of the L-curve.
    LCurve,
    /// The corner, refined in two steps on held-out poses.
    TwoStep,
    /// Given by the user.
    Fixed(f64),
}

impl LambdaRule {
    /// As in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::MaximumAPosteriori => "maximum-a-posteriori",
            Self::LCurve => "l-curve",
            Self::TwoStep => "two-step",
            Self::Fixed(_) => "fixed",
        }
    }
}

/// What every rule says of one linearised problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LambdaChoice {
    /// Corner of the L-curve; none if it has none.
    pub l_curve: Option<f64>,
    /// After the two steps.
    pub two_step: f64,
    /// Every lambda tried with its held-out RMS error in mm, ascending.
    pub tried: Vec<(f64, f64)>,
}

/// Applies the rules at a state: one factorisation for the curve, and one for
/// each fold that serves every lambda tried.
#[must_use]
pub fn choose(problem: &Problem, state: &State, rows: &[usize], folds: &[Fold]) -> LambdaChoice {
    let at = problem.linearise(state);
    let free = problem.unknowns.free();
    // The triangle of all folds but one is joined from the folds' own.
    let parts: Vec<Triangle> = folds.iter().map(|f| at.triangle(&f.held_out, None)).collect();
    let whole = Factorised::new(&Triangle::join(parts.iter()), free);
    let without: Vec<Factorised> = (0..folds.len())
        .map(|k| {
            let others = parts.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, p)| p);
            Factorised::new(&Triangle::join(others), free)
        })
        .collect();
    let equations: Vec<_> = rows.iter().map(|r| (*r, at.equations(*r))).collect();
    let held_out = |lambda: f64| {
        let mut sum = 0.0;
        for (fold, factorised) in folds.iter().zip(&without) {
            let x = factorised.solve(lambda);
            for row in &fold.held_out {
                if let Ok(i) = equations.binary_search_by_key(row, |(r, _)| *r) {
                    let e = &equations[i].1;
                    // Back from weighted equations to metres.
                    let scale = problem.metres(*row);
                    sum += ((e.rhs - &e.block * &x) * scale).norm_squared();
                }
            }
        }
        (sum / rows.len() as f64).sqrt() * 1e3
    };
    let l_curve = whole.corner();
    let largest = whole.singular_values().iter().copied().fold(0.0, f64::max).powi(2);
    let start = l_curve.unwrap_or(1e-6 * largest);
    let mut tried: Vec<(f64, f64)> = Vec::new();
    let mut best = |lambdas: &mut dyn Iterator<Item = f64>| {
        for lambda in lambdas {
            tried.push((lambda, held_out(lambda)));
        }
        let least = tried.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
        // Where the error is flat, more regularisation is safer.
        let flat = tried.iter().filter(|t| t.1 <= least * 1.0001).map(|t| t.0);
        flat.fold(0.0, f64::max)
    };
    let decade = best(&mut (-9..=4).map(|k| start * 10_f64.powi(k)));
    let two_step =
        best(&mut (-5..=5).filter(|k| *k != 0).map(|k| decade * 10_f64.powf(f64::from(k) / 10.0)));
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    LambdaChoice { l_curve, two_step, tried }
}

impl LambdaChoice {
    /// The lambda of a rule; the two-step one where the curve has no corner.
    #[must_use]
    pub fn by(&self, rule: LambdaRule) -> f64 {
        match rule {
            LambdaRule::MaximumAPosteriori => 1.0,
            LambdaRule::LCurve => self.l_curve.unwrap_or(self.two_step),
            LambdaRule::TwoStep => self.two_step,
            LambdaRule::Fixed(lambda) => lambda,
        }
    }
}
