//! Choosing lambda: six rules side by side, all from one factorisation. The
//! paper's is the L-curve corner, refined in two steps (decades, then ten steps
//! inside the best decade); these are judged on held-out poses. The paper judges
//! on the training residual, whose minimum is always lambda = 0.

use schemars::JsonSchema;
use serde::Serialize;

use super::Fit;
use super::folds::{self, Fold};
use crate::identify::problem::{Linearised, Problem, Scaling, State};
use crate::model::Values;
use crate::tikhonov::{Factorised, Normal, Triangle};

/// How lambda is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LambdaRule {
    /// 1: the maximum a posteriori estimate of the prior scaling.
    MaximumAPosteriori,
    /// The corner of the L-curve.
    LCurve,
    /// The corner, refined in two steps on held-out poses.
    TwoStep,
    /// Generalised cross-validation.
    Gcv,
    /// Morozov's discrepancy principle, from the stated sigma.
    Discrepancy,
    /// Least error of held-out poses.
    KFold,
    /// Maximum of the marginal likelihood: the least regret where neither the
    /// size of the errors nor the noise is known (docs/results.md).
    #[default]
    MaximumLikelihood,
    /// Given by the user.
    Fixed(f64),
}

impl LambdaRule {
    /// All that choose for themselves.
    pub const ALL: [Self; 7] = [
        Self::MaximumAPosteriori,
        Self::LCurve,
        Self::TwoStep,
        Self::Gcv,
        Self::Discrepancy,
        Self::KFold,
        Self::MaximumLikelihood,
    ];

    /// As in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::MaximumAPosteriori => "maximum-a-posteriori",
            Self::LCurve => "l-curve",
            Self::TwoStep => "two-step",
            Self::Gcv => "gcv",
            Self::Discrepancy => "discrepancy",
            Self::KFold => "k-fold",
            Self::MaximumLikelihood => "maximum-likelihood",
            Self::Fixed(_) => "fixed",
        }
    }
}

/// What every rule says of one linearised problem.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LambdaChoice {
    /// Corner of the L-curve; none if it has none.
    pub l_curve: Option<f64>,
    /// After the two steps.
    pub two_step: f64,
    /// Generalised cross-validation.
    pub gcv: Option<f64>,
    /// Discrepancy principle; none where the residual is above the stated noise
    /// whatever lambda is.
    pub discrepancy: Option<f64>,
    /// Least held-out error.
    pub k_fold: f64,
    /// Marginal likelihood.
    pub maximum_likelihood: Option<f64>,
    /// Every lambda tried with its held-out RMS error in mm, ascending.
    pub tried: Vec<(f64, f64)>,
}

/// Lambda by one rule where some rows were fitted; held-out poses only where the
/// rule asks them.
#[must_use]
pub fn lambda_by(rule: LambdaRule, problem: &Problem, at: &Fit, rows: &[usize]) -> f64 {
    let free = problem.unknowns.free();
    let factorised = || Factorised::new(&problem.linearise(&at.state).triangle(rows, None), free);
    let found = match rule {
        LambdaRule::LCurve => factorised().corner(),
        LambdaRule::Gcv => factorised().gcv(),
        LambdaRule::Discrepancy => {
            Some(factorised().discrepancy(noise(problem, rows)).unwrap_or(0.0))
        }
        LambdaRule::MaximumLikelihood => {
            lambda_of(rule, &at.normal, free).or_else(|| factorised().maximum_likelihood())
        }
        _ => lambda_of(rule, &at.normal, free),
    };
    found.unwrap_or_else(|| {
        let folds = folds::random(problem.data, rows, folds::SEED + 1);
        choose(problem, &at.state, rows, &folds).by(rule)
    })
}

/// The same from sums alone; `None` of rules that ask for more, and where lambda is
/// so small that sums do not see what it leaves open, as it nearly never is.
#[must_use]
pub fn lambda_of(rule: LambdaRule, normal: &Normal, free: usize) -> Option<f64> {
    match rule {
        LambdaRule::MaximumAPosteriori => Some(1.0),
        LambdaRule::Fixed(lambda) => Some(lambda),
        LambdaRule::MaximumLikelihood => {
            let sums = Factorised::of_normal(normal, free);
            sums.maximum_likelihood().filter(|lambda| sums.tells(*lambda))
        }
        _ => None,
    }
}

/// Applies the rules at a state, from one triangle of each fold.
#[must_use]
pub fn choose(problem: &Problem, state: &State, rows: &[usize], folds: &[Fold]) -> LambdaChoice {
    chosen(problem, state, rows, folds).0
}

/// The same, and the whole problem factorised.
#[must_use]
pub fn chosen(
    problem: &Problem,
    state: &State,
    rows: &[usize],
    folds: &[Fold],
) -> (LambdaChoice, Factorised) {
    let at = problem.linearise(state);
    let free = problem.unknowns.free();
    let parts: Vec<Triangle> = folds.iter().map(|f| at.triangle(&f.held_out, None)).collect();
    let whole = Factorised::new(&Triangle::join(parts.iter()), free);
    let others = Triangle::without_each(&parts);
    let others: Vec<Factorised> = others.iter().map(|t| Factorised::new(t, free)).collect();
    // A fold is judged where the others determine all frames.
    let known = |(_, o): &(_, &Factorised)| o.determined() == whole.determined();
    let judged: Vec<_> =
        in_metres(&at, problem, folds, parts).into_iter().zip(&others).filter(known).collect();
    let with_errors = |lambdas: Vec<f64>| -> Vec<(f64, f64)> {
        lambdas.into_iter().map(|lambda| (lambda, held_out(&judged, lambda))).collect()
    };
    let l_curve = whole.corner();
    let largest = whole.singular_values().iter().copied().fold(0.0, f64::max).powi(2);
    let start = l_curve.unwrap_or(1e-6 * largest);
    let mut tried = with_errors((-9..=4).map(|k| start * 10_f64.powi(k)).collect());
    let decade = flattest(&tried);
    let tenths = (-5..=5).filter(|k| *k != 0).map(|k| decade * 10_f64.powf(f64::from(k) / 10.0));
    tried.extend(with_errors(tenths.collect()));
    let two_step = flattest(&tried);
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A quarter of a decade is as finely as held-out errors can tell.
    let coarse = with_errors(whole.grid().into_iter().step_by(4).collect());
    let choice = LambdaChoice {
        l_curve,
        two_step,
        gcv: whole.gcv(),
        discrepancy: whole.discrepancy(noise(problem, rows)),
        k_fold: flattest(&coarse),
        maximum_likelihood: whole.maximum_likelihood(),
        tried,
    };
    (choice, whole)
}

/// What tells how far off a solution is at the rows of a fold, m.
struct HeldOut {
    /// Of its equations; in units that are so many metres.
    triangle: Triangle,
    metres: f64,
    rows: usize,
}

/// Of folds whose triangles are known: where all equations are of one unit these
/// tell it.
fn in_metres(
    at: &Linearised,
    problem: &Problem,
    folds: &[Fold],
    parts: Vec<Triangle>,
) -> Vec<HeldOut> {
    let all = folds.iter().flat_map(|fold| &fold.held_out);
    let (parts, metres) = match Values::common(all.clone().map(|row| problem.in_metres(*row))) {
        Some(metres) => (parts, metres),
        None => {
            let mut weights = vec![Values::default(); problem.data.rows.len()];
            all.for_each(|row| weights[*row] = problem.in_metres(*row).map(|m| m * m));
            let part = |fold: &Fold| at.triangle(&fold.held_out, Some(&weights));
            (folds.iter().map(part).collect(), 1.0)
        }
    };
    let of = |(fold, triangle): (&Fold, Triangle)| HeldOut {
        triangle,
        metres,
        rows: fold.held_out.len(),
    };
    folds.iter().zip(parts).map(of).collect()
}

/// RMS error of held-out rows with a lambda, mm.
fn held_out(folds: &[(HeldOut, &Factorised)], lambda: f64) -> f64 {
    let square = |(fold, others): &(HeldOut, &Factorised)| {
        fold.triangle.residual_square(&others.solve(lambda)) * fold.metres.powi(2)
    };
    let rows: usize = folds.iter().map(|(fold, _)| fold.rows).sum();
    (folds.iter().map(square).sum::<f64>() / rows.max(1) as f64).sqrt() * 1e3
}

/// The lambda of least error; where the error is flat, more regularisation is
/// safer.
fn flattest(tried: &[(f64, f64)]) -> f64 {
    let least = tried.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
    tried.iter().filter(|t| t.1 <= least * 1.0001).map(|t| t.0).fold(0.0, f64::max)
}

/// Standard deviation of the noise in the unit of the equations.
fn noise(problem: &Problem, rows: &[usize]) -> f64 {
    match problem.scaling {
        Scaling::Prior => 1.0,
        Scaling::Printed => {
            let square: f64 = rows.iter().map(|r| problem.data.rows[*r].sigma.powi(2)).sum();
            (square / rows.len() as f64).sqrt()
        }
    }
}

impl LambdaChoice {
    /// The lambda of a rule; the two-step one where it says nothing.
    #[must_use]
    pub fn by(&self, rule: LambdaRule) -> f64 {
        match rule {
            LambdaRule::MaximumAPosteriori => 1.0,
            LambdaRule::LCurve => self.l_curve.unwrap_or(self.two_step),
            LambdaRule::TwoStep => self.two_step,
            LambdaRule::Gcv => self.gcv.unwrap_or(self.two_step),
            // Structure is left: as little regularisation as there is.
            LambdaRule::Discrepancy => self.discrepancy.unwrap_or(0.0),
            LambdaRule::KFold => self.k_fold,
            LambdaRule::MaximumLikelihood => self.maximum_likelihood.unwrap_or(self.two_step),
            LambdaRule::Fixed(lambda) => lambda,
        }
    }
}
