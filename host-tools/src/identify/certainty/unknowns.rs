//! The covariance of all unknowns.
//!
//! With `A` the weighted Jacobian, `H = A'A + lambda P` and unit noise, the
//! estimate of an arm whose true corrections are `x` scatters by
//! `H^-1 A'A H^-1` about a point that is off by the regularisation bias
//! `-lambda H^-1 P x`. The bias is unknown with x; its expected square over arms
//! made to the tolerances is `lambda^2 H^-1 P E P H^-1`, E the variance of the
//! corrections. For the maximum a posteriori estimate the two add up to the
//! posterior covariance `H^-1`. Intervals of the sum cover the truth over many
//! arms; for one given arm those of the noise cover the *mean* of many
//! identifications, which is not the truth where the data are weak.

use nalgebra::{DMatrix, DVector};

use super::carried::Carried;
use crate::identify::fit::ANOTHER_ARM;
use crate::identify::fit::estimate::Estimate;
use crate::identify::problem::{Problem, Scaling};
use crate::identify::{LambdaRule, State};
use crate::model::Values;
use crate::statistics::median;
use crate::tikhonov::{self, Normal};

/// Covariance of all unknowns, in units of the problem.
#[derive(Debug, Clone)]
pub struct Covariances {
    /// From the noise of the measurements.
    pub noise: DMatrix<f64>,
    /// Expected square of the regularisation bias.
    pub bias: DMatrix<f64>,
    /// Of each, SI.
    pub(super) units: DVector<f64>,
}

impl Covariances {
    /// Of an estimate; the arm's corrections have a standard deviation of
    /// `spread` tolerances.
    #[must_use]
    pub fn of(problem: &Problem, found: &Estimate, spread: f64) -> Self {
        let carried = Carried::of(problem, found);
        let sums = (&found.fit.normal, &carried);
        Self::of_sums(problem, &found.fit.state, sums, (found.lambda, spread))
    }

    /// Of normal equations at a state and the noise that their rows carry, with this lambda
    /// and spread.
    #[must_use]
    pub fn of_sums(
        problem: &Problem,
        state: &State,
        (normal, carried): (&Normal, &Carried),
        (lambda, spread): (f64, f64),
    ) -> Self {
        let free = problem.unknowns.free();
        let targets = problem.of_targets(state);
        let held = normal.clone().plus(&Normal::new(&targets));
        let inverse = tikhonov::covariance(&held, free, lambda);
        let used = inverse.component_mul(&carried.information).sum();
        let sigma = believed(carried, used, stated(problem));
        let scatter = &inverse * &carried.information * &inverse * (sigma * sigma);
        let units = problem.units();
        let list = problem.unknowns.list();
        let pull = DVector::from_fn(list.len(), |k, _| {
            if k < free { 0.0 } else { lambda * spread * problem.tolerance(list[k]) / units[k] }
        });
        let root = &inverse * DMatrix::from_diagonal(&pull);
        let aside = inverse * targets.columns(0, list.len()).transpose();
        Self { noise: scatter, bias: &root * root.transpose() + &aside * aside.transpose(), units }
    }

    /// Both together, SI.
    #[must_use]
    pub fn total(&self) -> DMatrix<f64> {
        let units = DMatrix::from_diagonal(&self.units);
        &units * (&self.noise + &self.bias) * &units
    }

    /// One standard deviation of each of some predicted quantities: from noise
    /// alone, and with the bias. `block` says how they move with each unknown
    /// in its unit.
    #[must_use]
    pub fn of_predicted(&self, block: &DMatrix<f64>) -> [Values; 2] {
        let variance = |c: &DMatrix<f64>| {
            let weighed = block * c;
            Values::from_fn(block.nrows(), |k| weighed.row(k).dot(&block.row(k)).max(0.0))
        };
        let (noise, bias) = (variance(&self.noise), variance(&self.bias));
        [noise, noise.zip_map(&bias, |n, b| n + b)].map(|v| v.map(f64::sqrt))
    }
}

/// Standard deviation of an arm's corrections, in tolerances, as a rule for lambda
/// knows it. Lambda from the marginal likelihood *is* an estimate of it, of arms made
/// worse than the tolerances; that one is made better, it does not prove.
#[must_use]
pub fn spread(rule: LambdaRule, lambda: f64) -> f64 {
    match rule {
        LambdaRule::MaximumLikelihood => lambda.sqrt().recip().clamp(1.0, ANOTHER_ARM),
        _ => 1.0,
    }
}

/// Standard deviation of an equation: as stated, unless the residuals beside what the fit has
/// `used` up are above that by more than three standard deviations of such a figure. Else
/// chance, which only ever raises it, would widen every interval. The root mean square, whatever
/// the distribution: for it a least-squares estimate scatters.
fn believed(carried: &Carried, used: f64, stated: f64) -> f64 {
    let free = (carried.equations - used).max(1.0);
    let found = (carried.square / free).sqrt();
    let chance = (2.0 * free / carried.alike).sqrt().recip();
    if found > stated * (1.0 + 3.0 * chance) { found } else { stated }
}

/// What is stated of an equation, in its unit.
fn stated(problem: &Problem) -> f64 {
    match problem.scaling {
        Scaling::Prior => 1.0,
        Scaling::Printed => {
            let sigmas: Vec<f64> = problem.data.rows.iter().map(|r| r.sigma).collect();
            median(&sigmas)
        }
    }
}
