//! Noise that is larger one way: beside the same variance along every axis of a row, some
//! along directions that the row knows (the way a joint moves the target). With `V = I + v a a'`
//! rows are multiplied by `V^-1/2 = I - c a a'`, and the formulas for independent noise hold
//! (Searle, Casella and McCulloch, Variance Components, 1992, 6.2: maximum likelihood).

use nalgebra::{DMatrix, DVector};

use super::tails::{Rest, TAILS, Tails};

/// Ratios tried a factor of ten, and from where to where, of what `a' a` is on the average.
const STEPS: usize = 8;
const FROM: f64 = 1e-2;
const TO: f64 = 1e4;
/// Share of the noise of several directions below which there is none along one.
const FLAT: f64 = 1e-9;

/// A row, as this noise sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// `a' a`.
    pub square: f64,
    /// Square of the residual along a.
    pub along: f64,
    /// Square of the residual across it.
    pub across: f64,
    /// Equations of the row.
    pub equations: usize,
}

impl Seen {
    /// Of a row whose direction and residual these are.
    #[must_use]
    pub fn of(a: &DVector<f64>, residual: &DVector<f64>) -> Self {
        let square = a.norm_squared();
        let along = if square > 0.0 { a.dot(residual).powi(2) / square } else { 0.0 };
        let across = (residual.norm_squared() - along).max(0.0);
        Self { square, along, across, equations: residual.len() }
    }

    /// Of a row that is as noisy along several directions: along the axes of what they make
    /// together.
    #[must_use]
    pub fn each(ways: &DMatrix<f64>, residual: &DVector<f64>) -> Vec<Self> {
        if ways.ncols() == 1 {
            return vec![Self::of(&ways.column(0).into(), residual)];
        }
        let eigen = (ways.transpose() * ways).symmetric_eigen();
        let least = FLAT * eigen.eigenvalues.sum();
        let along = |k: usize| match eigen.eigenvalues[k] > least {
            true => Self::of(&(ways * eigen.eigenvectors.column(k)), residual),
            // Nothing but rounding.
            false => Self { square: 0.0, along: 0.0, across: 0.0, equations: 0 },
        };
        let mut all: Vec<Self> = (0..ways.ncols()).map(along).collect();
        let rest = residual.norm_squared() - all.iter().map(|seen| seen.along).sum::<f64>();
        for (k, seen) in all.iter_mut().enumerate() {
            seen.across = if k == 0 { rest.max(0.0) } else { 0.0 };
            seen.equations = if k == 0 { residual.len() } else { 0 };
        }
        all
    }

    /// Log likelihood of rows, whose other variance is what fits best.
    #[must_use]
    pub fn log_likelihood(rows: &[Self], ratio: f64) -> f64 {
        let (mut rest, mut log_det, mut equations) = (0.0, 0.0, 0);
        for row in rows {
            let larger = 1.0 + ratio * row.square;
            rest += row.across + row.along / larger;
            log_det += larger.ln();
            equations += row.equations;
        }
        let n = equations.max(1) as f64;
        -0.5 * (n * (rest / n).max(f64::MIN_POSITIVE).ln() + log_det)
    }
}

/// The most probable ratio v of the variance along a to that of every axis; 0 where there is
/// no more along it than across.
#[must_use]
pub fn ratio(rows: &[Seen]) -> f64 {
    let mean = rows.iter().map(|r| r.square).sum::<f64>() / rows.len().max(1) as f64;
    if mean <= 0.0 {
        return 0.0;
    }
    let decades = (TO / FROM).log10();
    let count = (decades * STEPS as f64) as usize;
    let tried = (0..=count).map(|k| FROM * 10_f64.powf(k as f64 / STEPS as f64) / mean);
    let rated = std::iter::once(0.0).chain(tried);
    let rated = rated.map(|ratio| (ratio, Seen::log_likelihood(rows, ratio)));
    rated.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |best| best.0)
}

/// The variance of every axis that fits best beside this ratio.
#[must_use]
pub fn other_variance(rows: &[Seen], ratio: f64) -> f64 {
    let rest = rows.iter().map(|row| row.across + row.along / (1.0 + ratio * row.square));
    let equations: usize = rows.iter().map(|row| row.equations).sum();
    rest.sum::<f64>() / equations.max(1) as f64
}

/// By how much, in nats, a variance along a of that size makes rows less likely than none, the
/// other variance and its tails the likeliest in both.
#[must_use]
pub fn less_likely(rows: &[Seen], variance: f64) -> f64 {
    let largest = other_variance(rows, 0.0).max(f64::MIN_POSITIVE);
    let tried = (0..=4 * STEPS).map(|k| largest * 10_f64.powf(-(k as f64) / STEPS as f64));
    let others: Vec<(Tails, f64)> =
        tried.flat_map(|own| TAILS.map(|nu| (Tails { nu, scale: own.sqrt() }, own))).collect();
    let likeliest = |variance: f64| {
        let with = |(tails, own): &(Tails, f64)| {
            let larger = |row: &Seen| 1.0 + variance / own * row.square;
            let rest = |row: &Seen| {
                let square = row.across + row.along / larger(row);
                Rest { square, equations: row.equations, count: 1.0 }
            };
            let log_det: f64 = rows.iter().map(|row| larger(row).ln()).sum();
            let rests: Vec<Rest> = rows.iter().map(rest).collect();
            tails.log_likelihood(&rests, 1.0) - 0.5 * log_det
        };
        others.iter().map(with).fold(f64::NEG_INFINITY, f64::max)
    };
    likeliest(0.0) - likeliest(variance)
}

/// Multiplies the equations of a row by `V^-1/2`.
pub fn whiten(block: &mut DMatrix<f64>, a: &DVector<f64>, ratio: f64) {
    let square = a.norm_squared();
    if square <= 0.0 || ratio <= 0.0 {
        return;
    }
    let less = (1.0 - (1.0 + ratio * square).sqrt().recip()) / square;
    for mut column in block.column_iter_mut() {
        let by = less * column.dot(a);
        column.axpy(-by, a, 1.0);
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
        fn whitening_undoes_it(
            a in prop::collection::vec(-3.0..3.0_f64, 1..7), ratio in 0.0..1e4_f64,
        ) {
            let a = DVector::from_vec(a);
            let n = a.len();
            let v = DMatrix::identity(n, n) + &a * a.transpose() * ratio;
            let mut w = DMatrix::identity(n, n);
            whiten(&mut w, &a, ratio);
            let left = (&w * v * w.transpose() - DMatrix::identity(n, n)).amax();
            prop_assert!(left < 1e-9 * (1.0 + ratio), "{left}");
        }
    }

    /// A variance that rows have is likely, one that they have not is not, and both the more, the
    /// more rows; one that is far out is no scatter.
    #[test]
    fn what_rows_do_not_scatter_is_unlikely() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut normal =
            |k: f64| k * ((0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0);
        let mut rows = |truth: f64, count: usize| -> Vec<Seen> {
            let row = |_| {
                let a = DVector::from_fn(3, |_, _| normal(1.0));
                let much = normal(f64::sqrt(truth));
                Seen::of(&a, &(&a * much + DVector::from_fn(3, |_, _| normal(1.0))))
            };
            (0..count).map(row).collect()
        };
        for count in [30, 300] {
            let much = f64::from(count) / 10.0;
            assert!(less_likely(&rows(0.0, count as usize), 4.0) > much);
            assert!(less_likely(&rows(4.0, count as usize), 4.0) < -much);
            let mut far = rows(0.0, count as usize);
            far[0].along = 1e4;
            assert!(less_likely(&far, 4.0) > much - 10.0);
        }
        assert!(less_likely(&rows(0.0, 300), 1e-6).abs() < 0.1);
    }

    /// The ratio comes back, none where there is none.
    #[test]
    fn the_ratio_is_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for truth in [0.0, 0.3, 4.0, 100.0] {
            let mut normal =
                |k: f64| k * ((0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0);
            let row = |_| {
                let a = DVector::from_fn(3, |_, _| normal(1.0));
                let much = normal(f64::sqrt(truth));
                let residual = &a * much + DVector::from_fn(3, |_, _| normal(1.0));
                Seen::of(&a, &(residual * 0.2))
            };
            let rows: Vec<Seen> = (0..4000).map(row).collect();
            let found = ratio(&rows);
            assert!((found - truth).abs() < 0.02 + 0.2 * truth, "{truth}: {found}");
        }
        assert_eq!(ratio(&[]), 0.0);
    }
}
