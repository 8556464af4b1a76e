//! Products of all columns with each other, accumulated block by block and
//! projected off geometry: all that the evidence of any subset needs of the
//! rows, however many there are.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DMatrixView, DMatrixViewMut, DVector, Dyn};
use rayon::prelude::*;

use super::fixed_point::fixed_point;
use super::noise::{Noise, Spent};
use super::poses::Repeats;
use super::triangular::{cholesky, inverse_lower, solve_lower};

/// Columns a product is computed in at a time; only the lower triangle is.
const BLOCK: usize = 96;
/// Share of a column's square that must survive the projection; below it is
/// the rounding of the projection and the column counts as one of geometry's.
const SEEN: f64 = 1e-8;
/// Rounds in which the noise scale of geometry is found at most: of thirteen poses read ten times
/// each five rounds left 20 times what there is, and that is where a search began...
const MOST_ROUNDS: usize = 60;
/// ...and its change, as a share, that is none: a search finds it again from there.
const SETTLED: f64 = 1e-3;
/// First addition to the diagonal of a scaled matrix that has no Cholesky
/// factor for rounding; grows tenfold until there is one.
const JITTER: f64 = 1e-14;

/// `G'G`, `G'Z`, `Z'Z`, `G'y`, `Z'y` and `y'y` of the equations so far, G the
/// columns of geometry, Z those of the candidates, y the residual; everything
/// over its stated sigma.
#[derive(Debug, Clone)]
pub struct Gram {
    /// Its lower triangle.
    pub(super) gg: DMatrix<f64>,
    pub(super) gz: DMatrix<f64>,
    pub(super) zz: DMatrix<f64>,
    pub(super) gy: DVector<f64>,
    pub(super) zy: DVector<f64>,
    pub(super) yy: f64,
    pub(super) equations: usize,
    pub(super) repeats: Repeats,
}

/// Geometry at one noise scale k: the Cholesky factor of `G'G / k^2 + Lambda`.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// What the columns are divided by before the factorisation.
    unit: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    scale: f64,
    /// Equations that geometry uses up: `tr(G H^-1 G') / k^2`.
    pub freedom: f64,
    /// What it is off its nominal by where nothing else is, in squares of its prior.
    prior: f64,
}

/// Candidates and residual with geometry projected out, in units of the noise
/// scale k: `C = Z'PZ`, `b = Z'Py`, `s = y'Py`, `P = I - G H^-1 G'`.
#[derive(Debug, Clone)]
pub struct Projected {
    /// `Z'PZ`.
    pub c: DMatrix<f64>,
    /// `Z'Py`.
    pub b: DVector<f64>,
    /// `y'Py`.
    pub s: f64,
    /// Diagonal of `Z'Z`, before the projection.
    pub full: DVector<f64>,
    /// How much a sum of squares left over says.
    pub noise: Noise,
    /// Noise scale k that everything is divided by.
    pub scale: f64,
}

impl Projected {
    /// The same without some columns, of which none stands twice.
    #[must_use]
    pub fn without(self, columns: &[usize]) -> Self {
        let mut gone = columns.to_vec();
        gone.sort_unstable();
        Self {
            c: self.c.remove_columns_at(&gone).remove_rows_at(&gone),
            b: self.b.remove_rows_at(&gone),
            full: self.full.remove_rows_at(&gone),
            ..self
        }
    }
}

impl Gram {
    /// Of no equations.
    #[must_use]
    pub fn new(unknowns: usize, columns: usize) -> Self {
        Self {
            gg: DMatrix::zeros(unknowns, unknowns),
            gz: DMatrix::zeros(unknowns, columns),
            zz: DMatrix::zeros(columns, columns),
            gy: DVector::zeros(unknowns),
            zy: DVector::zeros(columns),
            yy: 0.0,
            equations: 0,
            repeats: Repeats::default(),
        }
    }

    /// Adds equations.
    pub fn add(&mut self, g: &DMatrix<f64>, z: &DMatrix<f64>, y: &DVector<f64>) {
        let columns = g.column_iter().chain(z.column_iter()).chain([y.column(0)]);
        self.add_block(&DMatrix::from_columns(&columns.collect::<Vec<_>>()));
    }

    /// Adds equations `[G, Z, y]`. A few hundred at a time are fastest.
    pub fn add_block(&mut self, all: &DMatrix<f64>) {
        let (p, k) = (self.unknowns(), self.columns());
        let (g, z, y) = (all.columns(0, p), all.columns(p, k), all.column(p + k));
        let transposed = all.transpose();
        let (gt, zt) = (transposed.rows(0, p), transposed.rows(p, k));
        lower_product(&mut self.gg, 1.0, gt, g);
        self.gz.gemm(1.0, &gt, &z, 1.0);
        self.gy.gemv(1.0, &gt, &y, 1.0);
        self.zy.gemv(1.0, &zt, &y, 1.0);
        self.yy += y.norm_squared();
        lower_product(&mut self.zz, 1.0, zt, z);
        self.equations += y.len();
    }

    /// Of the equations added some repeat a pose: what they say of the noise, at the best
    /// model known. Where a later one explains part of their scatter, accumulate again with
    /// its residuals.
    pub fn add_repeats(&mut self, repeats: &Repeats) {
        self.repeats.join(repeats);
    }

    /// Equations that do not repeat a pose.
    #[must_use]
    pub fn poses(&self) -> usize {
        self.equations - self.repeats.equations
    }

    /// Adds the equations of another part of the rows.
    pub fn join(&mut self, other: &Self) {
        self.gg += &other.gg;
        self.gz += &other.gz;
        self.zz += &other.zz;
        self.gy += &other.gy;
        self.zy += &other.zy;
        self.yy += other.yy;
        self.equations += other.equations;
        self.add_repeats(&other.repeats);
    }

    /// Unknowns of geometry.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.gy.len()
    }

    /// Columns of candidates.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.zy.len()
    }

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

    /// Everything projected off geometry.
    #[must_use]
    pub fn project(&self, geometry: &Geometry) -> Projected {
        self.projected((geometry, self.noise(geometry)), (&self.gz, &self.zz), &self.zy)
    }

    /// What its equations say of the noise beside a geometry.
    #[must_use]
    pub fn noise(&self, geometry: &Geometry) -> Noise {
        let repeats = self.repeats.over(geometry.scale * geometry.scale);
        Noise::new(self.equations, &repeats, geometry.spent())
    }

    /// Some columns, in this order, projected off geometry; the noise is told apart, as it
    /// takes longer than a few columns do.
    #[must_use]
    pub fn project_some(&self, of: (&Geometry, Noise), columns: &[usize]) -> Projected {
        let gz = self.gz.select_columns(columns);
        let own = |i: usize, j: usize| self.product(columns[i], columns[j]);
        let zz = DMatrix::from_fn(columns.len(), columns.len(), own);
        self.projected(of, (&gz, &zz), &self.zy.select_rows(columns))
    }

    /// Of two candidates' columns: below the diagonal are those that were summed.
    pub(super) fn product(&self, i: usize, j: usize) -> f64 {
        self.zz[(i.max(j), i.min(j))]
    }

    fn projected(
        &self,
        (geometry, noise): (&Geometry, Noise),
        (gz, zz): (&DMatrix<f64>, &DMatrix<f64>),
        zy: &DVector<f64>,
    ) -> Projected {
        let k2 = geometry.scale * geometry.scale;
        let v = geometry.whiten(gz);
        let vy = geometry.whiten(&DMatrix::from_column_slice(self.gy.len(), 1, self.gy.as_slice()));
        let vy = vy.column(0);
        let mut c = zz / k2;
        lower_product(&mut c, -1.0, v.transpose().as_view(), v.as_view());
        c.fill_upper_triangle_with_lower_triangle();
        let mut b = zy / k2 - v.tr_mul(&vy);
        let full = zz.diagonal() / k2;
        for j in 0..c.ncols() {
            if c[(j, j)] <= SEEN * full[j] {
                c.column_mut(j).fill(0.0);
                c.row_mut(j).fill(0.0);
                b[j] = 0.0;
            }
        }
        Projected {
            c,
            b,
            s: (self.yy / k2 - vy.norm_squared()).max(0.0),
            full,
            noise,
            scale: geometry.scale,
        }
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

/// Adds `by * at * a` to the lower triangle of `to`, at being a's transpose:
/// nalgebra's own product of a transpose took seven times as long.
fn lower_product(
    to: &mut DMatrix<f64>,
    by: f64,
    at: DMatrixView<'_, f64>,
    a: DMatrixView<'_, f64>,
) {
    let columns = a.ncols();
    let blocks = to.as_mut_slice().par_chunks_mut(BLOCK * columns.max(1)).enumerate();
    blocks.for_each(|(k, block)| {
        let (first, width) = (k * BLOCK, block.len() / columns);
        let below = columns - first;
        let mut block = DMatrixViewMut::from_slice(block, columns, width);
        let mut target = block.rows_mut(first, below);
        target.gemm(by, &at.rows(first, below), &a.columns(first, width), 1.0);
    });
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
