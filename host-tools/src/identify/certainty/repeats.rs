//! What the readings of a pose have in common of the noise of a fit.

use crate::identify::Problem;
use crate::observations::{by_pose, equations_of, repeat};
use crate::statistics::repeats::{Readings, Used};

/// Of what unknowns use up, the share of the means of poses. Readings of one thing are told
/// apart by nothing; what corners of an image, or targets, are apart tells as much as where
/// they are.
#[must_use]
pub fn by_means(problem: &Problem, kept: &[usize], used: f64) -> Used {
    let (mut means, mut all) = (0.0, 0.0);
    for readings in by_pose(&problem.data.rows, kept) {
        let readings: Vec<usize> = readings.iter().map(|k| kept[*k]).collect();
        let equations = equations_of(&problem.data.rows[readings[0]]) as f64;
        let one = repeat(&problem.data.rows, &readings);
        let each = if one { 1.0 } else { readings.len() as f64 };
        (means, all) = (means + equations, all + equations * each);
    }
    let share = means / f64::max(all, 1.0);
    Used { means: used * share, apart: used * (1.0 - share) }
}

/// Residuals of the rows of every list.
#[must_use]
pub fn readings(lists: &[Vec<usize>], residuals: &[Vec<f64>]) -> Vec<Readings> {
    let of = |readings: &Vec<usize>| {
        let equations = residuals[readings[0]].len();
        Readings::from_fn(equations, readings.len(), |e, r| residuals[readings[r]][e])
    };
    lists.iter().map(of).collect()
}
