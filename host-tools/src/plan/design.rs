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
//! more than the tool point, or that finds instruments along with the arm, the tool
//! point's trace is a part of the sum only, and the sum of its variances over the
//! region is made small instead ([`Aim`]).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::imagined::Imagined;
use crate::identify::Problem;

/// Singular values below this share of the largest are redundancy.
const ZERO: f64 = 1e-10;

/// Candidates and what they tell.
pub struct Design {
    sigma: f64,
    /// Equations of a measurement.
    width: usize,
    /// Directions that the kind can determine, one a column.
    basis: DMatrix<f64>,
    prior: DMatrix<f64>,
    /// Blocks of the candidates side by side, transposed: p x width each.
    pub(super) blocks: DMatrix<f64>,
    open: Open,
}

/// Directions that no measurement of the kind moves.
struct Open {
    /// One a column.
    basis: DMatrix<f64>,
    /// How they follow those that are determined, by the prior.
    follow: DMatrix<f64>,
    /// Covariance that the prior leaves them, 0 where it says nothing either.
    covariance: DMatrix<f64>,
}

/// What is to be known of the arm over a region.
pub struct Region {
    /// How it moves with the directions that are determined, in sigmas: three columns a
    /// pose.
    blocks: DMatrix<f64>,
    /// Variance of each pose that stays whatever is measured, m^2.
    pub open: Vec<f64>,
}

/// What an exchange is for.
pub enum Aim {
    /// The largest determinant of the information: of points, where it is the smallest
    /// worst case as well.
    Determinant,
    /// The smallest sum of variances over a region (I-optimal): where places of instruments
    /// are found along with the arm, and a determinant would count how well these are known.
    Variance(DMatrix<f64>),
}

impl Region {
    /// To make the mean variance over the region small.
    #[must_use]
    pub fn variance(&self) -> Aim {
        Aim::Variance(&self.blocks * self.blocks.transpose())
    }
}

impl Design {
    /// Of what candidates of some kind tell; noise `sigma`, m.
    #[must_use]
    pub fn new(imagined: &Imagined, problem: &Problem, sigma: f64) -> Self {
        let (jacobian, width) = imagined.equations(problem);
        // The triangle has the singular values of the whole without squaring.
        let triangle = jacobian.transpose().qr().r();
        let svd = triangle.svd(false, true);
        let v = svd
            .v_t
            .unwrap_or_else(|| DMatrix::identity(jacobian.nrows(), jacobian.nrows()))
            .transpose();
        let v = completed(v);
        let largest = svd.singular_values.max();
        let is_told = |k: &usize| svd.singular_values.get(*k).is_some_and(|s| *s > ZERO * largest);
        let (keep, lost): (Vec<usize>, Vec<usize>) = (0..v.ncols()).partition(is_told);
        let (basis, null) = (v.select_columns(&keep), v.select_columns(&lost));
        let penalty = penalty(problem, imagined);
        // What the prior says of the basis once it has settled the rest.
        let mut prior = basis.tr_mul(&(&penalty * &basis));
        let cross = basis.tr_mul(&(&penalty * &null));
        let rest = null.tr_mul(&(&penalty * &null));
        let covariance = rest
            .pseudo_inverse(1e-9)
            .unwrap_or_else(|_| DMatrix::zeros(null.ncols(), null.ncols()));
        let follow = &cross * &covariance;
        prior -= &follow * cross.transpose();
        let blocks = basis.tr_mul(&jacobian);
        let open = Open { basis: null, follow, covariance };
        Self { sigma, width, basis, prior, blocks, open }
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

    /// How something moves at other poses, m: three columns each, a row an unknown.
    #[must_use]
    pub fn region(&self, moved: &DMatrix<f64>) -> Region {
        let (told, open) = (self.basis.tr_mul(moved), self.open.basis.tr_mul(moved));
        let left = &self.open.covariance * &open;
        let trace =
            |k: usize| (3 * k..3 * k + 3).map(|c| left.column(c).dot(&open.column(c))).sum();
        Region {
            open: (0..moved.ncols() / 3).map(trace).collect(),
            blocks: (told - &self.open.follow * open) / self.sigma,
        }
    }

    /// The Jacobian of some candidates, as many rows each as a pose has equations.
    #[must_use]
    pub fn jacobian(&self, chosen: &[usize]) -> DMatrix<f64> {
        self.blocks_of(chosen).transpose()
    }

    /// Its blocks side by side.
    pub(super) fn blocks_of(&self, chosen: &[usize]) -> DMatrix<f64> {
        let of = |k: &usize| self.width * k..self.width * (k + 1);
        let columns: Vec<usize> = chosen.iter().flat_map(of).collect();
        self.blocks.select_columns(&columns)
    }

    pub(super) fn information(&self, chosen: &[usize]) -> DMatrix<f64> {
        let jacobian = self.jacobian(chosen);
        &self.prior + jacobian.tr_mul(&jacobian)
    }

    /// Standard deviations of what is to be known, 3-D, at the poses of a region, m: as
    /// far as it is determined at all, and with what stays open.
    #[must_use]
    pub fn sigmas(&self, chosen: &[usize], over: &Region) -> Vec<[f64; 2]> {
        let at = &over.blocks;
        let weighed = inverse(self.information(chosen)) * at;
        let trace =
            |k: usize| (3 * k..3 * k + 3).map(|c| weighed.column(c).dot(&at.column(c))).sum();
        let both = |(k, open): (usize, &f64)| {
            let told: f64 = self.sigma * self.sigma * f64::max(trace(k), 0.0);
            [told.sqrt(), (told + open.max(0.0)).sqrt()]
        };
        over.open.iter().enumerate().map(both).collect()
    }

    /// How good a design is by an aim.
    pub(super) fn good(&self, chosen: &[usize], aim: &Aim) -> f64 {
        let information = self.information(chosen);
        match aim {
            Aim::Determinant => information.cholesky().map_or(f64::NEG_INFINITY, |c| {
                2.0 * c.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
            }),
            Aim::Variance(weights) => -inverse(information).component_mul(weights).sum(),
        }
    }
}

/// What is known beforehand, as of an identification: links to their tolerances, and the
/// target about where it is stated; unknowns in tolerances.
fn penalty(problem: &Problem, imagined: &Imagined) -> DMatrix<f64> {
    let (count, free) = (problem.unknowns.list().len(), problem.unknowns.free());
    let links = DVector::from_fn(count, |k, _| if k >= free { 1.0 } else { 0.0 });
    let targets = problem.clone().about(imagined.state()).of_targets(imagined.state());
    let targets = targets.columns(0, count);
    DMatrix::from_diagonal(&links) + targets.tr_mul(&targets)
}

/// Orthogonal directions, one a column, with others so that they are as many as they have
/// components: few candidates have fewer.
fn completed(v: DMatrix<f64>) -> DMatrix<f64> {
    let size = v.nrows();
    if v.ncols() == size {
        return v;
    }
    let rest = DMatrix::identity(size, size) - &v * v.transpose();
    let svd = rest.svd(true, false);
    let Some(u) = svd.u else { return v };
    let mut out = DMatrix::zeros(size, size);
    out.columns_mut(0, v.ncols()).copy_from(&v);
    out.columns_mut(v.ncols(), size - v.ncols()).copy_from(&u.columns(0, size - v.ncols()));
    out
}

/// Triangle of an information matrix; nearly singular ones (fewer equations than
/// parameters while a pose is taken out) get the last bit of help.
pub(super) fn factor(mut information: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let little = 1e-12 * information.diagonal().max();
    for k in 0..information.nrows() {
        information[(k, k)] += little;
    }
    information.cholesky()
}

/// Its inverse.
pub(super) fn inverse_of(factor: Option<&Cholesky<f64, Dyn>>, size: usize) -> DMatrix<f64> {
    factor.map_or_else(|| DMatrix::identity(size, size), Cholesky::inverse)
}

fn inverse(information: DMatrix<f64>) -> DMatrix<f64> {
    let size = information.nrows();
    inverse_of(factor(information).as_ref(), size)
}
