//! How much each row counts after a fit: tails and what the readings of a pose
//! have in common.

use nalgebra::DVector;
use rayon::prelude::*;

use super::sheet::{Moved, Weights, counted, seen, turning};
use crate::diagnose::node::Node;
use crate::evidence::directed::{self, Seen};
use crate::evidence::tails::{Rest, Tails};
use crate::identify::certainty::repeats::{by_means, readings};
use crate::identify::{Problem, Scatterer};
use crate::model::Values;
use crate::observations::{by_pose, by_target, kind, repeat, visits};
use crate::statistics::repeats::{self, Readings, Scatter, Used, common_share};

/// What a fit leaves of the rows that it kept, and how each of some sources moves them.
pub struct Left<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) node: &'a Node,
    sources: Vec<Scatterer>,
    pub(super) rows: Vec<Moved>,
    /// Places among them of the readings of each pose.
    pub(super) poses: Vec<Vec<usize>>,
}

impl<'a> Left<'a> {
    /// Of a fit, for sources that may scatter.
    #[must_use]
    pub fn of(problem: &'a Problem, node: &'a Node, sources: &[Scatterer]) -> Self {
        let at = problem.linearise(&node.fit.fit.state);
        let moved = |row: &usize| Moved::of(&at, problem, *row, sources);
        let rows = node.fit.kept.par_iter().map(moved).collect();
        let poses = by_pose(&problem.data.rows, &node.fit.kept);
        Self { problem, node, sources: sources.to_vec(), rows, poses }
    }

    /// What rows weigh beside those of the sources that scatter.
    #[must_use]
    pub fn weights(&self, scattering: &[Scatterer]) -> Weights {
        let Self { problem, node, .. } = *self;
        let kept = &node.fit.kept;
        let (residuals, scattering) = self.without(scattering);
        let used = node.fit.used;
        // Share of the noise that the readings of a pose have in common.
        let readings = readings(&self.poses, &residuals);
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
        Weights { rows, common, turning, scattering, beyond: tails.beyond(&rests) }
    }

    /// Each at its place among the sources.
    pub(super) fn placed(&self, scattering: &[(Scatterer, f64)]) -> Vec<(usize, f64)> {
        let place = |source: &Scatterer| self.sources.iter().position(|s| s == source);
        scattering.iter().filter_map(|(source, ratio)| Some((place(source)?, *ratio))).collect()
    }

    /// Residuals without what these scatter, and the ratio of variance of each.
    #[must_use]
    pub fn without(&self, sources: &[Scatterer]) -> (Vec<Vec<f64>>, Vec<(Scatterer, f64)>) {
        let beside = |source: Scatterer, others: &[(Scatterer, f64)]| {
            let own = self.placed(&[(source, 0.0)])[0].0;
            (source, self.ratio(own, &self.placed(others)))
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
        let all = self.placed(&out);
        (self.rows.par_iter().map(|moved| moved.without(&all).to_vec()).collect(), out)
    }

    /// How readings of a pose, the arm away in between, differ beside these: contrasts of Helmert
    /// are as independent as the readings, and scatter as they do. Each with how the last reading
    /// of it is moved by a source.
    fn returned(&self, source: usize, others: &[(usize, f64)]) -> Vec<Vec<Seen>> {
        let rows = &self.problem.data.rows;
        let mut out = Vec::new();
        for readings in &self.poses {
            let own: Vec<usize> = readings.iter().map(|k| self.node.fit.kept[*k]).collect();
            if own.len() < 2 || !repeat(rows, &own) {
                continue;
            }
            let mut mean = DVector::zeros(0);
            for (before, visit) in visits(rows, &own).iter().enumerate() {
                let (ways, residual) = self.rows[readings[visit[0]]].beside(source, others);
                let residual = DVector::from_column_slice(&residual);
                if before == 0 {
                    mean = residual;
                    continue;
                }
                let before = before as f64;
                let root = f64::sqrt(before / (before + 1.0));
                let contrast: Values = ((&mean - &residual) * root).iter().copied().collect();
                out.push(seen(self.sources[source], &ways, &contrast));
                mean += (residual - &mean) / (before + 1.0);
            }
        }
        out.retain(|contrast: &Vec<Seen>| !contrast.is_empty());
        out
    }

    /// The ratio of variance of a source beside others: what returns with the pose is no scatter
    /// of it, where enough readings tell how much does not.
    fn ratio(&self, source: usize, others: &[(usize, f64)]) -> f64 {
        let every = self.seen(source, others);
        let ratio = directed::ratio(&every);
        let contrasts = if ratio > 0.0 { self.returned(source, others) } else { Vec::new() };
        if contrasts.len() < RETURNED {
            return ratio;
        }
        let apart = contrasts.concat();
        let own = directed::ratio(&apart);
        let [apart, every] =
            [(&apart, own), (&every, ratio)].map(|(s, ratio)| directed::other_variance(s, ratio));
        ratio.min(own * apart / every.max(f64::MIN_POSITIVE))
    }

    fn seen(&self, source: usize, others: &[(usize, f64)]) -> Vec<Seen> {
        let of_row = |moved: &Moved| {
            let (ways, residual) = moved.beside(source, others);
            seen(self.sources[source], &ways, &residual)
        };
        self.rows.par_iter().flat_map_iter(of_row).collect()
    }

    /// By how much, in nats, readings of a pose, the arm away in between, speak against the
    /// scatter of the last of these: what returns with the pose is no scatter.
    #[must_use]
    pub fn denied(&self, scattering: &[(Scatterer, f64)]) -> f64 {
        let all = self.placed(scattering);
        let Some(((source, ratio), others)) = all.split_last() else { return 0.0 };
        let contrasts = self.returned(*source, others);
        if contrasts.len() < REPEATED {
            return 0.0;
        }
        let variance = ratio * directed::other_variance(&self.seen(*source, others), *ratio);
        directed::less_likely(&contrasts.concat(), variance)
    }
}

/// Times that ratios are found anew, each beside the others.
const TURNS: usize = 8;

/// What rows weigh after a fit beside what scatters.
#[must_use]
pub fn after(problem: &Problem, node: &Node, scattering: &[Scatterer]) -> Weights {
    Left::of(problem, node, scattering).weights(scattering)
}

/// What a fit leaves of each pose, in the mean of its readings.
#[must_use]
pub fn left(problem: &Problem, node: &Node, scattering: &[Scatterer]) -> Vec<Rest> {
    let all = Left::of(problem, node, scattering);
    let (residuals, _) = all.without(scattering);
    let of = |readings: &Readings| Rest {
        square: readings.norm_squared() / readings.ncols() as f64,
        equations: readings.nrows(),
        count: 1.0,
    };
    readings(&all.poses, &residuals).iter().map(of).collect()
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
    let sources: Vec<Scatterer> = scattering.iter().map(|own| own.0).collect();
    let ratios: Vec<(usize, f64)> = scattering.iter().map(|own| own.1).enumerate().collect();
    let rest = |(row, count): (&usize, f64)| {
        let residual = Moved::of(&at, problem, *row, &sources).without(&ratios);
        let square = residual.iter().map(|x| x * x).sum();
        Rest { square, equations: residual.len(), count }
    };
    let counts = counted(problem, &rows, common);
    let mut kept: Vec<Rest> = rows.iter().zip(counts).map(rest).collect();
    let flagged = kept.split_off(node.fit.kept.len());
    [kept, flagged]
}

/// Fewer readings of poses read before tell nothing of what returns with the pose.
const REPEATED: usize = 10;
/// Fewer tell too little of how large a scatter is. Of a UR10 whose curves and springs are not all
/// of its errors four joints scattered by twice what did not return, and rows weighed so lost a
/// spring to a gain and a coupling. No study set it.
const RETURNED: usize = 100;

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
    repeats::scatter(&readings, Used { means: used, apart: 0.0 })
}
