//! D-optimal choice of poses by exchange.
//!
//! A pose gives as many equations as its kind of measurement has; with Jacobian
//! blocks `J_i` in measurement sigmas the information of a set is
//! `M = P + sum J_i' J_i`, where P is the prior of the identification
//! (manufacturing tolerances) and the blocks are those of the directions that the
//! kind can determine, `p` in number. The
//! exchange (Fedorov, *Theory of Optimal Experiments*, 1972; one point at a
//! time as Cook and Nachtsheim, Technometrics 22, 1980) maximises `det M`.
//!
//! That this also makes the *worst* tool point good is the equivalence theorem
//! (Kiefer and Wolfowitz 1960; for several responses Fedorov 1972, th. 5.2.1):
//! for a set of n poses `sum trace(J_i M^-1 J_i') = p` without a prior, so the
//! largest trace over a region that contains them is at least `p / n`. The root
//! of the trace is the 3-D standard deviation of the tool point in sigmas:
//! none is below `sigma sqrt(p / n)` in the worst case, and the D-optimal
//! distribution of poses attains it. That holds of points: of a kind that measures
//! more than the tool point, the tool point's trace is a part of the sum only.

use nalgebra::{DMatrix, Matrix3, Matrix6};

use super::imagined::Imagined;
use crate::identify::Problem;
use crate::model::{KindId, Robot};

/// Singular values below this share of the largest are redundancy.
const ZERO: f64 = 1e-10;
const MOST_SWEEPS: usize = 20;

/// Candidates and what they tell.
pub struct Design {
    sigma: f64,
    kind: KindId,
    /// Equations of a pose.
    width: usize,
    /// Directions that the kind can determine, one a column.
    basis: DMatrix<f64>,
    prior: DMatrix<f64>,
    /// Blocks of the candidates side by side, transposed: p x width each.
    blocks: DMatrix<f64>,
}

impl Design {
    /// At the nominal geometry of `robot`, of a kind of measurement.
    #[must_use]
    pub fn new(robot: &Robot, candidates: &[Vec<f64>], kind: KindId) -> Self {
        let imagined = Imagined::new(robot, candidates, kind);
        let problem = imagined.problem(robot);
        let jacobian = imagined.equations(&problem);
        // The triangle has the singular values of the whole without squaring.
        let triangle = jacobian.transpose().qr().r();
        let svd = triangle.svd(false, true);
        let v = svd
            .v_t
            .unwrap_or_else(|| DMatrix::identity(jacobian.nrows(), jacobian.nrows()))
            .transpose();
        let largest = svd.singular_values.max();
        let keep: Vec<usize> =
            (0..v.ncols()).filter(|k| svd.singular_values[*k] > ZERO * largest).collect();
        let lost: Vec<usize> = (0..v.ncols()).filter(|k| !keep.contains(k)).collect();
        let (basis, null) = (v.select_columns(&keep), v.select_columns(&lost));
        let unknowns = &problem.unknowns;
        let penalty = DMatrix::from_fn(v.nrows(), v.nrows(), |i, j| {
            if i == j && i >= unknowns.free() { 1.0 } else { 0.0 }
        });
        // What the prior says of the basis once it has settled the rest.
        let mut prior = basis.tr_mul(&(&penalty * &basis));
        let cross = basis.tr_mul(&(&penalty * &null));
        let rest = null.tr_mul(&(&penalty * &null));
        if let Ok(inverse) = rest.pseudo_inverse(1e-9) {
            prior -= &cross * inverse * cross.transpose();
        }
        let blocks = basis.tr_mul(&jacobian);
        let width = jacobian.ncols() / candidates.len().max(1);
        Self { sigma: robot.sigma, kind, width, basis, prior, blocks }
    }

    /// Parameters that the kind can determine.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.basis.ncols()
    }

    /// Number of candidates.
    #[must_use]
    pub fn candidates(&self) -> usize {
        self.blocks.ncols() / self.width
    }

    /// Equations that a pose gives.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// How the tool point moves at other poses, in sigmas: three columns each.
    #[must_use]
    pub fn tool_points(&self, robot: &Robot, poses: &[Vec<f64>]) -> DMatrix<f64> {
        let imagined = Imagined::new(robot, poses, self.kind);
        let problem: Problem = imagined.problem(robot);
        self.basis.tr_mul(&(imagined.tool_points(&problem) / self.sigma))
    }

    /// The Jacobian of some candidates, as many rows each as a pose has equations.
    #[must_use]
    pub fn jacobian(&self, chosen: &[usize]) -> DMatrix<f64> {
        let of = |k: &usize| self.width * k..self.width * (k + 1);
        let columns: Vec<usize> = chosen.iter().flat_map(of).collect();
        self.blocks.select_columns(&columns).transpose()
    }

    fn information(&self, chosen: &[usize]) -> DMatrix<f64> {
        let jacobian = self.jacobian(chosen);
        &self.prior + jacobian.tr_mul(&jacobian)
    }

    /// Standard deviations of the tool point, 3-D, at poses given by blocks, m.
    #[must_use]
    pub fn sigmas(&self, chosen: &[usize], at: &DMatrix<f64>) -> Vec<f64> {
        let weighed = inverse(self.information(chosen)) * at;
        let trace =
            |k: usize| (3 * k..3 * k + 3).map(|c| weighed.column(c).dot(&at.column(c))).sum();
        let traces = (0..at.ncols() / 3).map(trace);
        traces.map(|t: f64| self.sigma * t.max(0.0).sqrt()).collect()
    }

    /// Improves a design by exchanging one pose at a time for the candidate
    /// that raises the determinant most, until none does. The poses and the
    /// logarithm of the determinant.
    #[must_use]
    pub fn exchange(&self, start: Vec<usize>) -> (Vec<usize>, f64) {
        let mut chosen = start;
        for _ in 0..MOST_SWEEPS {
            let mut changed = false;
            for place in 0..chosen.len() {
                let mut others = chosen.clone();
                let before = others.remove(place);
                let best = self.best_addition(&others, before);
                changed |= best != before;
                chosen[place] = best;
            }
            if !changed {
                break;
            }
        }
        let information = self.information(&chosen);
        let log = information.cholesky().map_or(f64::NEG_INFINITY, |c| {
            2.0 * c.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
        });
        (chosen, log)
    }

    /// The candidate that raises the determinant most; `now` if none is better.
    fn best_addition(&self, others: &[usize], now: usize) -> usize {
        let weighed = inverse(self.information(others)) * &self.blocks;
        let gain = |k: usize| {
            let first = self.width * k;
            determinant(self.width, |c, d| {
                weighed.column(first + c).dot(&self.blocks.column(first + d))
            })
        };
        let mut best = (gain(now) * (1.0 + 1e-9), now);
        for k in (0..self.candidates()).filter(|k| !others.contains(k)) {
            let gain = gain(k);
            if gain > best.0 {
                best = (gain, k);
            }
        }
        best.1
    }
}

/// Inverse of an information matrix; nearly singular ones (fewer equations than
/// parameters while a pose is taken out) get the last bit of help.
fn inverse(mut information: DMatrix<f64>) -> DMatrix<f64> {
    let little = 1e-12 * information.diagonal().max();
    for k in 0..information.nrows() {
        information[(k, k)] += little;
    }
    let size = information.nrows();
    information.cholesky().map_or_else(|| DMatrix::identity(size, size), |c| c.inverse())
}

/// Of the identity and a matrix.
fn determinant(size: usize, of: impl Fn(usize, usize) -> f64) -> f64 {
    match size {
        3 => (Matrix3::identity() + Matrix3::from_fn(of)).determinant(),
        6 => (Matrix6::identity() + Matrix6::from_fn(of)).determinant(),
        _ => (DMatrix::identity(size, size) + DMatrix::from_fn(size, size, of)).determinant(),
    }
}
