//! Score test: what a candidate would explain if it were added, without
//! fitting it. Its columns are projected off the fitted model, and the
//! residual on what is left. Everything comes from sums over rows, so that no
//! column is held as long as the data.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};
use rayon::prelude::*;
use truearm::JointKind;

use crate::diagnose::candidates::Candidate;
use crate::diagnose::policy::POLICY;
use crate::identify::accumulate::{CHUNK, tree};
use crate::identify::fit::Fit;
use crate::identify::{Linearised, Problem, measurement_column};
use crate::model::ModelTerm;
use crate::model::arm::{Derivatives, RowInputs};

/// A fitted model, ready to test candidates.
pub struct Scorer<'a> {
    problem: &'a Problem<'a>,
    at: Linearised<'a>,
    rows: &'a [usize],
    bases: Vec<Vector3<f64>>,
    /// Of the fitted normal equations.
    factor: Cholesky<f64, Dyn>,
}

/// Some rows as a joint sees them: what its value's column is there.
pub struct JointRows {
    /// Joint values.
    pub q: Vec<f64>,
    /// Squared length of the column, in sigmas.
    pub square: Vec<f64>,
    /// Product with the residual.
    pub right: Vec<f64>,
    /// Products with the columns of the fitted unknowns, a column a row.
    pub products: DMatrix<f64>,
}

/// What a candidate would explain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// Predicted fall of the weighted sum of squares.
    pub statistic: f64,
    /// Coefficients that the data can tell apart.
    pub freedom: usize,
}

/// Added to the diagonal of the fitted equations, as a share of its largest.
const HELD: f64 = 1e-13;

/// Sums over rows of the candidates' columns Z, the fitted ones A and the
/// residual r.
struct Sums {
    /// A'Z
    fitted: DMatrix<f64>,
    /// Z'r
    right: DVector<f64>,
    /// Z'Z of each candidate.
    own: Vec<DMatrix<f64>>,
}

impl Sums {
    fn plus(mut self, other: Self) -> Self {
        self.fitted += other.fitted;
        self.right += other.right;
        self.own.iter_mut().zip(&other.own).for_each(|(a, b)| *a += b);
        self
    }
}

impl<'a> Scorer<'a> {
    /// Of a fit to `rows` with this lambda.
    #[must_use]
    pub fn new(
        problem: &'a Problem<'a>,
        fit: &Fit,
        rows: &'a [usize],
        lambda: f64,
    ) -> Option<Self> {
        let mut h = fit.normal.h().into_owned();
        let largest = h.diagonal().max();
        for k in 0..h.nrows() {
            h[(k, k)] += largest * HELD + if k >= problem.unknowns.free() { lambda } else { 0.0 };
        }
        let bases = fit.state.bases.iter().map(|b| b.translation).collect();
        let at = problem.linearise(&fit.state);
        Some(Self { problem, at, rows, bases, factor: h.cholesky()? })
    }

    /// The rows.
    #[must_use]
    pub fn rows(&self) -> &[usize] {
        self.rows
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.problem.nominal.len()
    }

    /// Whether a joint turns or slides.
    #[must_use]
    pub fn kind(&self, joint: usize) -> JointKind {
        self.problem.nominal[joint].kind
    }

    /// Smallest and largest value of a joint.
    #[must_use]
    pub fn range(&self, joint: usize) -> [f64; 2] {
        let q = self.rows.iter().map(|row| self.problem.data.rows[*row].q[joint]);
        q.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| [low.min(q), high.max(q)])
    }

    /// Tests candidates, all in one pass.
    #[must_use]
    pub fn test(&self, candidates: &[Candidate]) -> Vec<Score> {
        if candidates.is_empty() {
            return Vec::new();
        }
        let leaf = |rows: &[usize]| self.sums(candidates, rows);
        let sums = tree(self.rows, CHUNK, &leaf, &|a: Sums, b| a.plus(b));
        let mut first = 0;
        let firsts: Vec<usize> = candidates
            .iter()
            .map(|c| {
                first += c.terms.len();
                first - c.terms.len()
            })
            .collect();
        let solved = firsts.into_par_iter().zip(&sums.own).map(|(first, own)| {
            let count = own.nrows();
            let fitted = sums.fitted.columns(first, count).into_owned();
            self.solve(own, &fitted, &sums.right.rows(first, count).into_owned())
        });
        solved.collect()
    }

    fn sums(&self, candidates: &[Candidate], rows: &[usize]) -> Sums {
        let p = self.problem.unknowns.list().len();
        let columns = |index: usize, d: &Derivatives| {
            let terms = candidates.iter().flat_map(|c| &c.terms);
            terms.map(|term| self.column(term, index, d)).collect()
        };
        let count: usize = candidates.iter().map(|c| c.terms.len()).sum();
        let equations = self.problem.equations(rows);
        let (mut block, mut residual) =
            (DMatrix::zeros(equations, p + count), DVector::zeros(equations));
        let mut first = 0;
        for row in rows {
            let e = self.at.equations_beside(*row, &columns);
            let r = e.scaled_residual();
            block.rows_mut(first, r.len()).copy_from(&e.block);
            residual.rows_mut(first, r.len()).copy_from(&r.column());
            first += r.len();
        }
        let (a, z) = (block.columns(0, p), block.columns(p, count));
        let mut at = 0;
        let own = candidates.iter().map(|candidate| {
            let own = z.columns(at, candidate.terms.len());
            at += candidate.terms.len();
            own.tr_mul(&own)
        });
        let own = own.collect();
        Sums { fitted: a.transpose() * z, right: z.tr_mul(&residual), own }
    }

    /// Some of the rows as every joint sees them.
    #[must_use]
    pub fn joint_rows(&self, rows: &[usize]) -> Vec<JointRows> {
        let (p, joints) = (self.problem.unknowns.list().len(), self.joints());
        let columns = |_: usize, d: &Derivatives| {
            (0..joints).map(|joint| self.joint_column(joint, d)).collect::<Vec<_>>()
        };
        let of = |row: &usize| {
            let e = self.at.equations_beside(*row, &columns);
            let own = e.block.columns(p, joints);
            let right = own.tr_mul(&e.scaled_residual().column());
            let square = DVector::from_fn(joints, |j, _| own.column(j).norm_squared());
            (e.block.columns(0, p).tr_mul(&own), square, right)
        };
        let found: Vec<_> = rows.par_iter().map(of).collect();
        let joint = |j: usize| JointRows {
            q: rows.iter().map(|row| self.problem.data.rows[*row].q[j]).collect(),
            square: found.iter().map(|(_, square, _)| square[j]).collect(),
            right: found.iter().map(|(.., right)| right[j]).collect(),
            products: DMatrix::from_fn(p, rows.len(), |k, i| found[i].0[(k, j)]),
        };
        (0..joints).map(joint).collect()
    }

    /// Takes what the fitted model can imitate out of products with its columns:
    /// the squared length of a column of the result is what is to be taken from
    /// that of the column it was made of.
    pub fn project(&self, products: &mut DMatrix<f64>) {
        self.factor.l_dirty().solve_lower_triangular_mut(products);
    }

    /// Squared length of what the fitted model imitates of one column.
    #[must_use]
    pub fn imitated(&self, products: &DVector<f64>) -> f64 {
        let mut projected = products.clone();
        self.factor.l_dirty().solve_lower_triangular_mut(&mut projected);
        projected.norm_squared()
    }

    /// How the point moves with a joint's value.
    fn joint_column(&self, joint: usize, d: &Derivatives) -> Vector3<f64> {
        *d.links[joint].joint(self.kind(joint))
    }

    fn solve(&self, cc: &DMatrix<f64>, ac: &DMatrix<f64>, cr: &DVector<f64>) -> Score {
        // Columns scaled to length 1, so that what survives is a share.
        let k = cr.len();
        let scale = DVector::from_fn(k, |i, _| cc[(i, i)].max(1e-300).sqrt().recip());
        let rest = cc - ac.tr_mul(&self.factor.solve(ac));
        let scaled = DMatrix::from_fn(k, k, |i, j| rest[(i, j)] * scale[i] * scale[j]);
        let eigen = scaled.symmetric_eigen();
        let mut score = Score { statistic: 0.0, freedom: 0 };
        let right = cr.component_mul(&scale);
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > POLICY.seen {
                score.statistic += vector.dot(&right).powi(2) / value;
                score.freedom += 1;
            }
        }
        score
    }

    /// How the point of a row moves with a term's coefficient.
    fn column(&self, term: &ModelTerm, row: usize, d: &Derivatives) -> Vector3<f64> {
        let data = &self.problem.data.rows[row];
        let inputs: &RowInputs = &self.problem.conditions.rows[row];
        let ModelTerm::Arm(term) = term else {
            return measurement_column(term, data, d, &self.bases[data.station]);
        };
        let basis = inputs.basis(&data.q, term);
        d.column(term, basis, &self.problem.nominal)
    }
}
