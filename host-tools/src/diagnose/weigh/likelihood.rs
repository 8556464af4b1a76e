//! How likely what a fit leaves is beside what scatters: readings of a pose say together how
//! poses scatter, and how they differ what each reading does by itself.

use nalgebra::DVector;

use super::sheet::{Scattered, Weights};
use super::weights::Left;
use crate::evidence::tails::{Rest, Tails};
use crate::identify::Scatterer;
use crate::model::Row;
use crate::observations::{repeat, visits};

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
    fn push_contrasts(&mut self, readings: &[Read]) {
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
        let (rows, kept) = (&self.problem.data.rows, &self.node.fit.kept);
        let mut sums = Sums::new(self, weights);
        for places in &self.poses {
            let own: Vec<usize> = places.iter().map(|k| kept[*k]).collect();
            match repeat(rows, &own) {
                true => sums.push_repeats(rows, places, &own),
                false => sums.push_targets(places),
            }
        }
        let Sums { poses, stayed, returned, more, .. } = sums;
        let equations: f64 = poses.rests.iter().map(|r| r.equations as f64 * r.count).sum();
        let tails = Tails::of(&poses.rests, self.node.fit.used.min(equations));
        let apart = stayed.likelihood() + returned.likelihood();
        Likelihood {
            whole: tails.log_likelihood(&poses.rests, 1.0) - 0.5 * poses.log_det + apart,
            beside: apart - 0.5 * (poses.log_det + more),
        }
    }
}

/// A residual without what scatters, and its `log |V|`.
type Read = (DVector<f64>, f64);

/// Sums over poses.
struct Sums<'l> {
    left: &'l Left<'l>,
    /// What scatters, with the ratio of its variance to that of what it scatters beside.
    all: Vec<(usize, f64)>,
    /// The same beside what readings of a pose do not have in common: what scatters does not
    /// return with the pose.
    apart: Vec<(usize, f64)>,
    /// Of these what an instrument does, which scatters while the arm stays, too.
    instrument: Vec<(usize, f64)>,
    /// Share of the variance that readings of a pose have in common.
    common: f64,
    poses: Part,
    /// Readings about their mean, while the arm stayed and where it came back.
    stayed: Part,
    returned: Part,
    /// `log |V|` that the evidence lacks beyond that of the poses.
    more: f64,
}

impl<'l> Sums<'l> {
    fn new(left: &'l Left<'l>, weights: &Weights) -> Self {
        let Weights { common, scattering, .. } = weights;
        let apart = |(source, ratio): &(Scatterer, f64)| (*source, ratio / (1.0 - common));
        let apart: Vec<_> = scattering.iter().map(apart).collect();
        let of_instrument = apart.iter().filter(|s| s.0.instrument().is_some()).copied();
        Self {
            all: left.placed(scattering),
            instrument: left.placed(&of_instrument.collect::<Vec<_>>()),
            apart: left.placed(&apart),
            left,
            common: *common,
            poses: Part::default(),
            stayed: Part::default(),
            returned: Part::default(),
            more: 0.0,
        }
    }

    fn read(&self, place: usize, sources: &[(usize, f64)]) -> Read {
        let moved = &self.left.rows[place];
        let log_det = Scattered::of_row(moved, sources).log_det;
        (DVector::from_column_slice(&moved.without(sources)), log_det)
    }

    /// How many times one reading's variance the mean of so many has, times their number.
    fn together(&self, readings: usize) -> f64 {
        1.0 - self.common + readings as f64 * self.common
    }

    /// Several targets, or corners of an image: the evidence knows every equation.
    fn push_targets(&mut self, places: &[usize]) {
        let together = self.together(places.len());
        let mut equations = 0;
        for place in places {
            let (residual, log_det) = self.read(*place, &self.all);
            let (square, count) = (residual.norm_squared(), 1.0 / together);
            equations = residual.len();
            self.poses.rests.push(Rest { square, equations, count });
            self.poses.log_det += log_det * count;
            self.more += log_det * (1.0 - count);
        }
        let others = (places.len() as f64 - 1.0) * (1.0 - self.common).ln();
        self.more += equations as f64 * (together.ln() + others);
    }

    /// Readings of one thing in a pose.
    fn push_repeats(&mut self, rows: &[Row], places: &[usize], own: &[usize]) {
        let together = self.together(places.len());
        let readings: Vec<Read> = places.iter().map(|k| self.read(*k, &self.all)).collect();
        let (mean, log_det) = mean(&readings);
        let log_det = log_det + mean.len() as f64 * together.ln();
        let square = mean.norm_squared() * places.len() as f64 / together;
        self.poses.push(&mean, square, log_det);
        let visits = visits(rows, own);
        let read = |visit: &[usize], sources: &[(usize, f64)]| {
            visit.iter().map(|k| self.read(places[*k], sources)).collect::<Vec<Read>>()
        };
        let alone: Vec<_> = visits.iter().map(|visit| read(visit, &self.instrument)).collect();
        let each: Vec<Read> =
            visits.iter().map(|visit| self::mean(&read(visit, &self.apart))).collect();
        alone.iter().for_each(|readings| self.stayed.push_contrasts(readings));
        self.returned.push_contrasts(&each);
    }
}

/// Of some readings the mean, and the mean of their `log |V|`: they scatter alike.
fn mean(readings: &[Read]) -> Read {
    let each = 1.0 / readings.len() as f64;
    let sum =
        readings[1..].iter().fold(readings[0].clone(), |sum, own| (sum.0 + &own.0, sum.1 + own.1));
    (sum.0 * each, sum.1 * each)
}
