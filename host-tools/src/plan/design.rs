//! D-optimal choice of poses by exchange.
//!
//! A pose gives three equations; with Jacobian blocks `J_i` in measurement
//! sigmas the information of a set is `M = P + sum J_i' J_i`, where P is the
//! prior of the identification (manufacturing tolerances) and the blocks are
//! those of the directions that points can determine, `p` in number. The
//! exchange (Fedorov, *Theory of Optimal Experiments*, 1972; one point at a
//! time as Cook and Nachtsheim, Technometrics 22, 1980) maximises `det M`.
//!
//! That this also makes the *worst* tool point good is the equivalence theorem
//! (Kiefer and Wolfowitz 1960; for several responses Fedorov 1972, th. 5.2.1):
//! for a set of n poses `sum trace(J_i M^-1 J_i') = p` without a prior, so the
//! largest trace over a region that contains them is at least `p / n`. The root
//! of the trace is the 3-D standard deviation of the tool point in sigmas:
//! none is below `sigma sqrt(p / n)` in the worst case, and the D-optimal
//! distribution of poses attains it.

use nalgebra::{DMatrix, Matrix3, Vector3};
use truearm::Pose;
use truearm::kinematics::LinkColumns;

use crate::identify::{Unknown, Unknowns};
use crate::model::Robot;
use crate::model::arm::{RowInputs, chain};

/// Singular values below this share of the largest are redundancy.
const ZERO: f64 = 1e-10;
const MOST_SWEEPS: usize = 20;

/// Candidates and what they tell.
pub struct Design {
    sigma: f64,
    /// Directions that points can determine, one a column.
    basis: DMatrix<f64>,
    prior: DMatrix<f64>,
    /// Blocks of the candidates side by side, transposed: p x 3 each.
    blocks: DMatrix<f64>,
}

impl Design {
    /// At the nominal geometry of `robot`.
    #[must_use]
    pub fn new(robot: &Robot, candidates: &[Vec<f64>]) -> Self {
        let jacobian = full_blocks(robot, candidates);
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
        let unknowns = Unknowns::new(1, 1, 0, robot.joints.len());
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
        Self { sigma: robot.sigma, basis, prior, blocks }
    }

    /// Parameters that points can determine.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.basis.ncols()
    }

    /// Number of candidates.
    #[must_use]
    pub fn candidates(&self) -> usize {
        self.blocks.ncols() / 3
    }

    /// Blocks of other poses.
    #[must_use]
    pub fn blocks(&self, robot: &Robot, poses: &[Vec<f64>]) -> DMatrix<f64> {
        self.basis.tr_mul(&full_blocks(robot, poses))
    }

    /// The Jacobian of some candidates, 3 rows each.
    #[must_use]
    pub fn jacobian(&self, chosen: &[usize]) -> DMatrix<f64> {
        let columns: Vec<usize> = chosen.iter().flat_map(|k| 3 * k..3 * k + 3).collect();
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
            let dot = |c, d| weighed.column(3 * k + c).dot(&self.blocks.column(3 * k + d));
            (Matrix3::identity() + Matrix3::from_fn(dot)).determinant()
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

/// Transposed blocks of all unknowns, base and tool first, rows in sigmas and
/// columns in tolerances.
fn full_blocks(robot: &Robot, poses: &[Vec<f64>]) -> DMatrix<f64> {
    let arm = chain(&robot.nominal(), Pose::identity(), robot.tool);
    let unknowns = Unknowns::new(1, 1, 0, robot.joints.len());
    let units: Vec<f64> = unknowns.list().iter().copied().map(Unknown::tolerance).collect();
    let mut out = DMatrix::zeros(units.len(), 3 * poses.len());
    for (k, q) in poses.iter().enumerate() {
        let (d, _) = arm.derivatives(q, &[], &RowInputs::default());
        let links = d.links.iter().flat_map(LinkColumns::to_array);
        let columns: Vec<Vector3<f64>> = d.base.into_iter().chain(d.tool).chain(links).collect();
        for (row, (column, unit)) in columns.iter().zip(&units).enumerate() {
            for c in 0..3 {
                out[(row, 3 * k + c)] = column[c] * unit / robot.sigma;
            }
        }
    }
    out
}
