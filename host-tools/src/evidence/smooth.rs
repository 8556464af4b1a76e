//! Smooth periodic functions of an angle: how smooth and how large they are is
//! chosen by the evidence.
//!
//! A function with a squared-exponential covariance of length l over a turn is
//! a Fourier series whose coefficients are independent, of variance
//! `size^2 w_n`, `w_n` in proportion to `exp(-(n l)^2 / 2)` (Rasmussen and Williams, Gaussian
//! Processes for Machine Learning, 4.2 and appendix B). With S and t what the
//! rest of the model leaves of the columns, `D` the prior deviations and
//! `B = I + D S D`, the evidence is that of [`super::Subsets`].

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::noise::Noise;
use super::projected::Projected;
use super::triangular::{cholesky, solve_lower};

/// Lengths of the covariance, rad: 2.5 degrees and longer. Shorter ones do not fit a table
/// of 256 nodes.
pub const LENGTHS: [f64; 5] = [0.0436, 0.0698, 0.1117, 0.1787, 0.2859];
/// Standard deviations of a function, rad: those of arms are 0.1 to 0.5 mrad.
pub const SIZES: [f64; 7] = [2e-5, 4e-5, 8e-5, 1.6e-4, 3.2e-4, 6.4e-4, 1.28e-3];
/// Ways to be a curve: the best is taken of so many, which is a price.
pub const PRIORS: usize = LENGTHS.len() * SIZES.len();
/// Orders whose variance is below this share of the first one's are left out.
const CUT: f64 = 1e-4;
/// Times that each function is chosen again, the others as they are.
pub(super) const SWEEPS: usize = 3;
/// Precision of columns that are only beside, as a share of their own square.
const BESIDE: f64 = 1e-6;

/// A prior of a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Length of its covariance, rad.
    pub length: f64,
    /// Its standard deviation, rad.
    pub size: f64,
}

/// Orders of a function of this length.
#[must_use]
pub fn orders(length: f64) -> usize {
    ((-2.0 * CUT.ln()).sqrt() / length).floor().max(1.0) as usize
}

impl Prior {
    /// Variance of cosine and sine of each order, 1, 1, 2, 2, ...
    #[must_use]
    pub fn variances(&self) -> Vec<f64> {
        let weight = |n: usize| (-(n as f64 * self.length).powi(2) / 2.0).exp();
        let orders = orders(self.length);
        let all: f64 = (1..=orders).map(weight).sum();
        let square = self.size * self.size / all;
        (1..=orders).flat_map(|n| [square * weight(n); 2]).collect()
    }
}

/// Values of cosine and sine of so many orders at an angle, one turned by it into the next.
#[must_use]
pub fn basis(orders: usize, angle: f64) -> Vec<f64> {
    let (sin, cos) = angle.sin_cos();
    let mut out = Vec::with_capacity(2 * orders);
    let mut now = [cos, sin];
    for _ in 0..orders {
        out.extend(now);
        now = [now[0] * cos - now[1] * sin, now[1] * cos + now[0] * sin];
    }
    out
}

/// Which of several functions the data hold, and how smooth and large: columns of each
/// in turn, `orders` cosines and sines each, behind `beside` columns that are in
/// the model whatever comes. `odds` is the log prior odds of a function of one prior.
#[must_use]
pub fn choose(
    projected: &Projected,
    (beside, orders): (usize, usize),
    odds: f64,
) -> Vec<Option<Prior>> {
    let functions = (projected.b.len() - beside) / (2 * orders);
    let mut chosen: Vec<Option<Prior>> = vec![None; functions];
    for _ in 0..SWEEPS {
        let before = chosen.clone();
        for k in 0..functions {
            let left = Left::by_others(projected, (beside, orders), &chosen, k);
            let (prior, evidence) = left.best(orders);
            chosen[k] = (odds + evidence > left.evidence(&[])).then_some(prior);
        }
        if chosen == before {
            break;
        }
    }
    chosen
}

/// What a model without a function leaves of its columns.
pub(super) struct Left {
    s: DMatrix<f64>,
    t: DVector<f64>,
    noise: Noise,
    /// Squares that it leaves of the residual.
    squares: f64,
}

impl Left {
    /// By a model of these columns, and no more.
    pub fn by(projected: &Projected, columns: Vec<usize>, own: &[usize]) -> Self {
        let precision = columns.iter().map(|k| beside_precision(projected, *k)).collect();
        Self::new(projected, &Rest::of(projected, columns, precision), own)
    }

    /// By what stands beside, and all functions but this one.
    pub fn by_others(
        projected: &Projected,
        (beside, orders): (usize, usize),
        chosen: &[Option<Prior>],
        k: usize,
    ) -> Self {
        let rest = Rest::new(projected, beside, orders, chosen, k);
        let first = beside + 2 * orders * k;
        Self::new(projected, &rest, &(first..first + 2 * orders).collect::<Vec<_>>())
    }

    fn new(projected: &Projected, rest: &Rest, own: &[usize]) -> Self {
        let (s, t) = rest.leave(projected, own);
        Self { s, t, noise: projected.noise, squares: projected.s - rest.explained }
    }

    /// Log evidence with these columns, each of such a variance.
    #[must_use]
    pub fn evidence(&self, columns: &[(usize, f64)]) -> f64 {
        let (det, more) = explained(&self.s, &self.t, columns);
        self.noise.log_evidence(self.squares - more) - 0.5 * det
    }

    /// The prior of up to so many orders with the highest evidence, and that.
    #[must_use]
    pub fn best(&self, orders: usize) -> (Prior, f64) {
        let lengths = LENGTHS.into_iter().filter(|length| self::orders(*length) <= orders);
        let priors: Vec<Prior> =
            lengths.flat_map(|length| SIZES.map(|size| Prior { length, size })).collect();
        let of = |prior: &Prior| {
            let columns: Vec<_> = prior.variances().into_iter().enumerate().collect();
            (*prior, self.evidence(&columns))
        };
        let all: Vec<(Prior, f64)> = priors.par_iter().map(of).collect();
        let none =
            (Prior { length: LENGTHS[LENGTHS.len() - 1], size: SIZES[0] }, f64::NEG_INFINITY);
        all.into_iter().fold(none, |best, one| if one.1 > best.1 { one } else { best })
    }
}

/// `log |B|` and what a function of these columns and variances explains.
fn explained(s: &DMatrix<f64>, t: &DVector<f64>, columns: &[(usize, f64)]) -> (f64, f64) {
    let columns: Vec<(usize, f64)> =
        columns.iter().filter(|(k, _)| *k < t.len()).map(|(k, v)| (*k, v.sqrt())).collect();
    let n = columns.len();
    let mut b = DMatrix::from_fn(n, n, |i, j| {
        let ((row, d), (column, e)) = (columns[i], columns[j]);
        d * s[(row, column)] * e
    });
    (0..n).for_each(|i| b[(i, i)] += 1.0);
    let Some(factor) = cholesky(b) else { return (f64::INFINITY, 0.0) };
    let l = factor.l_dirty();
    let det = 2.0 * l.diagonal().iter().map(|x| x.ln()).sum::<f64>();
    let right = DVector::from_fn(n, |i, _| columns[i].1 * t[columns[i].0]);
    (det, l.solve_lower_triangular(&right).map_or(0.0, |v| v.norm_squared()))
}

/// Precision of a column that is only beside.
fn beside_precision(projected: &Projected, column: usize) -> f64 {
    (BESIDE * projected.c[(column, column)]).max(f64::MIN_POSITIVE)
}

/// The model without one function.
struct Rest {
    columns: Vec<usize>,
    factor: Option<nalgebra::Cholesky<f64, nalgebra::Dyn>>,
    right: DVector<f64>,
    explained: f64,
}

impl Rest {
    fn new(
        projected: &Projected,
        beside: usize,
        orders: usize,
        chosen: &[Option<Prior>],
        without: usize,
    ) -> Self {
        let mut columns: Vec<usize> = (0..beside).collect();
        let mut precision: Vec<f64> =
            columns.iter().map(|k| beside_precision(projected, *k)).collect();
        for (k, prior) in chosen.iter().enumerate().filter(|(k, _)| *k != without) {
            let own = prior.map_or(Vec::new(), |prior| prior.variances());
            let first = beside + 2 * orders * k;
            columns.extend(first..first + own.len());
            precision.extend(own.iter().map(|variance| 1.0 / variance));
        }
        Self::of(projected, columns, precision)
    }

    /// Of these columns under such a prior.
    fn of(projected: &Projected, columns: Vec<usize>, precision: Vec<f64>) -> Self {
        let c = &projected.c;
        let n = columns.len();
        let mut a = DMatrix::from_fn(n, n, |i, j| c[(columns[i], columns[j])]);
        precision.iter().enumerate().for_each(|(i, p)| a[(i, i)] += p);
        let b = DVector::from_fn(n, |i, _| projected.b[columns[i]]);
        let factor = cholesky(a);
        let right = factor.as_ref().and_then(|f| f.l_dirty().solve_lower_triangular(&b));
        let right = right.unwrap_or_else(|| DVector::zeros(n));
        Self { columns, factor, explained: right.norm_squared(), right }
    }

    /// What it leaves of some columns: S and t.
    fn leave(&self, projected: &Projected, own: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let count = own.len();
        let mut s = DMatrix::from_fn(count, count, |i, j| projected.c[(own[i], own[j])]);
        let mut t = DVector::from_fn(count, |i, _| projected.b[own[i]]);
        let Some(factor) = &self.factor else { return (s, t) };
        if self.columns.is_empty() {
            return (s, t);
        }
        let mut w = DMatrix::from_fn(self.columns.len(), count, |i, j| {
            projected.c[(self.columns[i], own[j])]
        });
        solve_lower(factor.l_dirty(), &mut w);
        let wt = w.transpose();
        s.gemm(-1.0, &wt, &w, 1.0);
        t.gemv(-1.0, &wt, &self.right, 1.0);
        (s, t)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::evidence::Gram;

    pub(in crate::evidence) fn normal(rng: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
    }

    /// What is chosen for two functions of two angles, the first of this prior and
    /// the second not there, seen in noise of 1e-4.
    fn chosen(truth: Option<Prior>, seed: u64) -> Vec<Option<Prior>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let most = orders(LENGTHS[1]);
        let mut coefficients = vec![0.0; 2 * most];
        let variances = truth.map_or(Vec::new(), |prior| prior.variances());
        for (k, variance) in variances.into_iter().enumerate() {
            coefficients[k] = variance.sqrt() * normal(&mut rng);
        }
        let (rows, noise) = (900, 1e-4);
        let mut gram = Gram::new(1, 4 * most);
        let z: Vec<Vec<f64>> = (0..rows)
            .map(|_| (0..2).flat_map(|_| basis(most, rng.random_range(-3.0..3.0))).collect())
            .collect();
        let value = |row: &Vec<f64>| row.iter().zip(&coefficients).map(|(b, c)| b * c).sum::<f64>();
        let y = DVector::from_fn(rows, |i, _| (1e-3 + value(&z[i])) / noise + normal(&mut rng));
        let z = DMatrix::from_fn(rows, 4 * most, |i, j| z[i][j] / noise);
        gram.add(&DMatrix::from_element(rows, 1, 1.0), &z, &y);
        let projected = gram.project(&gram.geometry(&DVector::from_element(1, 1e-6), 1.0));
        choose(&projected, (0, most), -4.0)
    }

    #[test]
    fn variances_are_those_of_the_function() {
        for length in LENGTHS {
            let prior = Prior { length, size: 3e-4 };
            let half: f64 = prior.variances().iter().sum::<f64>() / 2.0;
            assert!((half.sqrt() / 3e-4 - 1.0).abs() < 1e-9);
            assert_eq!(prior.variances().len(), 2 * orders(length));
        }
    }

    #[test]
    fn values_are_those_of_each_order() {
        for k in 0..200 {
            let angle = 0.1 * k as f64 - 10.0;
            for (n, pair) in (1..).zip(basis(98, angle).chunks_exact(2)) {
                let (sin, cos) = (n as f64 * angle).sin_cos();
                assert!((pair[0] - cos).abs() < 1e-12 && (pair[1] - sin).abs() < 1e-12, "{n}");
            }
        }
    }

    #[test]
    fn a_function_is_found_with_its_size_and_length_and_none_where_none_is() {
        let mut wrong = 0;
        for seed in 0..10 {
            assert_eq!(chosen(None, seed), [None, None], "seed {seed}");
            let truth = Prior { length: LENGTHS[1 + seed as usize % 3], size: 1.6e-4 };
            let found = chosen(Some(truth), 100 + seed);
            assert_eq!(found[1], None, "seed {seed}");
            let Some(first) = found[0] else {
                panic!("a curve of 1.6 noise floors, seed {seed}: {found:?}")
            };
            assert!((first.size / truth.size).ln().abs() < 1.0, "seed {seed}: {first:?}");
            wrong += usize::from((first.length / truth.length).ln().abs() > 0.6);
        }
        assert!(wrong <= 1, "{wrong} of 10 lengths");
    }
}
