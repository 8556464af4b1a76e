//! Improving a design one measurement at a time.

use std::borrow::Cow;

use nalgebra::{DMatrix, Matrix3, Matrix6};

use super::design::{Aim, Design, factor, inverse_of};
use super::leading::Leading;

const MOST_SWEEPS: usize = 20;
/// A candidate is better by more than this share of its gain, or the one that is there stays.
const BETTER: f64 = 1e-9;

impl Design {
    /// Improves a design by exchanging one measurement at a time for the candidate that
    /// is best by an aim, until none is better. The design and how good it is. `progress` is
    /// told the sweep, from 1.
    #[must_use]
    pub fn exchange(
        &self,
        start: Vec<usize>,
        aim: &Aim,
        progress: &dyn Fn(usize),
    ) -> (Vec<usize>, f64) {
        let mut open = vec![true; self.candidates()];
        start.iter().for_each(|k| open[*k] = false);
        let mut search = Search { design: self, aim, chosen: start, open, leading: None };
        let count = search.chosen.len();
        let mut unchanged = 0;
        for step in 0..MOST_SWEEPS * count {
            progress(step / count + 1);
            unchanged = if search.improve(step % count) { 0 } else { unchanged + 1 };
            if unchanged == count {
                break;
            }
        }
        let good = self.good(&search.chosen, aim);
        (search.chosen, good)
    }

    /// What adding each of some candidates, or of all, is worth by an aim to a set whose
    /// information has this inverse.
    fn gains(&self, inverse: &DMatrix<f64>, aim: &Aim, of: Option<&[usize]>) -> Vec<f64> {
        let width = self.width();
        let blocks = match of {
            None => Cow::Borrowed(&self.blocks),
            Some(of) => Cow::Owned(self.blocks_of(of)),
        };
        let weighed = inverse * &*blocks;
        let pulled = match aim {
            Aim::Determinant => DMatrix::zeros(0, 0),
            Aim::Variance(weights) => weights * &weighed,
        };
        let gain = |first: usize| {
            let own = |c: usize, d: usize| weighed.column(first + c).dot(&blocks.column(first + d));
            match aim {
                Aim::Determinant => determinant(width, own),
                Aim::Variance(_) => less_variance(width, own, |c, d| {
                    weighed.column(first + c).dot(&pulled.column(first + d))
                }),
            }
        };
        (0..blocks.ncols()).step_by(width).map(gain).collect()
    }
}

/// An exchange on its way.
struct Search<'a> {
    design: &'a Design,
    aim: &'a Aim,
    chosen: Vec<usize>,
    /// Candidates that are not chosen.
    open: Vec<bool>,
    leading: Option<Leading>,
}

impl Search<'_> {
    /// Exchanges the measurement of a place for the best; whether another one is.
    fn improve(&mut self, place: usize) -> bool {
        let now = self.chosen[place];
        self.open[now] = true;
        let best = self.best_at(place);
        self.open[best] = false;
        self.chosen[place] = best;
        best != now
    }

    /// The candidate that is best at a place; the one that is there if none is better.
    fn best_at(&mut self, place: usize) -> usize {
        let mut others = self.chosen.clone();
        let now = others.remove(place);
        let factor = factor(self.design.information(&others));
        let inverse = inverse_of(factor.as_ref(), self.design.parameters());
        let gains = |of: &[usize]| self.design.gains(&inverse, self.aim, Some(of));
        let leading = self.leading.as_ref();
        let few = leading.and_then(|l| l.candidates(&inverse, (&self.open, now), gains));
        if let Some(few) = few {
            let own = gains(&few);
            return best(few.into_iter().zip(own), now);
        }
        let all = self.design.gains(&inverse, self.aim, None);
        let best = best(all.iter().copied().enumerate().filter(|(k, _)| self.open[*k]), now);
        if let (Aim::Determinant, Some(factor)) = (self.aim, factor) {
            self.leading = Some(Leading::new(factor.l(), &all));
        }
        best
    }
}

/// The candidate whose gain is largest; `now`, which is one of them, if none is better.
fn best(gains: impl Iterator<Item = (usize, f64)> + Clone, now: usize) -> usize {
    let own = gains.clone().find(|(k, _)| *k == now).map_or(0.0, |(_, gain)| gain);
    let better = |best: (usize, f64), next: (usize, f64)| if next.1 > best.1 { next } else { best };
    gains.fold((now, own * (1.0 + BETTER)), better).0
}

/// By how much a measurement lowers the sum of variances that `pulled` is of: the trace of
/// `(1 + own)^-1 pulled`.
fn less_variance(
    size: usize,
    own: impl Fn(usize, usize) -> f64,
    pulled: impl Fn(usize, usize) -> f64,
) -> f64 {
    if size == 1 {
        return pulled(0, 0) / (1.0 + own(0, 0));
    }
    let more = DMatrix::identity(size, size) + DMatrix::from_fn(size, size, own);
    let pulled = DMatrix::from_fn(size, size, pulled);
    more.cholesky().map_or(0.0, |more| more.solve(&pulled).trace())
}

/// Of the identity and a matrix.
fn determinant(size: usize, of: impl Fn(usize, usize) -> f64) -> f64 {
    match size {
        1 => 1.0 + of(0, 0),
        3 => (Matrix3::identity() + Matrix3::from_fn(of)).determinant(),
        6 => (Matrix6::identity() + Matrix6::from_fn(of)).determinant(),
        _ => (DMatrix::identity(size, size) + DMatrix::from_fn(size, size, of)).determinant(),
    }
}
