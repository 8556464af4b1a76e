//! Geometry, as the rows and its prior have it at a noise scale: what candidates are
//! projected off.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::fixed_point::fixed_point;
use super::gram::Gram;
use super::noise::{Noise, Spent};
use super::triangular::{cholesky, inverse_lower, solve_lower};

/// Rounds in which the noise scale of geometry is found at most: of thirteen poses read ten times
/// each five rounds left 20 times what there is, and that is where a search began...
const MOST_ROUNDS: usize = 60;
/// ...and its change, as a share, that is none: a search finds it again from there.
const SETTLED: f64 = 1e-3;
/// First addition to the diagonal of a scaled matrix that has no Cholesky
/// factor for rounding; grows tenfold until there is one.
const JITTER: f64 = 1e-14;

/// Geometry at one noise scale k: the Cholesky factor of `G'G / k^2 + Lambda`.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// What the columns are divided by before the factorisation.
    unit: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    /// Noise scale k.
    pub(super) scale: f64,
    /// Equations that geometry uses up: `tr(G H^-1 G') / k^2`.
    pub freedom: f64,
    /// What it is off its nominal by where nothing else is, in squares of its prior.
    prior: f64,
}

impl Gram {
    /// Geometry at noise scale k under a prior of this precision (diagonal).
    #[must_use]
    pub fn geometry(&self, precision: &DVector<f64>, scale: f64) -> Geometry {
        let k2 = scale * scale;
        let mut h = &self.gg / k2;
        for i in 0..h.nrows() {
            h[(i, i)] += precision[i];
        }
        let unit = h.diagonal().map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
        let seen: Vec<bool> = h.diagonal().iter().map(|d| *d > 0.0).collect();
        for (mut column, unit_of_column) in h.column_iter_mut().zip(unit.iter()) {
            column /= *unit_of_column;
            column.component_div_assign(&unit);
        }
        let factor = factor(h);
        // tr(H^-1 G'G / k^2) is what the prior does not decide.
        let inverse = inverse_lower(factor.l_dirty());
        let own = |i: usize| precision[i] / (unit[i] * unit[i]) * inverse.column(i).norm_squared();
        let freedom = (0..unit.len()).filter(|i| seen[*i]).map(|i| 1.0 - own(i)).sum();
        let mut geometry = Geometry { unit, factor, scale, freedom, prior: 0.0 };
        let off = geometry.mean(self, &DVector::zeros(self.columns()));
        geometry.prior = off.iter().zip(precision.iter()).map(|(x, p)| p * x * x).sum();
        geometry
    }

    /// What its equations say of the noise beside a geometry.
    #[must_use]
    pub fn noise(&self, geometry: &Geometry) -> Noise {
        let repeats = self.repeats.over(geometry.scale * geometry.scale);
        Noise::new(self.equations, &repeats, geometry.spent())
    }

    /// Noise scale that geometry alone leaves.
    #[must_use]
    pub fn scale_of_geometry(&self, precision: &DVector<f64>) -> f64 {
        let from = (self.yy / self.equations.max(1) as f64).sqrt().max(f64::MIN_POSITIVE);
        fixed_point(from, SETTLED, MOST_ROUNDS, &mut |k| {
            let geometry = self.geometry(precision, k);
            let vy = geometry
                .factor
                .l_dirty()
                .solve_lower_triangular(&self.gy.component_div(&geometry.unit).unscale(k * k));
            let rest = self.yy - vy.map_or(0.0, |v| v.norm_squared()) * k * k;
            let Spent { freedom, prior } = geometry.spent();
            let spent = Spent { freedom, prior: prior * k * k };
            let noise = Noise::new(self.equations, &self.repeats, spent);
            (noise.own(rest) / noise.freedom).sqrt().max(1e-9 * k)
        })
    }
}

impl Geometry {
    /// What geometry most probably is where the candidates' columns have these
    /// coefficients: `H^-1 G'(y - Z w) / k^2`.
    #[must_use]
    pub fn mean(&self, gram: &Gram, columns: &DVector<f64>) -> DVector<f64> {
        let right = (&gram.gy - &gram.gz * columns) / (self.scale * self.scale);
        self.factor.solve(&right.component_div(&self.unit)).component_div(&self.unit)
    }

    fn spent(&self) -> Spent {
        Spent { freedom: self.freedom, prior: self.prior }
    }

    /// How many unknowns there are.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unit.len()
    }

    /// Log evidence of some unknowns that are not held at nothing, all else
    /// adjusted, at this noise scale: by Savage and Dickey, the posterior over the
    /// prior density there (Verdinelli and Wasserman, JASA 90 (1995) 614).
    #[must_use]
    pub fn worth(&self, precision: &DVector<f64>, mean: &DVector<f64>, of: Range<usize>) -> f64 {
        let n = of.len();
        let mut unit = DMatrix::zeros(self.unit.len(), n);
        of.clone().enumerate().for_each(|(j, i)| unit[(i, j)] = 1.0 / self.unit[i]);
        // H^-1 = L^-T L^-1.
        solve_lower(self.factor.l_dirty(), &mut unit);
        let cov = unit.transpose() * &unit;
        let mean = mean.rows(of.start, n).into_owned();
        let Some(factor) = cov.cholesky() else { return f64::INFINITY };
        let det: f64 = 2.0 * factor.l_dirty().diagonal().iter().map(|x| x.ln()).sum::<f64>();
        let prior: f64 = of.map(|i| precision[i].ln()).sum();
        0.5 * (mean.dot(&factor.solve(&mean)) + det + prior)
    }

    /// `log |G'G / k^2 + Lambda|`.
    #[must_use]
    pub fn log_det(&self) -> f64 {
        let diagonal = self.factor.l_dirty().diagonal();
        2.0 * diagonal.iter().zip(&self.unit).map(|(l, unit)| (l * unit).ln()).sum::<f64>()
    }

    /// Variances of linear functions of the unknowns, a column each.
    #[must_use]
    pub fn variances(&self, mut of: DMatrix<f64>) -> Vec<f64> {
        of.column_iter_mut().for_each(|mut column| column.component_div_assign(&self.unit));
        solve_lower(self.factor.l_dirty(), &mut of);
        of.column_iter().map(|column| column.norm_squared()).collect()
    }

    /// `L^-1 G'Z / k^2` from `G'Z`: the part of columns that geometry can
    /// imitate, in coordinates whose scalar product is the projection's.
    #[must_use]
    pub fn whiten(&self, products: &DMatrix<f64>) -> DMatrix<f64> {
        let k2 = self.scale * self.scale;
        let mut out = products.clone();
        for mut column in out.column_iter_mut() {
            column.component_div_assign(&self.unit);
            column /= k2;
        }
        solve_lower(self.factor.l_dirty(), &mut out);
        out
    }
}

/// Cholesky factor of a matrix with unit diagonal that is singular only by
/// rounding.
fn factor(matrix: DMatrix<f64>) -> Cholesky<f64, Dyn> {
    let mut jitter = JITTER;
    loop {
        let mut lifted = matrix.clone();
        for i in 0..lifted.nrows() {
            // Not a number would never get a factor: it is left out.
            let finite = lifted[(i, i)].is_finite();
            lifted[(i, i)] = if finite { lifted[(i, i)] + jitter } else { 1.0 };
        }
        if let Some(factor) = cholesky(lifted) {
            return factor;
        }
        jitter *= 10.0;
        if jitter > 1e3 {
            return Cholesky::pack_dirty(DMatrix::identity(matrix.nrows(), matrix.nrows()));
        }
    }
}
