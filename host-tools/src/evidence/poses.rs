//! Repeats of a pose: part of the noise is common to them, and no number of
//! repeats averages it away. With share h of the variance common to a pose,
//! `V = (1 - h) I + h 11'`, rows, geometry and candidates of the pose are all
//! multiplied by `V^-1/2` and the formulas for independent noise hold (the
//! random-effects transformation; Baltagi, Econometric Analysis of Panel Data,
//! 2.3). Structure that no candidate explains is common to repeats too, so that
//! it cannot pass for many rows' evidence.

use nalgebra::DMatrix;

/// Poses with repeats from which on the share is taken from the data.
pub const ENOUGH: usize = 10;
/// Share with fewer of them: 0.037 mm common and 0.018 mm not, of a UR10.
pub const USUAL: f64 = 0.8;
/// Most of the variance that can be common: bit-identical repeats tell nothing
/// and are one row.
const MOST: f64 = 0.999;

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

/// Share of the variance that is common to the readings of a pose, from the
/// residuals of all poses; `used` equations were used up by the fit.
#[must_use]
pub fn common_share(poses: &[Readings], used: f64) -> f64 {
    if poses.iter().all(|p| p.ncols() < 2) {
        return 0.0;
    }
    match scatter(poses, used) {
        None => USUAL,
        Some(Scatter { within, between }) if within + between <= 0.0 => MOST,
        Some(Scatter { within, between }) => (between / (within + between)).clamp(0.0, MOST),
    }
}

/// How readings and poses scatter; `None` where too few poses are repeated.
#[must_use]
pub fn scatter(poses: &[Readings], used: f64) -> Option<Scatter> {
    if poses.iter().filter(|p| p.ncols() > 1).count() < ENOUGH {
        return None;
    }
    let (mut within, mut freedom) = (0.0, 0.0);
    let (mut between, mut equations, mut noise) = (0.0, 0.0, 0.0);
    for pose in poses {
        let (m, r) = (pose.nrows() as f64, pose.ncols() as f64);
        let mean = pose.column_mean();
        within += pose.column_iter().map(|x| (x - &mean).norm_squared()).sum::<f64>();
        freedom += m * (r - 1.0);
        between += mean.norm_squared();
        equations += m;
        noise += m / r;
    }
    let within = within / freedom;
    let between = between / (equations - used).max(1.0) - within * noise / equations;
    Some(Scatter { within, between })
}

/// Multiplies the equations of one pose by `V^-1/2`: `repeats` readings of
/// `block.nrows() / repeats` equations each, one reading after the other.
pub fn whiten(block: &mut DMatrix<f64>, repeats: usize, share: f64) {
    let h = share.clamp(0.0, MOST);
    if repeats < 2 || h == 0.0 {
        return;
    }
    let m = block.nrows() / repeats;
    let own = (1.0 - h).sqrt();
    let alpha = 1.0 - own / (1.0 - h + repeats as f64 * h).sqrt();
    for mut column in block.column_iter_mut() {
        for e in 0..m {
            let readings = (0..repeats).map(|r| column[r * m + e]);
            let mean = readings.sum::<f64>() / repeats as f64;
            for r in 0..repeats {
                let x = &mut column[r * m + e];
                *x = (*x - alpha * mean) / own;
            }
        }
    }
}

/// Share of the poses whose readings scatter least: these tell how readings scatter by
/// themselves, where those of others came from either side of a gap.
const QUIETEST: f64 = 0.25;
/// The same of a normal distribution.
const QUIETEST_DEVIATES: f64 = -0.674_490;

/// What repeats say of the noise, whitened as [`whiten`] does.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Repeats {
    /// Equations that repeat a pose.
    pub equations: usize,
    /// Squares of what they scatter about the mean of their pose.
    pub square: f64,
    /// Squares that the other equations have at least, over those of one that repeats: the
    /// mean of a pose scatters by what its readings do, if by nothing else.
    pub least: f64,
    /// Of each pose that is repeated its mean square, over what one pose in four of equal
    /// noise has.
    quiet: Vec<f64>,
}

impl Repeats {
    /// Of the whitened residuals of one pose, of whose variance its readings have a share in
    /// common; for [`super::Gram::add_repeats`].
    #[must_use]
    pub fn of(residual: &[f64], repeats: usize, share: f64) -> Self {
        let (repeats, h) = (repeats.max(1), share.clamp(0.0, MOST));
        let m = residual.len() / repeats;
        let scatter = (0..m).map(|e| {
            let readings = || (0..repeats).map(|r| residual[r * m + e]);
            let mean = readings().sum::<f64>() / repeats as f64;
            readings().map(|x| (x - mean).powi(2)).sum::<f64>()
        });
        let (equations, square) = (m * (repeats - 1), scatter.sum());
        let freedom = equations.max(1) as f64;
        let quiet = (equations > 0).then(|| square / freedom / quietest(freedom));
        Self {
            equations,
            square,
            least: m as f64 * (1.0 - h) / (1.0 - h + repeats as f64 * h),
            quiet: quiet.into_iter().collect(),
        }
    }

    /// Mean square of an equation that repeats, by the poses whose readings scatter least.
    #[must_use]
    pub fn each(&self) -> f64 {
        if self.quiet.is_empty() {
            return 0.0;
        }
        let mut quiet = self.quiet.clone();
        let place = (quiet.len() as f64 * QUIETEST) as usize;
        let (_, own, _) = quiet.select_nth_unstable_by(place, f64::total_cmp);
        own.min(self.square / self.equations as f64)
    }

    /// With those of other poses.
    pub fn join(&mut self, other: Self) {
        self.equations += other.equations;
        self.square += other.square;
        self.least += other.least;
        self.quiet.extend(other.quiet);
    }

    /// At another noise scale.
    #[must_use]
    pub fn over(&self, k2: f64) -> Self {
        let quiet = self.quiet.iter().map(|square| square / k2).collect();
        Self { square: self.square / k2, quiet, ..*self }
    }
}

/// Mean square of the quietest quarter of so many normal variates each (Wilson and Hilferty,
/// PNAS 17 (1931) 684).
fn quietest(freedom: f64) -> f64 {
    let ninth = 2.0 / (9.0 * freedom);
    (1.0 - ninth + QUIETEST_DEVIATES * ninth.sqrt()).max(0.05).powi(3)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The covariance of what comes out is the identity.
        #[test]
        fn whitening_undoes_the_common_part(
            repeats in 1_usize..6, m in 1_usize..4, share in 0.0..0.99_f64,
        ) {
            let n = repeats * m;
            let mut v = DMatrix::from_fn(n, n, |i, j| {
                let common = if i % m == j % m && repeats > 1 { share } else { 0.0 };
                if i == j { 1.0 } else { common }
            });
            whiten(&mut v, repeats, share);
            let mut v = v.transpose();
            whiten(&mut v, repeats, share);
            prop_assert!((v - DMatrix::identity(n, n)).amax() < 1e-9);
        }
    }

    /// Readings that scatter alone make poses that scatter so.
    #[test]
    fn poses_scatter_as_their_readings_do_at_least() {
        let mut state = 5_u64;
        let mut noise = || {
            let step = |_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(step).sum::<f64>() - 6.0
        };
        for (repeats, share) in [(2, 0.5), (3, 0.9), (5, 0.999)] {
            let (mut all, mut own) = (Repeats::default(), 0.0);
            for _ in 0..4000 {
                let mut block = DMatrix::from_fn(3 * repeats, 1, |_, _| noise());
                whiten(&mut block, repeats, share);
                let pose = Repeats::of(block.as_slice(), repeats, share);
                own += block.norm_squared() - pose.square;
                all.join(pose);
            }
            let least = all.least * all.square / all.equations as f64;
            assert!((own / least - 1.0).abs() < 0.05, "{repeats}, {share}: {own} {least}");
            let each = all.each() / (all.square / all.equations as f64);
            assert!((0.95..=1.0).contains(&each), "{repeats}: the quietest quarter, {each}");
            // Half of the poses were read from both sides of a gap.
            for (k, quiet) in all.quiet.iter_mut().enumerate() {
                *quiet *= if k % 2 == 0 { 1.0 } else { 100.0 };
            }
            all.square *= 50.0;
            let gap = all.each() / (all.square / all.equations as f64) * 50.0;
            assert!((0.8..2.2).contains(&gap), "{repeats}: with a gap, {gap}");
        }
    }

    #[test]
    fn a_pose_read_often_counts_as_little_more_than_one() {
        let information = |repeats: usize| {
            let mut ones = DMatrix::from_element(repeats, 1, 1.0);
            whiten(&mut ones, repeats, 0.8);
            ones.norm_squared()
        };
        assert!((information(1) - 1.0).abs() < 1e-12);
        assert!(information(100) < 1.25);
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
        assert!((common_share(&poses, 0.0) - 0.8).abs() < 0.03);
        assert_eq!(common_share(&poses[..4], 0.0), USUAL);
        let single: Vec<Readings> = poses.iter().map(|p| p.columns(0, 1).into_owned()).collect();
        assert_eq!(common_share(&single, 0.0), 0.0);
    }
}
