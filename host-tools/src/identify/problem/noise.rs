//! How much noisier each kind of measurement is than stated.

use crate::model::{KindId, Measurements, Row, Values};
use crate::observations::{KINDS, Measure, Residual, equations_of, kind};

/// Measures in the order of [`Noise`].
const MEASURES: [Measure; 3] = [Measure::Length, Measure::Angle, Measure::Pixel];

/// By how much the noise of each component of each kind is larger than stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise([[f64; 3]; KINDS.len()]);

impl Default for Noise {
    fn default() -> Self {
        Self([[1.0; 3]; KINDS.len()])
    }
}

impl Noise {
    /// Of a component of a row's kind.
    #[must_use]
    pub fn of(&self, kind: KindId, measure: Measure) -> f64 {
        let place = MEASURES.iter().position(|m| *m == measure).unwrap_or(0);
        self.0[usize::from(kind.0)][place]
    }

    /// Standard deviations of a row's components, SI; none where it gives no equation.
    #[must_use]
    pub fn sigmas(&self, row: &Row) -> Values {
        let own = kind(row);
        let stated = own.sigmas(row);
        let sigma = |c: usize| stated[c] * self.of(row.kind, own.measure(c));
        Values::from_fn(equations_of(row), sigma)
    }

    /// The largest of those that a file has.
    #[must_use]
    pub fn largest(&self, data: &Measurements) -> f64 {
        groups(data).into_iter().map(|g| self.of(g.kind, g.measure)).fold(0.0, f64::max)
    }

    /// The geometric mean of those that a file has, each equation counted once.
    #[must_use]
    pub fn middle(&self, data: &Measurements) -> f64 {
        let of = |g: Group| {
            let count: usize = data.rows.iter().map(|row| g.components(row).count()).sum();
            (count as f64, count as f64 * self.of(g.kind, g.measure).ln())
        };
        let sums = groups(data).into_iter().map(of);
        let (count, sum) = sums.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        (sum / f64::max(count, 1.0)).exp()
    }

    /// Over another, of each component of each kind that a file has.
    #[must_use]
    pub fn over(&self, other: &Self, data: &Measurements) -> Vec<f64> {
        let ratio = |g: Group| self.of(g.kind, g.measure) / other.of(g.kind, g.measure);
        groups(data).into_iter().map(ratio).collect()
    }

    pub(in crate::identify) fn scale_mut(&mut self, group: Group) -> &mut f64 {
        let place = MEASURES.iter().position(|m| *m == group.measure).unwrap_or(0);
        &mut self.0[usize::from(group.kind.0)][place]
    }
}

/// A residual of a row in standard deviations.
#[must_use]
pub fn in_deviations(residual: &Residual, row: &Row, noise: &Noise) -> Values {
    residual.values().zip_map(&noise.sigmas(row), |r, sigma| r / sigma)
}

/// Components of one kind in one unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Group {
    pub kind: KindId,
    pub measure: Measure,
}

impl Group {
    /// Components of a row that belong to it.
    pub fn components(self, row: &Row) -> impl Iterator<Item = usize> {
        let count = if row.kind == self.kind { equations_of(row) } else { 0 };
        (0..count).filter(move |c| KINDS[usize::from(self.kind.0)].measure(*c) == self.measure)
    }
}

/// Those that a file has, in the order of the table.
pub(crate) fn groups(data: &Measurements) -> Vec<Group> {
    let mut kinds: Vec<KindId> = data.rows.iter().map(|row| row.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let of = |kind: KindId| MEASURES.map(|measure| Group { kind, measure });
    let has = |g: &Group| data.rows.iter().any(|row| g.components(row).next().is_some());
    kinds.into_iter().flat_map(of).filter(has).collect()
}
