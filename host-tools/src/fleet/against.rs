//! How far arms are from their type, and its means from the drawing.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::learn::{Known, Learned, log_variance};
use super::step::{Said, Step};
use super::student::beyond;
use crate::tikhonov::Normal;

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

    /// Chance that the mean of each parameter, were it let, left zero as far as it would
    /// in a type where it is zero; `None` of those that are free already and those of
    /// which the arms say nothing.
    #[must_use]
    pub fn leaning(&self, arms: &[&Normal], free: &[usize]) -> Vec<Option<f64>> {
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
        let (count, freedom) = (self.arms.len() as f64, self.freedom());
        let by = |k: usize| {
            let coupling = information.column(k).select_rows(free);
            let taken = held.as_ref().map_or(0.0, |h| coupling.dot(&h.solve(&coupling)));
            let left = information[(k, k)] - taken;
            // What the arms together say less of than of one arm is not asked.
            if free.contains(&k) || left < SAID * information[(k, k)].max(precision[k]) {
                return None;
            }
            let square = lean[k] * lean[k] / left;
            // The variance took a mean that is no zero for spread: undone. By these arms
            // alone and by all parameters together, the less surprising of the two.
            let undone = |square: f64, n: f64| {
                let square = square.min(0.999 * n);
                ((n - 1.0).max(0.0) * square / (n - square)).sqrt()
            };
            let own = undone(square * self.variance[k] * count / sums[k], count);
            let all = beyond(undone(square, freedom[k]), freedom[k] as usize);
            Some(beyond(own, self.arms.len() - 1).max(all))
        };
        (0..size).map(by).collect()
    }
}
