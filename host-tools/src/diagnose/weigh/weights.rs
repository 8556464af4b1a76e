//! How much each row counts after a fit: tails and what the readings of a pose
//! have in common.

use nalgebra::DVector;
use rayon::prelude::*;

use super::sheet::{Weights, along, counted, seen, turning};
use crate::diagnose::node::Node;
use crate::evidence::directed::{self, Seen};
use crate::evidence::poses::{self, Readings, Scatter, Used, common_share};
use crate::evidence::tails::{Rest, Tails};
use crate::identify::{Linearised, Problem, Scatterer};
use crate::observations::{by_pose, by_target, equations_of, kind, repeat};

/// What rows weigh after a fit beside what scatters.
#[must_use]
pub fn after(problem: &Problem, node: &Node, scattering: &[Scatterer]) -> Weights {
    let kept = &node.fit.kept;
    let (residuals, scattering) = scattered(problem, node, scattering);
    let used = node.fit.used;
    // Share of the noise that the readings of a pose have in common.
    let readings = readings(&by_pose(&problem.data.rows, kept), &residuals);
    let common = common_share(&readings, by_means(problem, kept, used));
    let counted = counted(problem, kept, common);
    let rest = |(r, count): (&Vec<f64>, &f64)| Rest {
        square: r.iter().map(|x| x * x).sum(),
        equations: r.len(),
        count: *count,
    };
    let rests: Vec<Rest> = residuals.iter().zip(&counted).map(rest).collect();
    let tails = Tails::of(&rests, used.min(counted.iter().sum()));
    let mut rows = vec![1.0; problem.data.rows.len()];
    for (row, rest) in kept.iter().zip(&rests) {
        rows[*row] = tails.weight(*rest);
    }
    let turning = turning(problem, kept, &residuals, common);
    Weights { rows, common, turning, scattering, tailed: tails.tailed(&rests) }
}

/// What a fit leaves of each pose, in the mean of its readings.
#[must_use]
pub fn left(problem: &Problem, node: &Node, scattering: &[Scatterer]) -> Vec<Rest> {
    let kept = &node.fit.kept;
    let (residuals, _) = scattered(problem, node, scattering);
    let of = |readings: &Readings| Rest {
        square: readings.norm_squared() / readings.ncols() as f64,
        equations: readings.nrows(),
        count: 1.0,
    };
    readings(&by_pose(&problem.data.rows, kept), &residuals).iter().map(of).collect()
}

/// Residuals without what these scatter, and the ratio of variance of each.
fn scattered(
    problem: &Problem,
    node: &Node,
    sources: &[Scatterer],
) -> (Vec<Vec<f64>>, Vec<(Scatterer, f64)>) {
    let at = problem.linearise(&node.fit.fit.state);
    let kept = &node.fit.kept;
    let beside = |source: Scatterer, others: &[(Scatterer, f64)]| {
        let of_row = |row: &usize| {
            let (ways, residual) = along(&at, problem, *row, source, others);
            seen(source, &ways, &residual)
        };
        let seen: Vec<Seen> = kept.par_iter().flat_map_iter(of_row).collect();
        (source, directed::ratio(&seen))
    };
    let mut out: Vec<(Scatterer, f64)> = Vec::new();
    for source in sources {
        out.push(beside(*source, &out));
    }
    // The first takes what others scatter, too: each anew beside all others. So for joints and
    // a sight alike, as their evidence is compared.
    for _ in 0..if out.len() > 1 { TURNS } else { 0 } {
        let before = out.clone();
        for k in 0..out.len() {
            let (source, _) = out.remove(k);
            out.insert(k, beside(source, &out));
        }
        if out == before {
            break;
        }
    }
    (kept.iter().map(|row| without(&at, problem, *row, &out)).collect(), out)
}

/// Times that ratios are found anew, each beside the others.
const TURNS: usize = 8;

/// Residual of a row without what these scatter.
fn without(
    at: &Linearised,
    problem: &Problem,
    row: usize,
    scattering: &[(Scatterer, f64)],
) -> Vec<f64> {
    match scattering.first() {
        Some((first, _)) => along(at, problem, row, *first, scattering).1.to_vec(),
        None => at.scaled_residual(row).to_vec(),
    }
}

/// What a fit leaves of the rows that it kept, and of those that it flagged, beside what scatters.
#[must_use]
pub fn kept_and_flagged(
    problem: &Problem,
    node: &Node,
    scattering: &[Scatterer],
) -> [Vec<Rest>; 2] {
    let Weights { common, scattering, .. } = after(problem, node, scattering);
    let at = problem.linearise(&node.fit.fit.state);
    let flagged: Vec<usize> = node.fit.outliers.iter().map(|outlier| outlier.row).collect();
    let rows = [&node.fit.kept[..], &flagged].concat();
    let rest = |(row, count): (&usize, f64)| {
        let residual = without(&at, problem, *row, &scattering);
        let square = residual.iter().map(|x| x * x).sum();
        Rest { square, equations: residual.len(), count }
    };
    let counts = counted(problem, &rows, common);
    let mut kept: Vec<Rest> = rows.iter().zip(counts).map(rest).collect();
    let flagged = kept.split_off(node.fit.kept.len());
    [kept, flagged]
}

/// By how much, in nats, readings of a pose, the arm away in between, speak against the scatter
/// of the last of these: what returns with the pose is no scatter.
#[must_use]
pub fn denied(problem: &Problem, node: &Node, scattering: &[(Scatterer, f64)]) -> f64 {
    let Some(((source, ratio), others)) = scattering.split_last() else { return 0.0 };
    let (at, kept) = (problem.linearise(&node.fit.fit.state), &node.fit.kept);
    let (mut all, mut apart) = (Vec::new(), Vec::new());
    let mut contrasts = 0;
    for readings in by_pose(&problem.data.rows, kept) {
        let rows: Vec<usize> = readings.iter().map(|k| kept[*k]).collect();
        let mut mean = DVector::zeros(0);
        let mut visits = 0.0;
        for (k, row) in rows.iter().enumerate() {
            let (ways, residual) = along(&at, problem, *row, *source, others);
            let own = seen(*source, &ways, &residual);
            if own.is_empty() {
                continue;
            }
            all.extend(own);
            let residual = DVector::from_column_slice(&residual);
            let pose = |row: usize| problem.data.rows[row].pose;
            let stayed = |before: usize| (before..*row).all(|r| pose(r) == pose(*row));
            if k > 0 && (stayed(rows[k - 1]) || !repeat(&problem.data.rows, &rows)) {
                continue;
            }
            if visits > 0.0 {
                // Contrasts of Helmert are as independent as the readings, and scatter as they do.
                let root = f64::sqrt(visits / (visits + 1.0));
                apart.extend(Seen::each(&ways, &((&mean - &residual) * root)));
                contrasts += 1;
                mean += (residual - &mean) / (visits + 1.0);
            } else {
                mean = residual;
            }
            visits += 1.0;
        }
    }
    let variance = ratio * directed::other_variance(&all, *ratio);
    if contrasts < REPEATED { 0.0 } else { directed::less_likely(&apart, variance) }
}

/// Fewer readings of poses read before tell nothing of what returns with the pose.
const REPEATED: usize = 10;

/// How readings of a target in a pose, and poses, scatter after a fit, in sigmas.
#[must_use]
pub fn scatter(problem: &Problem, node: &Node) -> Option<Scatter> {
    let at = problem.linearise(&node.fit.fit.state);
    let of = |row: &usize| at.scaled_residual(*row).to_vec();
    let mut kept = node.fit.kept.clone();
    // An image is taken once.
    kept.retain(|row| !kind(&problem.data.rows[*row]).is_image());
    let residuals: Vec<Vec<f64>> = kept.iter().map(of).collect();
    let used = node.fit.used;
    let readings = readings(&by_target(&problem.data.rows, &kept), &residuals);
    poses::scatter(&readings, Used { means: used, apart: 0.0 })
}

/// Of what unknowns use up, the share of the means of poses. Readings of one thing are told
/// apart by nothing; what corners of an image, or targets, are apart tells as much as where
/// they are.
fn by_means(problem: &Problem, kept: &[usize], used: f64) -> Used {
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
fn readings(lists: &[Vec<usize>], residuals: &[Vec<f64>]) -> Vec<Readings> {
    let of = |readings: &Vec<usize>| {
        let equations = residuals[readings[0]].len();
        Readings::from_fn(equations, readings.len(), |e, r| residuals[readings[r]][e])
    };
    lists.iter().map(of).collect()
}
