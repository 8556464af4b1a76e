//! What scatters by itself: the noise of a row is larger the way that moves its target.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

use super::Sheet;
use crate::evidence::directed::{Seen, whiten};
use crate::identify::certainty::directed::{columns, ways};
use crate::identify::{Linearised, Problem, Scatterer, State};
use crate::model::Values;
use crate::model::arm::Derivatives;

/// How each of some sources moves the target of a row, in stated sigmas a rad or m: a column for
/// each place where the arm stood for it or each axis of a sight.
#[derive(Debug, Clone)]
pub struct Moved {
    /// The columns of one source after the other, then the row's residual.
    wide: DMatrix<f64>,
    /// Where the columns of each end.
    ends: Vec<usize>,
}

impl Moved {
    /// A row's.
    #[must_use]
    pub fn of(at: &Linearised, problem: &Problem, index: usize, sources: &[Scatterer]) -> Self {
        // Of most arms nothing scatters: no row has to be linearised for it.
        if sources.is_empty() {
            let residual = at.scaled_residual(index);
            let wide = DMatrix::from_column_slice(residual.len(), 1, &residual);
            return Self { wide, ends: Vec::new() };
        }
        let all = || sources.iter().copied();
        let e = at.equations_beside(index, &|i, d| ways(problem, all(), index, (i, d)));
        let (_, each) = columns(problem, all(), index, &e.block);
        let widths = each.iter().map(DMatrix::ncols);
        let ends: Vec<usize> = widths
            .scan(0, |end, width| {
                *end += width;
                Some(*end)
            })
            .collect();
        let residual = e.scaled_residual();
        let columns = each.iter().flat_map(|own| own.iter());
        let all: Vec<f64> = columns.chain(residual.iter()).copied().collect();
        Self { wide: DMatrix::from_vec(residual.len(), ends.last().unwrap_or(&0) + 1, all), ends }
    }

    fn columns(&self, source: usize) -> Range<usize> {
        let first = source.checked_sub(1).map_or(0, |before| self.ends[before]);
        first..self.ends[source]
    }

    /// The columns of one and the residual, both without what others scatter, each at its place
    /// among the sources and with its ratio of variance.
    #[must_use]
    pub fn beside(&self, source: usize, others: &[(usize, f64)]) -> (DMatrix<f64>, Values) {
        self.apart(self.columns(source), others)
    }

    /// The residual without what these scatter.
    #[must_use]
    pub fn without(&self, others: &[(usize, f64)]) -> Values {
        self.apart(0..0, others).1
    }

    fn apart(&self, own: Range<usize>, others: &[(usize, f64)]) -> (DMatrix<f64>, Values) {
        let last = self.wide.ncols() - 1;
        let residual = Values::from_fn(self.wide.nrows(), |i| self.wide[(i, last)]);
        let group = |&(source, ratio): &(usize, f64)| {
            let own = self.columns(source);
            (self.wide.columns(own.start, own.len()).into_owned(), ratio)
        };
        let own = self.wide.columns(own.start, own.len()).into_owned();
        apart(own, residual, others.iter().map(group))
    }
}

/// A row, as noise sees it that is larger the way of such a source; nothing of a row that does
/// not tell it.
#[must_use]
pub fn seen(source: Scatterer, ways: &DMatrix<f64>, residual: &Values) -> Vec<Seen> {
    let tells = match source {
        // What both ends of a pair scatter is not told apart.
        Scatterer::Joint(_) => ways.ncols() == 1,
        Scatterer::Sight(_) | Scatterer::Range(_) => ways.ncols() > 0,
    };
    let seen = || Seen::each(ways, &DVector::from_column_slice(residual));
    if tells { seen() } else { Vec::new() }
}

impl Sheet<'_> {
    /// Columns of the joints that scatter, behind all others of a row.
    pub(super) fn scattered(&self, index: usize, i: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let sources = self.weights.scattering.iter().map(|scattering| scattering.0);
        ways(self.problem, sources, index, (i, d))
    }

    /// A row's equations and its residual without those columns, multiplied by the root of
    /// the inverse covariance that all which scatters makes.
    pub(super) fn beside_scatter(
        &self,
        block: DMatrix<f64>,
        residual: Values,
        index: usize,
    ) -> (DMatrix<f64>, Values) {
        let scattering = &self.weights.scattering;
        if scattering.is_empty() {
            return (block, residual);
        }
        let (own, each) = columns(self.problem, scattering.iter().map(|s| s.0), index, &block);
        apart(own, residual, each.into_iter().zip(scattering.iter().map(|s| s.1)))
    }
}

/// Equations and a residual without noise along directions, each a group of columns and the ratio
/// of their variance: what is left is the same every way.
fn apart(
    block: DMatrix<f64>,
    residual: Values,
    groups: impl Iterator<Item = (DMatrix<f64>, f64)>,
) -> (DMatrix<f64>, Values) {
    let own = block.ncols();
    let mut wide = block.insert_column(own, 0.0);
    residual.iter().enumerate().for_each(|(i, r)| wide[(i, own)] = *r);
    let mut ratios = Vec::new();
    for (ways, ratio) in groups {
        let at = wide.ncols();
        wide = wide.insert_columns(at, ways.ncols(), 0.0);
        wide.columns_mut(at, ways.ncols()).copy_from(&ways);
        ratios.extend(std::iter::repeat_n(ratio, ways.ncols()));
    }
    for (k, ratio) in ratios.iter().enumerate() {
        let way: DVector<f64> = wide.column(own + 1 + k).into_owned();
        whiten(&mut wide, &way, *ratio);
    }
    let residual = Values::from_fn(wide.nrows(), |i| wide[(i, own)]);
    (wide.remove_columns(own, ratios.len() + 1), residual)
}

/// What scatters by itself makes of the noise of rows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Scattered {
    /// `log |V|`.
    pub log_det: f64,
    /// Variance by them over the other variance, summed over the equations...
    more: f64,
    /// ...which are so many.
    equations: usize,
}

impl Scattered {
    /// Of rows that this scatters.
    #[must_use]
    pub fn of(problem: &Problem, state: &State, rows: &[usize], all: &[(Scatterer, f64)]) -> Self {
        let at = problem.linearise(state);
        let sources: Vec<Scatterer> = all.iter().map(|own| own.0).collect();
        let ratios: Vec<(usize, f64)> = all.iter().map(|own| own.1).enumerate().collect();
        let of_row = |row: &usize| Self::of_row(&Moved::of(&at, problem, *row, &sources), &ratios);
        Self::sum(rows.par_iter().map(of_row))
    }

    /// Of a row that is so moved by some sources and scattered by these, each at its place among
    /// them.
    #[must_use]
    pub fn of_row(moved: &Moved, all: &[(usize, f64)]) -> Self {
        let of_source = |(k, (source, ratio)): (usize, &(usize, f64))| {
            let (ways, _) = moved.beside(*source, &[]);
            let (beside, _) = moved.beside(*source, &all[..k]);
            let more = beside.tr_mul(&beside) * *ratio;
            let log_det = (DMatrix::identity(more.nrows(), more.nrows()) + more).determinant().ln();
            Self { log_det, more: ratio * ways.norm_squared(), equations: ways.nrows() }
        };
        let each = all.iter().enumerate().map(of_source);
        each.fold(Self::default(), |sum, own| Self { equations: own.equations, ..sum.plus(own) })
    }

    /// In the order of rows, whatever the number of threads.
    fn sum(rows: impl IndexedParallelIterator<Item = Self>) -> Self {
        rows.collect::<Vec<_>>().into_iter().fold(Self::default(), Self::plus)
    }

    fn plus(self, other: Self) -> Self {
        Self {
            log_det: self.log_det + other.log_det,
            more: self.more + other.more,
            equations: self.equations + other.equations,
        }
    }

    /// How many times the other noise all of it is together, as a root mean square over the
    /// equations.
    #[must_use]
    pub fn together(&self) -> f64 {
        (1.0 + self.more / self.equations.max(1) as f64).sqrt()
    }
}
