//! Repeats of a pose: part of the noise is common to them, and no number of
//! repeats averages it away. With share h of the variance common to a pose,
//! `V = (1 - h) I + h 11'`, rows, geometry and candidates of the pose are all
//! multiplied by `V^-1/2` and the formulas for independent noise hold (the
//! random-effects transformation; Baltagi, Econometric Analysis of Panel Data,
//! 2.3). Structure that no candidate explains is common to repeats too, so that
//! it cannot pass for many rows' evidence.

use nalgebra::{DMatrix, DVector};

use crate::statistics::repeats::{ENOUGH, MOST};

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

/// Equations that tell how readings scatter by themselves, at least.
const TELLING: usize = 12;
/// Columns that explain so many times what as many of chance do are an effect.
const NOT_YET: f64 = 5.0;
/// Columns that others do are no columns: share of their square that is left of them.
const ALIKE: f64 = 1e-9;
/// Nor are those that differ between readings by less than this share of what they are: where an
/// instrument's sight scatters, each reading is whitened along its own, which noise turns.
const DIFFERS: f64 = 1e-3;

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
    /// Poses that are repeated.
    poses: usize,
    /// Products of what may differ between readings of a pose, about their mean, their
    /// residual behind them.
    within: DMatrix<f64>,
    /// Squares of the same, their mean among them.
    whole: DVector<f64>,
}

impl Repeats {
    /// Of one pose, of whose variance its readings have a share in common, for
    /// [`super::Gram::add_repeats`]: the whitened columns of what may differ between its
    /// readings, and behind them the whitened residual.
    #[must_use]
    pub fn of(mut columns: DMatrix<f64>, repeats: usize, share: f64) -> Self {
        let (repeats, h) = (repeats.max(1), share.clamp(0.0, MOST));
        let m = columns.nrows() / repeats;
        let squares = columns.column_iter().map(|column| column.norm_squared());
        let whole = DVector::from_iterator(columns.ncols(), squares);
        centre(&mut columns, repeats);
        Self {
            equations: m * (repeats - 1),
            square: columns.column(columns.ncols() - 1).norm_squared(),
            least: m as f64 * (1.0 - h) / (1.0 - h + repeats as f64 * h),
            poses: usize::from(repeats > 1),
            within: columns.tr_mul(&columns),
            whole,
        }
    }

    /// Mean square of an equation that repeats, without what differs between readings for a
    /// reason that may be: the side that a joint came from, a drift, the temperature. 0 where
    /// too few poses are repeated, and as long as such a reason is not in the model yet: what
    /// repeats say of it is evidence, and no noise.
    #[must_use]
    pub fn each(&self) -> f64 {
        // Where nothing is looked for nobody knows for what reason readings differ.
        let count = self.within.ncols().saturating_sub(1);
        if count == 0 || self.poses < ENOUGH {
            return 0.0;
        }
        let unit = |k: usize| self.within[(k, k)].sqrt();
        let differs = |k: &usize| unit(*k) > DIFFERS * self.whole[*k].sqrt();
        let own: Vec<usize> = (0..count).filter(differs).collect();
        let (rank, explained) = self.explained(&own, &unit);
        let left = self.equations.saturating_sub(rank);
        if left < TELLING {
            return 0.0;
        }
        let each = (self.within[(count, count)] - explained).max(0.0) / left as f64;
        if explained > NOT_YET * rank as f64 * each { 0.0 } else { each }
    }

    /// How many independent columns there are among these, over their units, and what they
    /// explain of the squares of the residual.
    fn explained(&self, own: &[usize], unit: &dyn Fn(usize) -> f64) -> (usize, f64) {
        if own.is_empty() {
            return (0, 0.0);
        }
        let last = self.within.ncols() - 1;
        let of = |i: usize, j: usize| self.within[(own[i], own[j])] / (unit(own[i]) * unit(own[j]));
        let eigen = DMatrix::from_fn(own.len(), own.len(), of).symmetric_eigen();
        let right = DVector::from_fn(own.len(), |i, _| self.within[(own[i], last)] / unit(own[i]));
        let pairs = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
        let told = pairs.filter(|(value, _)| **value > ALIKE);
        told.fold((0, 0.0), |(rank, sum), (value, vector)| {
            (rank + 1, sum + vector.dot(&right).powi(2) / value)
        })
    }

    /// With those of other poses.
    pub fn join(&mut self, other: &Self) {
        self.equations += other.equations;
        self.square += other.square;
        self.least += other.least;
        self.poses += other.poses;
        match self.within.is_empty() {
            true => (self.within, self.whole) = (other.within.clone(), other.whole.clone()),
            false if other.within.is_empty() => {}
            false => {
                self.within += &other.within;
                self.whole += &other.whole;
            }
        }
    }

    /// At another noise scale.
    #[must_use]
    pub fn over(&self, k2: f64) -> Self {
        Self {
            square: self.square / k2,
            within: &self.within / k2,
            whole: &self.whole / k2,
            ..*self
        }
    }
}

/// Takes the mean of the readings off each equation of a pose.
fn centre(block: &mut DMatrix<f64>, repeats: usize) {
    let m = block.nrows() / repeats;
    for mut column in block.column_iter_mut() {
        for e in 0..m {
            let mean = (0..repeats).map(|r| column[r * m + e]).sum::<f64>() / repeats as f64;
            (0..repeats).for_each(|r| column[r * m + e] -= mean);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

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
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut noise = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
        for (repeats, share) in [(2, 0.5), (3, 0.9), (5, 0.999)] {
            let (mut all, mut apart, mut own) = (Repeats::default(), Repeats::default(), 0.0);
            for _ in 0..4000 {
                let mut block = DMatrix::from_fn(3 * repeats, 1, |_, _| noise());
                whiten(&mut block, repeats, share);
                // What may differ: a side, which has no effect yet.
                let side = DMatrix::from_fn(3 * repeats, 1, |i, _| if i < 3 { 1.0 } else { -1.0 });
                let both = |size: f64| {
                    let mut columns = DMatrix::zeros(3 * repeats, 2);
                    columns.set_column(0, &side.column(0));
                    columns.set_column(1, &(block.column(0) + side.column(0) * size));
                    columns
                };
                let pose = Repeats::of(both(0.0), repeats, share);
                own += block.norm_squared() - pose.square;
                all.join(&pose);
                apart.join(&Repeats::of(both(20.0), repeats, share));
            }
            let least = all.least * all.square / all.equations as f64;
            assert!((own / least - 1.0).abs() < 0.05, "{repeats}, {share}: {own} {least}");
            let each = all.each() / (all.square / all.equations as f64);
            assert!((each - 1.0).abs() < 0.05, "{repeats}: {each}");
            // A side that counts is evidence, until it is in the model.
            assert_eq!(apart.each(), 0.0);
        }
    }

    /// Nine poses read three times among many say nothing of how poses scatter.
    #[test]
    fn few_repeated_poses_tell_no_floor() {
        let mut all = Repeats::default();
        let residual: Vec<f64> = (0..9).map(|k| f64::from(k * 7 % 5) - 2.0).collect();
        for poses in 1..20 {
            let mut columns = DMatrix::zeros(9, 2);
            columns.column_mut(1).copy_from_slice(&residual);
            all.join(&Repeats::of(columns, 3, 0.5));
            assert_eq!(all.each() > 0.0, poses >= ENOUGH, "{poses}");
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
}
