//! One arm where tolerances and means of its type are given.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::tikhonov::Normal;

/// A mean that is not zero is of this size, in usual tolerances: wide.
const MEAN: f64 = 10.0;
/// Equations' worth of weight of the fleet's noise in that of an arm: few poses say
/// little of their noise.
const NOISE: f64 = 10.0;
/// Rounds for the noise of arms of which nothing else is known.
const NOISE_ROUNDS: usize = 20;

/// Information about some means, and the right-hand side to it.
#[derive(Debug, Clone)]
pub(super) struct Said {
    pub information: DMatrix<f64>,
    pull: DVector<f64>,
}

impl Said {
    pub fn nothing(count: usize) -> Self {
        let information = DMatrix::from_diagonal_element(count, count, MEAN.powi(-2));
        Self { information, pull: DVector::zeros(count) }
    }

    pub fn and(self, other: &Self) -> Self {
        Self { information: self.information + &other.information, pull: self.pull + &other.pull }
    }

    /// Means and their covariance.
    pub fn solved(self) -> (DVector<f64>, DMatrix<f64>) {
        let count = self.pull.len();
        let inverse = self.information.cholesky().map(|factor| factor.inverse());
        let covariance = inverse.unwrap_or_else(|| DMatrix::zeros(count, count));
        (&covariance * self.pull, covariance)
    }
}

/// An arm given tolerances and means: covariance and what it says of the means.
pub(super) struct Step {
    pub covariance: DMatrix<f64>,
    /// `S b / k^2`: where it would be with means of zero.
    pub pulled: DVector<f64>,
}

impl Step {
    pub fn of(arm: &Normal, noise: f64, precision: &DVector<f64>) -> Self {
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
    pub fn at(&self, mean: &DVector<f64>, precision: &DVector<f64>) -> DVector<f64> {
        &self.pulled + &self.covariance * mean.component_mul(precision)
    }

    /// Sum of squares that its measurements are expected to leave there.
    pub fn left(&self, arm: &Normal, at: &DVector<f64>) -> f64 {
        let spread = arm.h().component_mul(&self.covariance).sum();
        let explained = 2.0 * arm.g().dot(at) - at.dot(&(arm.h() * at));
        (arm.s() - explained + spread).max(0.0)
    }

    /// What the arm says of the means of some parameters, its own corrections
    /// integrated out.
    pub fn says(&self, free: &[usize], precision: &DVector<f64>) -> Said {
        let information = DMatrix::from_fn(free.len(), free.len(), |i, j| {
            let (a, b) = (free[i], free[j]);
            let own = if a == b { precision[a] } else { 0.0 };
            own - precision[a] * self.covariance[(a, b)] * precision[b]
        });
        let pull = free.iter().map(|a| precision[*a] * self.pulled[*a]);
        Said { information, pull: DVector::from_iterator(free.len(), pull) }
    }
}

/// Noise of each arm over what was stated, squared, whatever its corrections are: an arm
/// that differs must not pass for one that was measured badly.
#[must_use]
pub(super) fn noises(arms: &[&Normal]) -> Vec<f64> {
    rounds(arms, |left| shared(arms, left))
}

/// The same of each by itself: how the others were measured says nothing of it.
#[must_use]
pub(super) fn alone(arms: &[&Normal]) -> Vec<f64> {
    let of = |(arm, left): (&&Normal, &f64)| left / arm.equations().max(1) as f64;
    rounds(arms, |left| arms.iter().zip(left).map(of).map(|n| n.max(f64::MIN_POSITIVE)).collect())
}

/// Noise that is found, squared, by how it follows from what is left of the arms.
fn rounds(arms: &[&Normal], next: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let size = arms.first().map_or(0, |arm| arm.unknowns());
    let (mean, precision) = (DVector::zeros(size), DVector::repeat(size, MEAN.powi(-2)));
    let left = |(arm, noise): (&&Normal, &f64)| {
        let step = Step::of(arm, *noise, &precision);
        step.left(arm, &step.at(&mean, &precision))
    };
    (0..NOISE_ROUNDS).fold(vec![1.0; arms.len()], |noises, _| {
        let left: Vec<f64> = arms.par_iter().zip(&noises).map(left).collect();
        next(&left)
    })
}

/// Noise of arms from what is left of them, each a little as that of all.
pub(super) fn shared(arms: &[&Normal], left: &[f64]) -> Vec<f64> {
    let count = |arm: &&Normal| arm.equations() as f64;
    let all: f64 = arms.iter().map(count).sum();
    let common = left.iter().sum::<f64>() / all.max(1.0);
    let of = |(arm, left): (&&Normal, &f64)| (NOISE * common + left) / (NOISE + count(arm));
    arms.iter().zip(left).map(of).map(|noise| noise.max(f64::MIN_POSITIVE)).collect()
}
