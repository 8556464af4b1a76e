//! Variance components of readings of a pose: what is common to them, and what each has by
//! itself (Baltagi, Econometric Analysis of Panel Data, 2.3).

use nalgebra::DMatrix;

/// Poses with repeats from which on they tell the noise of the others by themselves.
pub const ENOUGH: usize = 10;
/// Share of a UR10: 0.037 mm common and 0.018 mm not.
const USUAL: f64 = 0.8;
/// Equations that say that it is this, beside those that repeat a pose. Fewer than [`ENOUGH`]
/// poses once counted as nothing beside it: of clean arms whose readings have nothing in common
/// the differences between a few were blown up to tails of the noise, and 36 of 91 were not called
/// clean (`few_repeats_tell_the_share_as_many_do`).
const USUALLY: f64 = 3.0;
/// Most of the variance that can be common: bit-identical repeats tell nothing
/// and are one row.
pub const MOST: f64 = 0.999;

/// Residuals of the readings of one pose: one column a reading.
pub type Readings = DMatrix<f64>;

/// Variances of residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Of the readings of a pose about their mean.
    pub within: f64,
    /// Of the poses, beyond what that makes of their means.
    pub between: f64,
}

/// Equations that a fit has used up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Used {
    /// Of the means of poses.
    pub means: f64,
    /// Of what readings are apart from the mean of their pose: nothing where they are readings
    /// of one thing.
    pub apart: f64,
}

/// Share of the variance that is common to the readings of a pose, from the
/// residuals of all poses.
#[must_use]
pub fn common_share(poses: &[Readings], used: Used) -> f64 {
    if poses.iter().all(|p| p.ncols() < 2) {
        return 0.0;
    }
    let sums = Sums::of(poses);
    let Sums { equations, noise, .. } = sums;
    let apart = (sums.freedom - used.apart).max(0.0);
    let mean = sums.between / (equations - used.means).max(1.0);
    // Of the total `within (1 - noise / equations) + mean` some equations say that so much of
    // it is within.
    let said = USUALLY * (1.0 - USUAL);
    let within = (sums.within + said * mean) / (apart + USUALLY - said * (1.0 - noise / equations));
    let total = within * (1.0 - noise / equations) + mean;
    if total > 0.0 { (1.0 - within / total).clamp(0.0, MOST) } else { MOST }
}

/// How readings and poses scatter; `None` where too few poses are repeated.
#[must_use]
pub fn scatter(poses: &[Readings], used: Used) -> Option<Scatter> {
    if poses.iter().filter(|p| p.ncols() > 1).count() < ENOUGH {
        return None;
    }
    let Sums { within, freedom, between, equations, noise } = Sums::of(poses);
    let within = within / (freedom - used.apart).max(1.0);
    let between = between / (equations - used.means).max(1.0) - within * noise / equations;
    Some(Scatter { within, between })
}

/// Sums over poses.
#[derive(Default)]
struct Sums {
    /// Squares of readings about the mean of their pose.
    within: f64,
    /// Equations of these that are independent.
    freedom: f64,
    /// Squares of the means.
    between: f64,
    /// Equations of the means.
    equations: f64,
    /// Of each of these, one over how many readings it is the mean of.
    noise: f64,
}

impl Sums {
    fn of(poses: &[Readings]) -> Self {
        let mut sums = Self::default();
        for pose in poses {
            let (m, r) = (pose.nrows() as f64, pose.ncols() as f64);
            let mean = pose.column_mean();
            sums.within += pose.column_iter().map(|x| (x - &mean).norm_squared()).sum::<f64>();
            sums.freedom += m * (r - 1.0);
            sums.between += mean.norm_squared();
            sums.equations += m;
            sums.noise += m / r;
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// On both sides of [`ENOUGH`], and whatever the share: of a few repeats it is taken to be
    /// less extreme than it is, by no more than a few equations of [`USUAL`] make it.
    #[test]
    fn few_repeats_tell_the_share_as_many_do() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut noise = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
        for share in [0.0, 0.5, 0.8, 0.95_f64] {
            for (repeated, off) in
                [(1, 0.4), (2, 0.25), (5, 0.13), (9, 0.11), (10, 0.11), (30, 0.07)]
            {
                let mean = (0..300).map(|_| {
                    let mut pose = |k: usize| {
                        let common = [(); 3].map(|()| share.sqrt() * noise());
                        let readings = if k < repeated { 3 } else { 1 };
                        DMatrix::from_fn(3, readings, |e, _| {
                            common[e] + (1.0 - share).sqrt() * noise()
                        })
                    };
                    let poses: Vec<Readings> = (0..40).map(&mut pose).collect();
                    common_share(&poses, Used::default())
                });
                let mean = mean.sum::<f64>() / 300.0;
                assert!((mean - share).abs() < off, "{repeated}: {mean} for {share}");
            }
        }
    }

    #[test]
    fn the_share_is_found() {
        let mut state = 1_u64;
        let mut noise = || {
            let sum: f64 = (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 11) as f64 / (1_u64 << 53) as f64
                })
                .sum();
            sum - 6.0
        };
        let mut pose = |_| {
            let common: Vec<f64> = (0..3).map(|_| 2.0 * noise()).collect();
            DMatrix::from_fn(3, 3, |e, _| common[e] + noise())
        };
        let poses: Vec<Readings> = (0..400).map(&mut pose).collect();
        assert!((common_share(&poses, Used::default()) - 0.8).abs() < 0.03);
        let single: Vec<Readings> = poses.iter().map(|p| p.columns(0, 1).into_owned()).collect();
        assert_eq!(common_share(&single, Used::default()), 0.0);
    }
}
