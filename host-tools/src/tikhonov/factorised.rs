//! One problem, factorised for every lambda.

use nalgebra::{DMatrix, DVector};

use super::{NOISE, NOISE_NORMAL, Normal, Triangle, eigen, pseudo_inverse, svd};

/// A lambda below this share of the largest eigenvalue may look into directions
/// that normal equations do not see.
const TOLD: f64 = 1e-11;

/// A problem factorised for every lambda.
#[derive(Debug, Clone)]
pub struct Factorised {
    free: usize,
    /// Pseudo-inverse of the free block and its coupling to the penalised one.
    free_inverse: DMatrix<f64>,
    free_coupling: DMatrix<f64>,
    free_rhs: DVector<f64>,
    /// Singular values, right vectors and rotated right-hand side of the
    /// penalised block, the free unknowns projected out.
    pub(super) s: DVector<f64>,
    v_t: DMatrix<f64>,
    pub(super) beta: DVector<f64>,
    /// What no solution reaches.
    pub(super) rest: f64,
    /// Directions of the free unknowns that the equations determine.
    taken: usize,
    /// Equations left when the free unknowns have taken theirs.
    pub(super) equations: f64,
    /// Singular values below this share of the largest are rounding noise.
    pub(super) noise: f64,
}

impl Factorised {
    /// Factorises; the first `free` unknowns are not penalised.
    #[must_use]
    pub fn new(triangle: &Triangle, free: usize) -> Self {
        let t = &triangle.r;
        let p = triangle.unknowns();
        let penalised = p - free;
        let (u, s, v_t) = svd(t.view((0, 0), (free, free)).into_owned());
        let largest = s.iter().copied().fold(0.0, f64::max);
        let keep: Vec<bool> = s.iter().map(|s| *s > NOISE * largest).collect();
        let mut inverse = DMatrix::zeros(free, free);
        for k in (0..free).filter(|k| keep[*k]) {
            inverse += v_t.row(k).transpose() * u.column(k).transpose() / s[k];
        }
        let coupling = t.view((0, free), (free, penalised)).into_owned();
        let free_rhs = t.view((0, p), (free, 1)).column(0).into_owned();
        // What the free unknowns cannot reach belongs to the penalised block.
        let lost: Vec<usize> = (0..free).filter(|k| !keep[*k]).collect();
        let below = p + 1 - free;
        let mut block = DMatrix::zeros(below + lost.len(), penalised);
        let mut rhs = DVector::zeros(below + lost.len());
        block.rows_mut(0, below).copy_from(&t.view((free, free), (below, penalised)));
        rhs.rows_mut(0, below).copy_from(&t.view((free, p), (below, 1)));
        for (i, k) in lost.into_iter().enumerate() {
            block.row_mut(below + i).copy_from(&(u.column(k).transpose() * &coupling));
            rhs[below + i] = u.column(k).dot(&free_rhs);
        }
        let (u, s, v_t) = svd(block);
        let beta = u.tr_mul(&rhs);
        let rest = (rhs.norm_squared() - beta.norm_squared()).max(0.0);
        let taken = keep.iter().filter(|k| **k).count();
        let equations = triangle.rows.saturating_sub(taken) as f64;
        Self {
            free,
            free_inverse: inverse,
            free_coupling: coupling,
            free_rhs,
            s,
            v_t,
            beta,
            rest,
            taken,
            equations,
            noise: NOISE,
        }
    }

    /// The same from normal equations: many times cheaper, and for lambdas that
    /// [`Factorised::tells`] as good.
    #[must_use]
    pub fn of_normal(normal: &Normal, free: usize) -> Self {
        let (h, g) = (normal.h(), normal.g());
        let penalised = normal.unknowns() - free;
        let (inverse, taken) = pseudo_inverse(h.view((0, 0), (free, free)).into_owned());
        let coupling = h.view((0, free), (free, penalised)).into_owned();
        let free_rhs = g.rows(0, free).into_owned();
        let solved = &inverse * &coupling;
        let block = h.view((free, free), (penalised, penalised)) - coupling.tr_mul(&solved);
        let rhs = g.rows(free, penalised) - solved.tr_mul(&free_rhs);
        let (values, vectors) = eigen(block);
        let s = values.map(|e| e.max(0.0).sqrt());
        let least = NOISE_NORMAL * s.iter().copied().fold(0.0, f64::max);
        let turned = vectors.tr_mul(&rhs);
        let beta =
            DVector::from_fn(penalised, |k, _| if s[k] > least { turned[k] / s[k] } else { 0.0 });
        let reached = free_rhs.dot(&(&inverse * &free_rhs)) + beta.norm_squared();
        Self {
            free,
            free_inverse: inverse,
            free_coupling: coupling,
            free_rhs,
            s,
            v_t: vectors.transpose(),
            beta,
            rest: (normal.s() - reached).max(0.0),
            taken,
            equations: normal.equations().saturating_sub(taken) as f64,
            noise: NOISE_NORMAL,
        }
    }

    /// What the equations say of the penalised unknowns when the free ones have taken
    /// what they like: normal equations of these alone.
    #[must_use]
    pub fn penalised(&self) -> Normal {
        let size = self.s.len();
        let mut gram = DMatrix::zeros(size + 1, size + 1);
        let root = DMatrix::from_diagonal(&self.s) * &self.v_t;
        let pull = root.tr_mul(&self.beta);
        gram.view_mut((0, 0), (size, size)).copy_from(&root.tr_mul(&root));
        gram.view_mut((0, size), (size, 1)).copy_from(&pull);
        gram.view_mut((size, 0), (1, size)).copy_from(&pull.transpose());
        gram[(size, size)] = self.rest + self.beta.norm_squared();
        Normal::of_gram(gram, self.equations as usize)
    }

    /// Whether this factorisation sees every direction that a lambda leaves
    /// open.
    #[must_use]
    pub fn tells(&self, lambda: f64) -> bool {
        let largest = self.s.iter().copied().fold(0.0, f64::max).powi(2);
        self.noise == NOISE || lambda > TOLD * largest
    }

    /// Directions of the free unknowns that the equations determine.
    #[must_use]
    pub fn determined(&self) -> usize {
        self.taken
    }

    /// Singular values of the penalised block, largest first.
    #[must_use]
    pub fn singular_values(&self) -> &DVector<f64> {
        &self.s
    }

    /// Gain of singular direction k; zero where it is rounding noise.
    pub(super) fn gain(&self, k: usize, lambda: f64) -> f64 {
        let s = self.s[k];
        if s > self.noise * self.s[0] { s / (s * s + lambda) } else { 0.0 }
    }

    /// The solution for one lambda, free unknowns first.
    #[must_use]
    pub fn solve(&self, lambda: f64) -> DVector<f64> {
        let mut x = DVector::zeros(self.free + self.s.len());
        let y = DVector::from_fn(self.s.len(), |k, _| self.gain(k, lambda) * self.beta[k]);
        let penalised = self.v_t.transpose() * y;
        let rhs = &self.free_rhs - &self.free_coupling * &penalised;
        x.rows_mut(0, self.free).copy_from(&(&self.free_inverse * rhs));
        x.rows_mut(self.free, self.s.len()).copy_from(&penalised);
        x
    }

    /// The step of the free unknowns with the penalised ones held at `x`; the
    /// step of these is zero.
    #[must_use]
    pub fn solve_free(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut step = DVector::zeros(x.len());
        let held = x.rows(self.free, self.s.len());
        let rhs = &self.free_rhs - &self.free_coupling * held;
        step.rows_mut(0, self.free).copy_from(&(&self.free_inverse * rhs));
        step
    }

    /// `|A x - b|^2` of the solution for one lambda.
    #[must_use]
    pub fn residual_square(&self, lambda: f64) -> f64 {
        let left = |k: usize| (1.0 - self.gain(k, lambda) * self.s[k]) * self.beta[k];
        self.rest + (0..self.s.len()).map(|k| left(k).powi(2)).sum::<f64>()
    }

    /// `|x_penalised|^2` of the solution for one lambda.
    #[must_use]
    pub fn norm_square(&self, lambda: f64) -> f64 {
        (0..self.s.len()).map(|k| (self.gain(k, lambda) * self.beta[k]).powi(2)).sum()
    }
}
