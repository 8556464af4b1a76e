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
/// A mean that is not zero is of this size, in usual tolerances: wide.
const MEAN: f64 = 10.0;
/// Equations' worth of weight of the fleet's noise in that of an arm: few poses say
/// little of their noise.
const NOISE: f64 = 10.0;

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
    centre: DVector<f64>,
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
    says: Said,
}

/// Information about some means, and the right-hand side to it.
#[derive(Debug, Clone)]
struct Said {
    information: DMatrix<f64>,
    pull: DVector<f64>,
}

impl Said {
    fn nothing(count: usize) -> Self {
        let information = DMatrix::from_diagonal_element(count, count, MEAN.powi(-2));
        Self { information, pull: DVector::zeros(count) }
    }

    fn and(self, other: &Self) -> Self {
        Self { information: self.information + &other.information, pull: self.pull + &other.pull }
    }

    /// Means and their covariance.
    fn solved(self) -> (DVector<f64>, DMatrix<f64>) {
        let count = self.pull.len();
        let inverse = self.information.cholesky().map(|factor| factor.inverse());
        let covariance = inverse.unwrap_or_else(|| DMatrix::zeros(count, count));
        (&covariance * self.pull, covariance)
    }
}

/// An arm given tolerances and means: covariance and what it says of the means.
struct Step {
    covariance: DMatrix<f64>,
    /// `S b / k^2`: where it would be with means of zero.
    pulled: DVector<f64>,
}

impl Step {
    fn of(arm: &Normal, noise: f64, precision: &DVector<f64>) -> Self {
        let mut h = arm.h() / noise;
        for (k, w) in precision.iter().enumerate() {
            h[(k, k)] += w;
        }
        let size = h.nrows();
        // A sum of squares and a positive diagonal.
        let covariance =
            h.cholesky().map_or_else(|| DMatrix::zeros(size, size), |factor| factor.inverse());
        let pulled = &covariance * (arm.g() / noise);
        Self { covariance, pulled }
    }

    /// Mean of the arm's corrections where the type has these.
    fn at(&self, mean: &DVector<f64>, precision: &DVector<f64>) -> DVector<f64> {
        &self.pulled + &self.covariance * mean.component_mul(precision)
    }

    /// Sum of squares that its measurements are expected to leave there.
    fn left(&self, arm: &Normal, at: &DVector<f64>) -> f64 {
        let spread = arm.h().component_mul(&self.covariance).sum();
        let explained = 2.0 * arm.g().dot(at) - at.dot(&(arm.h() * at));
        (arm.s() - explained + spread).max(0.0)
    }

    /// What the arm says of the means of some parameters, its own corrections
    /// integrated out.
    fn says(&self, free: &[usize], precision: &DVector<f64>) -> Said {
        let information = DMatrix::from_fn(free.len(), free.len(), |i, j| {
            let (a, b) = (free[i], free[j]);
            let own = if a == b { precision[a] } else { 0.0 };
            own - precision[a] * self.covariance[(a, b)] * precision[b]
        });
        let pull = free.iter().map(|a| precision[*a] * self.pulled[*a]);
        Said { information, pull: DVector::from_iterator(free.len(), pull) }
    }
}

/// An arm held against the type that others make: each parameter's deviation and its
/// standard deviation were the arm of the type, and by how many arms that is known.
#[derive(Debug, Clone)]
pub struct Against {
    /// Expected deviation from the mean of the type.
    pub deviation: DVector<f64>,
    /// Standard deviation of that over arms of the type, zero where the arm's data
    /// say nothing.
    pub sigma: DVector<f64>,
    /// Degrees of freedom of the standard deviation.
    pub freedom: DVector<f64>,
}

/// A parameter of which an arm's data say less than this share is not judged.
const SAID: f64 = 0.05;

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

    /// Holds an arm against the type; if it is one of those that it was learned of
    /// (the index), against the others.
    #[must_use]
    pub fn against(
        &self,
        (arm, noise): (&Normal, f64),
        member: Option<usize>,
        free: &[usize],
    ) -> Against {
        let own = member.map(|i| &self.arms[i]);
        let others = self.arms.len() as f64 - f64::from(u8::from(own.is_some()));
        let (mut mean, mut variance) = (self.mean.clone(), &self.variance + &self.doubt);
        if let Some(own) = own {
            let sums = self.arms.iter().map(|arm| &arm.square);
            let sums = sums.fold(-&own.square, |sum, square| sum + square);
            let of =
                |k: usize| log_variance(sums[k].max(0.0), others, self.centre[k], self.scatter);
            variance = DVector::from_fn(sums.len(), |k, _| of(k).exp());
            let said = self.arms.iter().enumerate().filter(|(i, _)| Some(*i) != member);
            let said = said.fold(Said::nothing(free.len()), |all, (_, arm)| all.and(&arm.says));
            let (means, doubt) = said.solved();
            for (i, k) in free.iter().enumerate() {
                mean[*k] = means[i];
                variance[*k] += doubt[(i, i)];
            }
        }
        let precision = variance.map(f64::recip);
        let step = Step::of(arm, noise, &precision);
        let left = step.covariance.diagonal();
        let at = step.at(&mean, &precision);
        let said = |k: usize| 1.0 - left[k] / variance[k];
        let of_member = |k: usize| own.map_or(0.0, |own| 1.0 - own.variance[k] / self.variance[k]);
        Against {
            deviation: at - mean,
            sigma: DVector::from_fn(left.len(), |k, _| {
                if said(k) < SAID { 0.0 } else { (variance[k] - left[k]).sqrt() }
            }),
            freedom: self.freedom() - DVector::from_fn(left.len(), |k, _| of_member(k)),
        }
    }

    /// Noise of the fleet over what was stated, squared: the geometric mean.
    #[must_use]
    pub fn noise(&self) -> f64 {
        let sum: f64 = self.arms.iter().map(|arm| arm.noise.ln()).sum();
        (sum / self.arms.len().max(1) as f64).exp()
    }

    /// By how many of its standard deviations the mean of each parameter would leave
    /// zero if it were let, Student's t of one degree of freedom less than there are
    /// arms; zero of those that are free already.
    #[must_use]
    pub fn leaning(&self, arms: &[&Normal], free: &[usize]) -> DVector<f64> {
        let precision = self.variance.map(f64::recip);
        let size = precision.len();
        let all: Vec<usize> = (0..size).collect();
        let of = |(known, arm): (&Known, &&Normal)| {
            let step = Step::of(arm, known.noise, &precision);
            let lean = (&known.mean - &self.mean).component_mul(&precision);
            (step.says(&all, &precision).information, lean)
        };
        let parts: Vec<_> = self.arms.par_iter().zip(arms).map(of).collect();
        let mut information = DMatrix::zeros(size, size);
        let mut lean = DVector::zeros(size);
        for (part, own) in parts {
            information += part;
            lean += own;
        }
        let held = information.select_rows(free).select_columns(free);
        let held = held.cholesky();
        let mut sums = DVector::zeros(size);
        self.arms.iter().for_each(|arm| sums += &arm.square);
        let count = self.arms.len() as f64;
        let by = |k: usize| {
            let coupling = information.column(k).select_rows(free);
            let taken = held.as_ref().map_or(0.0, |h| coupling.dot(&h.solve(&coupling)));
            let left = information[(k, k)] - taken;
            // What the arms together say less of than of one arm is not asked.
            if free.contains(&k) || left < SAID * information[(k, k)].max(precision[k]) {
                return 0.0;
            }
            // Of these arms alone, whatever other parameters scatter by; and the variance
            // took a mean that is no zero for spread: undone. That is exact of a sum that
            // every arm determines, whoever shares it.
            let own = lean[k] * lean[k] / left * self.variance[k] * count / sums[k];
            let square = own.min(0.999 * count);
            ((count - 1.0) * square / (count - square)).sqrt()
        };
        DVector::from_fn(size, |k, _| by(k))
    }
}

/// Rounds for the noise of arms of which nothing else is known.
const NOISE_ROUNDS: usize = 20;

/// Noise of each arm over what was stated, squared, whatever its corrections are: an arm
/// that differs must not pass for one that was measured badly.
#[must_use]
pub fn noises(arms: &[&Normal]) -> Vec<f64> {
    let size = arms.first().map_or(0, |arm| arm.unknowns());
    let (mean, precision) = (DVector::zeros(size), DVector::repeat(size, MEAN.powi(-2)));
    let left = |(arm, noise): (&&Normal, &f64)| {
        let step = Step::of(arm, *noise, &precision);
        step.left(arm, &step.at(&mean, &precision))
    };
    (0..NOISE_ROUNDS).fold(vec![1.0; arms.len()], |noises, _| {
        let left: Vec<f64> = arms.par_iter().zip(&noises).map(left).collect();
        shared(arms, &left)
    })
}

/// Noise of arms from what is left of them, each a little as that of all.
fn shared(arms: &[&Normal], left: &[f64]) -> Vec<f64> {
    let count = |arm: &&Normal| arm.equations() as f64;
    let all: f64 = arms.iter().map(count).sum();
    let common = left.iter().sum::<f64>() / all.max(1.0);
    let of = |(arm, left): (&&Normal, &f64)| (NOISE * common + left) / (NOISE + count(arm));
    arms.iter().zip(left).map(of).map(|noise| noise.max(f64::MIN_POSITIVE)).collect()
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
fn log_variance(sum: f64, count: f64, centre: f64, scatter: f64) -> f64 {
    let start = if sum > 0.0 && count > 0.0 { (sum / count).ln() } else { centre };
    (0..STEPS).fold(start, |log, _| {
        let share = sum / 2.0 * (-log).exp();
        let slope = count / 2.0 - share + (log - centre) / scatter;
        // Convex; short steps where the exponential is steep.
        log - (slope / (share + 1.0 / scatter)).clamp(-1.0, 1.0)
    })
}
