//! Whether residuals are white: neighbours in a joint angle or in the order of
//! the rows must not be alike. Needs no noise level.

use nalgebra::DVector;

use super::node::Node;
use super::weigh::Covariate;
use crate::identify::Problem;
use crate::observations::by_pose;

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
            (Covariate::Joint(j).words(problem), of)
        })
        .collect();
    let place = problem.data.places();
    let order = poses.iter().map(|(row, _)| place[*row]);
    covariates.push(("the order of the rows".to_owned(), order.collect()));
    let each = covariates.into_iter().filter_map(|(covariate, of)| {
        let mut order: Vec<usize> = (0..poses.len()).collect();
        let frame = |k: usize| (row(k).kind, row(k).station);
        order.sort_by(|a, b| frame(*a).cmp(&frame(*b)).then(of[*a].total_cmp(&of[*b])));
        let in_frame = order.chunk_by(|a, b| frame(*a) == frame(*b));
        let pairs = in_frame.flat_map(|own| own.windows(2).map(|pair| (pair[0], pair[1])));
        // What the arm moves alike, of one pose, is alike.
        let apart = pairs.filter(|(a, b)| row(*a).pose != row(*b).pose);
        let residuals = apart.map(|(a, b)| (&poses[a].1, &poses[b].1));
        let (deviations, correlation) = likeness(residuals)?;
        Some(Likeness { covariate, deviations, correlation })
    });
    each.max_by(|a, b| a.deviations.total_cmp(&b.deviations))
}

/// Mean residual of each pose of the kept rows, in sigmas, with its first row.
fn poses(problem: &Problem, node: &Node) -> Vec<(usize, DVector<f64>)> {
    let at = problem.linearise(&node.fit.fit.state);
    let kept = &node.fit.kept;
    let mean = |readings: &Vec<usize>| {
        let residual = |k: &usize| DVector::from(at.scaled_residual(kept[*k]).to_vec());
        let sum = readings.iter().map(residual).reduce(|a, b| a + b);
        let sum = sum.unwrap_or_else(|| DVector::zeros(0));
        (kept[readings[0]], sum / readings.len() as f64)
    };
    by_pose(&problem.data.rows, kept).iter().map(mean).collect()
}

/// Deviations above chance and correlation of neighbours; those with other
/// numbers of components are none.
fn likeness<'r>(
    pairs: impl Iterator<Item = (&'r DVector<f64>, &'r DVector<f64>)>,
) -> Option<(f64, f64)> {
    let (mut sum, mut variance, mut square) = (0.0, 0.0, 0.0);
    let mut count = 0;
    for (r, s) in pairs.filter(|(r, s)| r.len() == s.len()) {
        let (a, b) = (r.norm_squared(), s.norm_squared());
        sum += r.dot(s);
        variance += a * b / r.len() as f64;
        square += (a + b) / 2.0;
        count += 1;
    }
    (count > 1 && variance > 0.0).then(|| (sum / variance.sqrt(), sum / square))
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
