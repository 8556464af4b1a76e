//! Tolerances of a type from its arms, by empirical Bayes.
//!
//! Corrections of arm i are `x_i ~ N(m, diag(t^2))`, what was measured of it is
//! `|A_i x - b_i|^2 / k_i^2`. Neither x nor m is taken as known: both are integrated
//! out together (an arm says of most parameters only sums, and a direction that it
//! leaves open must not count as a deviation of zero). The logarithms of `t^2` are
//! normal about a centre that all lengths or all angles share; how far they scatter is
//! learned too, so that few arms, or arms whose parameters are all alike, are given one
//! tolerance and many arms each their own. Expectation, maximisation (Dempster, Laird
//! and Rubin, J. Roy. Stat. Soc. B 39 (1977) 1; Gelman et al., Bayesian Data Analysis,
//! ch. 5).

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::step::{Said, Step, shared};
use crate::tikhonov::Normal;

/// Rounds until no tolerance changes by more than this share of it...
const SETTLED: f64 = 1e-3;
/// ...or there were so many: of a direction that no arm determines nothing settles fast.
const ROUNDS: usize = 300;
/// Standard deviation of the centres about the usual tolerances, as logarithm of `t^2`.
const CENTRE: f64 = 1.0;
/// So many parameters more, with a variance of one, keep the scatter of the logarithms
/// of `t^2` in reason.
const USUAL: f64 = 2.0;
/// Newton steps to a logarithm, from the last one.
const STEPS: usize = 20;

/// What a fleet says of its type; parameters in usual tolerances, from nominal.
#[derive(Debug, Clone)]
pub struct Learned {
    /// Mean correction, zero where none is common to the type.
    pub mean: DVector<f64>,
    /// Variance of it.
    pub doubt: DVector<f64>,
    /// Variance of the corrections about it.
    pub variance: DVector<f64>,
    /// Of their logarithms the variance about the common centres.
    pub scatter: f64,
    /// Where the centre of each is.
    pub(super) centre: DVector<f64>,
    /// How far the data determine each parameter, in arms.
    pub determined: DVector<f64>,
    /// What is then known of each arm.
    pub arms: Vec<Known>,
}

/// What is known of an arm of the type.
#[derive(Debug, Clone)]
pub struct Known {
    /// Mean of its corrections.
    pub mean: DVector<f64>,
    /// Variance of each.
    pub variance: DVector<f64>,
    /// Expected squares of its deviations from the mean of the type.
    pub square: DVector<f64>,
    /// Noise of its measurements over what was stated, squared.
    pub noise: f64,
    /// What it says of the means that are free.
    pub(super) says: Said,
}

impl Learned {
    /// Tolerance of the next arm: spread about the mean, and doubt about both.
    #[must_use]
    pub fn tolerance(&self) -> DVector<f64> {
        let spread = self.variance.zip_map(&self.freedom(), |v, freedom| v * freedom.recip().exp());
        (spread + &self.doubt).map(f64::sqrt)
    }

    /// Degrees of freedom of each variance: what arms and the other parameters say.
    #[must_use]
    pub fn freedom(&self) -> DVector<f64> {
        self.determined.add_scalar(2.0 / self.scatter)
    }

    /// Noise of the fleet over what was stated, squared: the geometric mean.
    #[must_use]
    pub fn noise(&self) -> f64 {
        let sum: f64 = self.arms.iter().map(|arm| arm.noise.ln()).sum();
        (sum / self.arms.len().max(1) as f64).exp()
    }
}

/// What is unknown of the type.
struct Type<'a> {
    /// Which parameters are lengths.
    lengths: &'a [bool],
    /// Parameters whose mean is not taken as zero.
    free: &'a [usize],
    variance: DVector<f64>,
    /// Logarithm of the variance about which those of all lengths, of all angles are.
    centres: [f64; 2],
    scatter: f64,
    mean: DVector<f64>,
    /// Covariance of the means that are free.
    doubt: DMatrix<f64>,
}

/// Learns from the normal equations of arms, parameters in usual tolerances from
/// nominal; the means of `free` may differ from zero.
#[must_use]
pub fn learn(arms: &[&Normal], lengths: &[bool], free: &[usize]) -> Learned {
    let size = lengths.len();
    let mut of = Type {
        lengths,
        free,
        variance: DVector::repeat(size, 1.0),
        centres: [0.0; 2],
        scatter: 1.0,
        mean: DVector::zeros(size),
        doubt: DMatrix::zeros(free.len(), free.len()),
    };
    let mut noise = vec![1.0; arms.len()];
    let mut known = of.expect(arms, &mut noise);
    for _ in 0..ROUNDS {
        let last = of.variance.clone();
        of.maximise(&known);
        known = of.expect(arms, &mut noise);
        let change = of.variance.zip_map(&last, |now, then| (now / then).ln().abs() / 2.0).max();
        if change < SETTLED {
            break;
        }
    }
    let share = |k: usize, arm: &Known| 1.0 - arm.variance[k] / of.variance[k];
    let mut doubt = DVector::zeros(size);
    free.iter().enumerate().for_each(|(i, k)| doubt[*k] = of.doubt[(i, i)]);
    Learned {
        doubt,
        determined: DVector::from_fn(size, |k, _| {
            known.iter().map(|arm| share(k, arm).clamp(0.0, 1.0)).sum()
        }),
        mean: of.mean,
        centre: DVector::from_fn(size, |k, _| of.centres[usize::from(!lengths[k])]),
        variance: of.variance,
        scatter: of.scatter,
        arms: known,
    }
}

impl Type<'_> {
    /// Means and arms given tolerances and noise; the noise anew.
    fn expect(&mut self, arms: &[&Normal], noise: &mut [f64]) -> Vec<Known> {
        let precision = self.variance.map(f64::recip);
        let steps: Vec<Step> = arms
            .par_iter()
            .zip(&*noise)
            .map(|(arm, noise)| Step::of(arm, *noise, &precision))
            .collect();
        let says: Vec<Said> = steps.iter().map(|step| step.says(self.free, &precision)).collect();
        let (means, doubt) = says.iter().fold(Said::nothing(self.free.len()), Said::and).solved();
        self.free.iter().zip(&means).for_each(|(k, mean)| self.mean[*k] = *mean);
        self.doubt = doubt;
        let known = |(step, arm): (&Step, &&Normal)| self.known(step, arm, &precision);
        let (mut known, left): (Vec<Known>, Vec<f64>) =
            steps.par_iter().zip(arms).map(known).unzip();
        noise.copy_from_slice(&shared(arms, &left));
        for ((known, noise), says) in known.iter_mut().zip(noise).zip(says) {
            (known.noise, known.says) = (*noise, says);
        }
        known
    }

    /// An arm, and the sum of squares that its measurements are expected to leave.
    fn known(&self, step: &Step, arm: &Normal, precision: &DVector<f64>) -> (Known, f64) {
        let s = &step.covariance;
        let mean = step.at(&self.mean, precision);
        // How the deviation moves with the means, S W - I.
        let size = mean.len();
        let moved = DMatrix::from_fn(size, self.free.len(), |r, c| {
            let k = self.free[c];
            s[(r, k)] * precision[k] - f64::from(u8::from(r == k))
        });
        let of_means = &moved * &self.doubt;
        let square = DVector::from_fn(size, |k, _| {
            let doubt = of_means.row(k).dot(&moved.row(k));
            (mean[k] - self.mean[k]).powi(2) + s[(k, k)] + doubt
        });
        let left = step.left(arm, &mean);
        let says = Said::nothing(0);
        (Known { mean, variance: s.diagonal(), square, noise: 1.0, says }, left)
    }

    /// Tolerances given the arms, common centres and scatter given these.
    fn maximise(&mut self, known: &[Known]) {
        let count = known.len() as f64;
        let mut sums = DVector::zeros(self.lengths.len());
        known.iter().for_each(|arm| sums += &arm.square);
        let group = |k: usize| usize::from(!self.lengths[k]);
        let share = |k: usize| -> f64 {
            known.iter().map(|arm| (1.0 - arm.variance[k] / self.variance[k]).clamp(0.0, 1.0)).sum()
        };
        // Half a unit of information on a logarithm from each arm that says something.
        let doubt: Vec<f64> =
            (0..sums.len()).map(|k| 1.0 / (share(k) / 2.0 + 1.0 / self.scatter)).collect();
        let log = |k: usize| log_variance(sums[k], count, self.centres[group(k)], self.scatter);
        let logs: Vec<f64> = (0..sums.len()).map(log).collect();
        for (g, centre) in self.centres.iter_mut().enumerate() {
            let own = (0..logs.len()).filter(|k| group(*k) == g);
            let (n, sum) = own.fold((0.0, 0.0), |(n, sum), k| (n + 1.0, sum + logs[k]));
            *centre = sum / (n + self.scatter / (CENTRE * CENTRE));
        }
        let off = |k: usize| (logs[k] - self.centres[group(k)]).powi(2) + doubt[k];
        let squares: f64 = (0..logs.len()).map(off).sum();
        self.scatter = (USUAL + squares) / (USUAL + logs.len() as f64);
        self.variance = DVector::from_iterator(logs.len(), logs.iter().map(|log| log.exp()));
    }
}

/// The likeliest logarithm of a variance that so many deviations with this sum of
/// squares have, normal about a centre with this scatter.
pub(super) fn log_variance(sum: f64, count: f64, centre: f64, scatter: f64) -> f64 {
    let start = if sum > 0.0 && count > 0.0 { (sum / count).ln() } else { centre };
    (0..STEPS).fold(start, |log, _| {
        let share = sum / 2.0 * (-log).exp();
        let slope = count / 2.0 - share + (log - centre) / scatter;
        // Convex; short steps where the exponential is steep.
        log - (slope / (share + 1.0 / scatter)).clamp(-1.0, 1.0)
    })
}
