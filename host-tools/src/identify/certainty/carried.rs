//! What rows carry of noise, and what estimates scatter for it: the fit takes its noise for the
//! same every way and anew in every row, its estimate scatters as the noise is (White,
//! Econometrica 48 (1980) 817; of what rows have in common Moulton, Review of Economics and
//! Statistics 72 (1990) 334).

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::directed::{columns, ways};
use super::repeats::{by_means, readings};
use crate::identify::fit::estimate::Estimate;
use crate::identify::problem::accumulate::tree;
use crate::identify::{Linearised, Problem};
use crate::observations::by_pose;
use crate::statistics::repeats::common_share;
use crate::tikhonov::Normal;

/// The noise that a fit finds in its rows.
#[derive(Debug, Clone)]
pub struct Carried {
    /// `A'VA`, V the covariance of the rows over the variance of one equation.
    pub information: DMatrix<f64>,
    /// Sum of the squares of the residuals.
    pub square: f64,
    /// How many they are.
    pub equations: f64,
    /// So many of them tell as much of the variance as an independent one: the mean over
    /// equations of the sum of their squared correlations with all.
    pub alike: f64,
}

impl Carried {
    /// By sums of rows, each with noise of its own, at these corrections from where their
    /// right-hand sides are counted.
    #[must_use]
    pub fn of_sums(normal: &Normal, x: &DVector<f64>) -> Self {
        let information = normal.h().into_owned();
        let square = normal.s() - 2.0 * normal.g().dot(x) + x.dot(&(&information * x));
        let equations = normal.equations() as f64;
        Self { information, square: square.max(0.0), equations, alike: 1.0 }
    }

    /// By rows that the fit kept.
    #[must_use]
    pub fn of(problem: &Problem, found: &Estimate) -> Self {
        let kept = &found.robust.kept;
        let at = problem.linearise(&found.fit.state);
        let sums = Self::of_sums(&found.fit.normal, at.corrections());
        // The sums may be of more rows than these: of the repeats of the others nothing is known.
        let all_here = found.fit.normal.equations() == problem.equations(kept);
        let repeated = problem.data.poses < problem.data.rows.len();
        if !all_here || !repeated && problem.scattering.is_empty() {
            return sums;
        }
        let residuals: Vec<Vec<f64>> =
            kept.par_iter().map(|row| at.scaled_residual(*row).to_vec()).collect();
        let poses = by_pose(&problem.data.rows, kept);
        let common =
            common_share(&readings(&poses, &residuals), by_means(problem, kept, found.robust.used));
        if common == 0.0 && problem.scattering.is_empty() {
            return sums;
        }
        let rows = |readings: &Vec<usize>| readings.iter().map(|k| kept[*k]).collect();
        let poses: Vec<Vec<usize>> = poses.iter().map(rows).collect();
        let with = |readings: &Vec<usize>| {
            (problem.equations(readings) * readings.len().saturating_sub(1)) as f64
        };
        let pairs: f64 = poses.iter().map(with).sum();
        Self {
            information: information(problem, &at, &poses, common),
            alike: 1.0 + common * common * pairs / sums.equations.max(1.0),
            ..sums
        }
    }
}

/// `A'VA` of the readings of poses that have so much of their variance in common, and whose
/// stated noise is in part that of joints and sights that scatter.
fn information(
    problem: &Problem,
    at: &Linearised,
    poses: &[Vec<usize>],
    common: f64,
) -> DMatrix<f64> {
    let all: Vec<usize> = (0..poses.len()).collect();
    let leaf = |own: &[usize]| {
        let mut sums = Sums::none(problem.unknowns.list().len());
        own.iter().for_each(|pose| sums.add(problem, at, &poses[*pose], common));
        sums
    };
    let Sums { plain, along, square, equations } = tree(&all, PART, &leaf, &Sums::join);
    // What is along the joints is a part of the stated noise, not beside it.
    let rest = (1.0 - square / f64::max(equations, 1.0)).max(0.0);
    plain * rest + along
}

/// Poses that one task sums.
const PART: usize = 64;

/// Sums over rows.
struct Sums {
    /// Of noise that is the same every way.
    plain: DMatrix<f64>,
    /// Of what scatters by itself.
    along: DMatrix<f64>,
    /// Its variance, over that of one equation.
    square: f64,
    equations: f64,
}

impl Sums {
    fn none(unknowns: usize) -> Self {
        let zeros = DMatrix::zeros(unknowns, unknowns);
        Self { plain: zeros.clone(), along: zeros, square: 0.0, equations: 0.0 }
    }

    /// With the readings of a pose.
    fn add(&mut self, problem: &Problem, at: &Linearised, readings: &[usize], common: f64) {
        let sources = || problem.scattering.iter().map(|source| source.0);
        let mut means: Option<[DMatrix<f64>; 2]> = None;
        // Of what a pose has in common its mean is added once below.
        let own = 1.0 - if readings.len() > 1 { common } else { 0.0 };
        for row in readings {
            let e = at.equations_beside(*row, &|i, d| ways(problem, sources(), *row, (i, d)));
            let (block, each) = columns(problem, sources(), *row, &e.block);
            let mut scattered = DMatrix::zeros(block.nrows(), 0);
            for (own, (_, size)) in each.iter().zip(&problem.scattering) {
                let first = scattered.ncols();
                scattered = scattered.insert_columns(first, own.ncols(), 0.0);
                scattered.columns_mut(first, own.ncols()).copy_from(&(own * *size));
            }
            let along = block.tr_mul(&scattered);
            self.plain.gemm_tr(own, &block, &block, 1.0);
            self.along.gemm(own, &along, &along.transpose(), 1.0);
            self.square += scattered.norm_squared();
            self.equations += block.nrows() as f64;
            means = match means.take() {
                None => Some([block, along]),
                Some([a, b]) if a.shape() == block.shape() && b.shape() == along.shape() => {
                    Some([a + block, b + along])
                }
                other => other,
            };
        }
        if let (Some([block, along]), true) = (means, own < 1.0) {
            self.plain.gemm_tr(common, &block, &block, 1.0);
            self.along.gemm(common, &along, &along.transpose(), 1.0);
        }
    }

    fn join(mut self, other: Self) -> Self {
        self.plain += other.plain;
        self.along += other.along;
        self.square += other.square;
        self.equations += other.equations;
        self
    }
}
