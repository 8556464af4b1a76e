//! How likely what a fit leaves is beside what scatters: readings of a pose say together how
//! poses scatter, and how they differ what each reading does by itself.

use nalgebra::DVector;

use super::sheet::{Scattered, Weights};
use super::weights::Left;
use crate::evidence::tails::{Rest, Tails};
use crate::identify::Scatterer;
use crate::model::Row;
use crate::observations::{by_pose, repeat};

/// Log likelihoods up to a constant of the rows.
#[derive(Debug, Clone, Copy)]
pub struct Likelihood {
    /// Of all that is left, at the scale that fits best.
    pub whole: f64,
    /// What the evidence of a model lacks, which knows of readings of a pose what they say
    /// together, and no covariance.
    pub beside: f64,
}

/// Of some equations: squares of what is left of them, and `log |V|`.
#[derive(Default)]
struct Part {
    rests: Vec<Rest>,
    log_det: f64,
}

impl Part {
    fn push(&mut self, residual: &DVector<f64>, square: f64, log_det: f64) {
        self.rests.push(Rest { square, equations: residual.len(), count: 1.0 });
        self.log_det += log_det;
    }

    /// Of readings about their mean: contrasts of Helmert are as independent as they are.
    fn push_contrasts(&mut self, readings: &[(DVector<f64>, f64)]) {
        let Some(((first, _), others)) = readings.split_first() else { return };
        let mut mean = first.clone();
        for (k, (residual, log_det)) in others.iter().enumerate() {
            let before = (k + 1) as f64;
            let square = (residual - &mean).norm_squared() * before / (before + 1.0);
            self.push(residual, square, *log_det);
            mean += (residual - &mean) / (before + 1.0);
        }
    }

    fn likelihood(&self) -> f64 {
        if self.rests.is_empty() {
            return 0.0;
        }
        Tails::log_evidence(&self.rests, 0.0) - 0.5 * self.log_det
    }
}

impl Left<'_> {
    /// Under these weights.
    #[must_use]
    pub fn likelihood(&self, weights: &Weights) -> Likelihood {
        let rows = &self.problem.data.rows;
        let kept = &self.node.fit.kept;
        let all = self.placed(&weights.scattering);
        let sights: Vec<(Scatterer, f64)> =
            weights.scattering.iter().filter(|s| s.0.instrument().is_some()).copied().collect();
        let sights = self.placed(&sights);
        let read = |k: usize, sources: &[(usize, f64)]| {
            let residual = self.rows[k].without(sources);
            let log_det = Scattered::of_row(&self.rows[k], sources).log_det;
            (DVector::from_column_slice(&residual), log_det)
        };
        let common = weights.common;
        let (mut poses, mut stayed, mut returned) =
            (Part::default(), Part::default(), Part::default());
        // Of what is no repeat the evidence knows every equation.
        let mut more = 0.0;
        for places in by_pose(rows, kept) {
            let own: Vec<usize> = places.iter().map(|k| kept[*k]).collect();
            let readings: Vec<(DVector<f64>, f64)> =
                places.iter().map(|k| read(*k, &all)).collect();
            let count = readings.len() as f64;
            let equations = readings[0].0.len() as f64;
            let together = 1.0 - common + count * common;
            if !repeat(rows, &own) {
                for (residual, log_det) in &readings {
                    let rest = Rest {
                        square: residual.norm_squared(),
                        equations: residual.len(),
                        count: 1.0 / together,
                    };
                    poses.rests.push(rest);
                    poses.log_det += log_det / together;
                    more += log_det - log_det / together;
                }
                more += equations * (together.ln() + (count - 1.0) * (1.0 - common).ln());
                continue;
            }
            let (mean, log_det) = mean(&readings);
            let log_det = log_det + if count > 1.0 { equations * together.ln() } else { 0.0 };
            poses.push(&mean, mean.norm_squared() * count / together, log_det);
            let visits = visits(rows, &own);
            for visit in &visits {
                let alone = |k: &usize| read(places[*k], &sights);
                stayed.push_contrasts(&visit.iter().map(alone).collect::<Vec<_>>());
            }
            let of_visit = |visit: &Vec<usize>| {
                let own: Vec<_> = visit.iter().map(|k| readings[*k].clone()).collect();
                self::mean(&own)
            };
            returned.push_contrasts(&visits.iter().map(of_visit).collect::<Vec<_>>());
        }
        let equations: f64 = poses.rests.iter().map(|r| r.equations as f64 * r.count).sum();
        let tails = Tails::of(&poses.rests, self.node.fit.used.min(equations));
        let apart = stayed.likelihood() + returned.likelihood();
        Likelihood {
            whole: tails.log_likelihood(&poses.rests, 1.0) - 0.5 * poses.log_det + apart,
            beside: apart - 0.5 * (poses.log_det + more),
        }
    }
}

/// Of some readings the mean, and the mean of their `log |V|`: they scatter alike.
fn mean(readings: &[(DVector<f64>, f64)]) -> (DVector<f64>, f64) {
    let each = 1.0 / readings.len() as f64;
    let sum =
        readings[1..].iter().fold(readings[0].clone(), |sum, own| (sum.0 + &own.0, sum.1 + own.1));
    (sum.0 * each, sum.1 * each)
}

/// Readings of a pose, at each of its visits: what a joint scatters is the same until the arm has
/// been away.
fn visits(rows: &[Row], readings: &[usize]) -> Vec<Vec<usize>> {
    let mut out: Vec<Vec<usize>> = Vec::new();
    for (k, row) in readings.iter().enumerate() {
        let stays = |before: &usize| (*before..*row).all(|r| rows[r].pose == rows[*row].pose);
        match out.last_mut() {
            Some(visit) if stays(&readings[k - 1]) => visit.push(k),
            _ => out.push(vec![k]),
        }
    }
    out
}
