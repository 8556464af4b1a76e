//! Score test: what a candidate would explain if it were added, without
//! fitting it. Its columns are projected off the fitted model, and the
//! residual on what is left.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};
use truearm::effects::Effect;

use crate::diagnose::candidates::Candidate;
use crate::diagnose::policy::POLICY;
use crate::identify::{Problem, State, measurement_column};
use crate::model::ModelTerm;
use crate::model::arm::RowInputs;

/// A fitted model, ready to test candidates.
pub struct Scorer<'a> {
    problem: &'a Problem<'a>,
    rows: Vec<ScoredRow>,
    /// Of the fitted normal equations.
    inverse: Cholesky<f64, Dyn>,
}

/// One joint's column at every row.
pub struct JointColumns {
    /// Joint values.
    pub q: Vec<f64>,
    /// Squared length of the column.
    pub square: Vec<f64>,
    /// Product with the residual.
    pub right: Vec<f64>,
    /// What the fitted model can imitate of it.
    pub projected: DMatrix<f64>,
}

struct ScoredRow {
    index: usize,
    /// Residual over sigma.
    residual: Vector3<f64>,
    /// 3 x unknowns over sigma.
    block: nalgebra::Matrix3xX<f64>,
    /// Column of each joint value over sigma.
    joints: Vec<Vector3<f64>>,
    derivatives: crate::model::arm::Derivatives,
    weight: f64,
}

/// What a candidate would explain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// Predicted fall of the weighted sum of squares.
    pub statistic: f64,
    /// Coefficients that the data can tell apart.
    pub freedom: usize,
}

impl<'a> Scorer<'a> {
    /// Of a fit to `rows` with this lambda.
    #[must_use]
    pub fn new(
        problem: &'a Problem<'a>,
        state: &State,
        rows: &[usize],
        lambda: f64,
    ) -> Option<Self> {
        let at = problem.linearise(state);
        let p = problem.unknowns.list().len();
        let mut h = DMatrix::zeros(p, p);
        let mut out = Vec::with_capacity(rows.len());
        for index in rows {
            let e = at.equations(*index);
            h.gemm_tr(1.0, &e.block, &e.block, 1.0);
            let weight = 1.0 / problem.metres(*index);
            let d = e.derivatives;
            let joints = (0..d.links.len()).map(|j| {
                let revolute = problem.nominal[j].kind == truearm::JointKind::Revolute;
                d.links[j][if revolute { 2 } else { 3 }] * weight
            });
            out.push(ScoredRow {
                index: *index,
                residual: e.residual * weight,
                joints: joints.collect(),
                block: e.block,
                derivatives: d,
                weight,
            });
        }
        let largest = h.diagonal().max();
        for k in 0..p {
            h[(k, k)] += largest * 1e-13 + if k >= problem.unknowns.free() { lambda } else { 0.0 };
        }
        Some(Self { problem, rows: out, inverse: h.cholesky()? })
    }

    /// Tests one candidate.
    #[must_use]
    pub fn test(&self, candidate: &Candidate, bases: &[Vector3<f64>]) -> Score {
        let k = candidate.terms.len();
        let p = self.problem.unknowns.list().len();
        let (mut cc, mut ac, mut cr) =
            (DMatrix::zeros(k, k), DMatrix::zeros(p, k), DVector::zeros(k));
        for row in &self.rows {
            let columns: Vec<Vector3<f64>> =
                candidate.terms.iter().map(|t| self.column(t, row, bases)).collect();
            for i in 0..k {
                cr[i] += columns[i].dot(&row.residual);
                for j in 0..=i {
                    cc[(i, j)] += columns[i].dot(&columns[j]);
                }
                let product = row.block.tr_mul(&columns[i]);
                let mut target = ac.column_mut(i);
                target += product;
            }
        }
        cc.fill_upper_triangle_with_lower_triangle();
        self.solve(&cc, &ac, &cr)
    }

    /// The joint's column at every row, projected: what a scan needs of it.
    #[must_use]
    pub fn joint(&self, joint: usize) -> JointColumns {
        let p = self.problem.unknowns.list().len();
        let mut products = DMatrix::zeros(p, self.rows.len());
        for (row, mut out) in self.rows.iter().zip(products.column_iter_mut()) {
            out.copy_from(&row.block.tr_mul(&row.joints[joint]));
        }
        self.inverse.l_dirty().solve_lower_triangular_mut(&mut products);
        JointColumns {
            q: self.rows.iter().map(|r| self.problem.data.rows[r.index].q[joint]).collect(),
            square: self.rows.iter().map(|r| r.joints[joint].norm_squared()).collect(),
            right: self.rows.iter().map(|r| r.joints[joint].dot(&r.residual)).collect(),
            projected: products,
        }
    }

    fn solve(&self, cc: &DMatrix<f64>, ac: &DMatrix<f64>, cr: &DVector<f64>) -> Score {
        // Columns scaled to length 1, so that what survives is a share.
        let k = cr.len();
        let scale = DVector::from_fn(k, |i, _| cc[(i, i)].max(1e-300).sqrt().recip());
        let rest = cc - ac.tr_mul(&self.inverse.solve(ac));
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

    /// Column of a term at a row, over sigma.
    fn column(&self, term: &ModelTerm, row: &ScoredRow, bases: &[Vector3<f64>]) -> Vector3<f64> {
        let data = &self.problem.data.rows[row.index];
        let inputs: &RowInputs = &self.problem.conditions.rows[row.index];
        let d = &row.derivatives;
        let ModelTerm::Arm(term) = term else {
            return measurement_column(term, data, d, &bases[data.station]) * row.weight;
        };
        let basis = inputs.basis(&data.q, term);
        let joint = usize::from(term.joint);
        match term.effect {
            Effect::BaseCompliance => d.about[usize::from(term.component)] * basis * row.weight,
            Effect::ThermalExpansion => {
                let links = self.problem.nominal.iter().zip(&d.links).enumerate();
                let mut sum = Vector3::zeros();
                for (i, (link, c)) in links {
                    if term.joint == truearm::effects::Term::<f64>::ALL || i == joint {
                        sum += c[1] * link.parameters.a + c[3] * link.parameters.d;
                    }
                }
                sum * basis * row.weight
            }
            _ => row.joints[joint] * basis,
        }
    }
}
