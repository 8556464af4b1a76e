//! Whether residuals are white: neighbours in a joint angle or in the order of
//! the rows must not be alike. Needs no noise level.

use nalgebra::DVector;

use super::node::Node;
use crate::identify::Problem;
use crate::observations::Reading;

/// A covariate along which neighbouring residuals are alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Likeness {
    /// What neighbours are neighbours in.
    pub covariate: String,
    /// Standard deviations above chance.
    pub deviations: f64,
    /// Correlation of neighbours.
    pub correlation: f64,
}

/// The strongest likeness of neighbours that a model leaves, of all joint angles
/// and the order of the rows; `None` of fewer than three poses.
///
/// The statistic is von Neumann's, S = sum of `r_i . r_(i+1)` over neighbouring
/// poses, over the root of the sum of `|r_i|^2 |r_(i+1)|^2 / m`: of independent
/// residuals with any tails it is standard normal.
#[must_use]
pub fn left(problem: &Problem, node: &Node) -> Option<Likeness> {
    let poses = poses(problem, node);
    let row = |k: usize| &problem.data.rows[poses[k].0];
    let mut covariates: Vec<(String, Vec<f64>)> = (0..problem.nominal.len())
        .map(|j| {
            let of = (0..poses.len()).map(|k| row(k).q[j]).collect();
            (format!("the angle of joint {}", j + 1), of)
        })
        .collect();
    let order = poses.iter().map(|(row, _)| problem.data.when(*row));
    covariates.push(("the order of the rows".to_owned(), order.collect()));
    let each = covariates.into_iter().filter_map(|(covariate, of)| {
        let mut order: Vec<usize> = (0..poses.len()).collect();
        order.sort_by(|a, b| of[*a].total_cmp(&of[*b]));
        let (deviations, correlation) = likeness(order.into_iter().map(|k| &poses[k].1))?;
        Some(Likeness { covariate, deviations, correlation })
    });
    each.max_by(|a, b| a.deviations.total_cmp(&b.deviations))
}

/// Mean residual of each pose of the kept rows, in sigmas, with its first row.
fn poses(problem: &Problem, node: &Node) -> Vec<(usize, DVector<f64>)> {
    let at = problem.linearise(&node.fit.fit.state);
    let key = |r: &usize| Reading::of(&problem.data.rows, *r);
    let mut rows = node.fit.kept.clone();
    rows.sort_by_cached_key(|r| (key(r), *r));
    let mean = |rows: &[usize]| {
        let sum = rows.iter().map(|r| DVector::from(at.scaled_residual(*r).to_vec()));
        let sum = sum.reduce(|a, b| a + b).unwrap_or_else(|| DVector::zeros(0));
        (rows[0], sum / rows.len() as f64)
    };
    rows.chunk_by(|a, b| key(a) == key(b)).map(mean).collect()
}

/// Deviations above chance and correlation of neighbours; those with other
/// numbers of components are none.
fn likeness<'r>(residuals: impl Iterator<Item = &'r DVector<f64>>) -> Option<(f64, f64)> {
    let residuals: Vec<_> = residuals.collect();
    let (mut sum, mut variance, mut square) = (0.0, 0.0, 0.0);
    for pair in residuals.windows(2).filter(|pair| pair[0].len() == pair[1].len()) {
        let (a, b) = (pair[0].norm_squared(), pair[1].norm_squared());
        sum += pair[0].dot(pair[1]);
        variance += a * b / pair[0].len() as f64;
        square += (a + b) / 2.0;
    }
    (residuals.len() > 2 && variance > 0.0).then(|| (sum / variance.sqrt(), sum / square))
}

impl Likeness {
    /// What a report says.
    #[must_use]
    pub fn words(&self) -> String {
        let percent = self.correlation * 100.0;
        format!(
            "what is left is alike in neighbours by {} (correlation {percent:.0} %, {:.0} standard \
             deviations)",
            self.covariate, self.deviations
        )
    }
}
