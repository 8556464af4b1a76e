//! What a row of a file measured: one interface, one file a kind.
//!
//! A kind gives, for one row, residuals and how what it measures moves with the
//! unknowns, their standard deviations, the names of its components and the
//! columns of the file that it reads. Nothing else knows how many equations a
//! row has. A new kind is a file here and a row of [`KINDS`].

#[cfg(test)]
mod distance;
mod point;
#[cfg(test)]
mod tests;

use std::ops::{Deref, Div, Mul, Sub};

use nalgebra::{DMatrix, Vector3};

use crate::model::{KindId, Row, Values};

/// All kinds. A row's [`KindId`] is the place of its kind here.
pub static KINDS: &[&dyn Kind] = &[
    &point::Point,
    #[cfg(test)]
    &distance::Distance,
];

/// A column of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Its name; the unit is its end: `_mm` becomes m, `_deg` rad, others stay.
    pub name: &'static str,
    /// No value is larger than this, SI.
    pub most: f64,
    /// What to do where it is missing.
    pub missing: &'static str,
    /// What to do where a value is larger.
    pub wrong: &'static str,
}

impl Column {
    /// One unit of the file in SI.
    #[must_use]
    pub fn unit(&self) -> f64 {
        match self.name.rsplit_once('_') {
            Some((_, "mm")) => 1e-3,
            Some((_, "deg")) => 1_f64.to_radians(),
            _ => 1.0,
        }
    }

    /// What is wrong with a value, in words.
    #[must_use]
    pub fn too_large(&self, value: f64) -> String {
        let unit = match self.name.rsplit_once('_') {
            Some((_, "mm")) => " m away",
            Some((_, "deg")) => " rad",
            _ => "",
        };
        format!("{value}{unit}")
    }
}

/// Where a model sees the targets of a file's rows.
pub trait Seen {
    /// A row of the file.
    fn row(&self, index: usize) -> &Row;
    /// Where its target is in the tracker frame, m.
    fn point(&self, index: usize) -> Vector3<f64>;
}

/// The same with derivatives.
pub trait Moving: Seen {
    /// Where the target of a row is, m, and how it moves with each of the
    /// unknowns asked for: 3 x any number.
    fn moved(&self, index: usize) -> (Vector3<f64>, DMatrix<f64>);
}

/// A kind of measurement. A row has as many equations as its kind components.
pub trait Kind: Sync {
    /// As in the column `kind`.
    fn name(&self) -> &'static str;

    /// The columns that it reads, all needed: [`Row::measured`] in this order.
    fn columns(&self) -> &'static [Column];

    /// Names of the residual's components, for flags and reports.
    fn components(&self) -> &'static [&'static str];

    /// Standard deviation of each component, SI.
    fn sigmas(&self, row: &Row) -> Values {
        Values::repeat(self.components().len(), row.sigma)
    }

    /// The point that was measured, m, for first guesses of frames and for
    /// pictures; `None` of a kind that measures none.
    fn point(&self, _row: &Row) -> Option<Vector3<f64>> {
        None
    }

    /// Measured minus modelled, SI.
    fn residual(&self, index: usize, seen: &dyn Seen) -> Values;

    /// The same with the derivatives of what is modelled: as many rows as
    /// components, as many columns as [`Moving::moved`] gives.
    fn linearised(&self, index: usize, seen: &dyn Moving) -> (Values, DMatrix<f64>);

    /// How far off noise alone makes it, root mean square, m.
    fn noise(&self, row: &Row) -> f64 {
        self.miss(&self.sigmas(row))
    }

    /// How far off a residual is, m: what statistics show.
    fn miss(&self, residual: &[f64]) -> f64 {
        residual.iter().map(|r| r * r).sum::<f64>().sqrt()
    }
}

/// The kind of a row.
#[must_use]
pub fn kind(row: &Row) -> &'static dyn Kind {
    of(row.kind)
}

fn of(id: KindId) -> &'static dyn Kind {
    KINDS[usize::from(id.0)]
}

/// The kind of this name.
#[must_use]
pub fn by_name(name: &str) -> Option<KindId> {
    let place = KINDS.iter().position(|kind| kind.name() == name)?;
    Some(KindId(place as u8))
}

/// Measured minus modelled of a row, one a component of its kind; SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    kind: KindId,
    values: Values,
}

impl Residual {
    /// Of a row.
    #[must_use]
    pub fn new(row: &Row, values: Values) -> Self {
        Self { kind: row.kind, values }
    }

    /// Of a row where a model sees it.
    #[must_use]
    pub fn of(index: usize, seen: &dyn Seen) -> Self {
        let row = seen.row(index);
        Self::new(row, kind(row).residual(index, seen))
    }

    /// Another one of the same row.
    #[must_use]
    pub fn with(&self, values: Values) -> Self {
        Self { values, ..*self }
    }

    /// How far off it is, m.
    #[must_use]
    pub fn norm(&self) -> f64 {
        of(self.kind).miss(&self.values)
    }

    /// Names of the components.
    #[must_use]
    pub fn components(&self) -> &'static [&'static str] {
        of(self.kind).components()
    }

    /// Of a kind with a point, its error.
    #[must_use]
    pub fn point(&self) -> Vector3<f64> {
        self.values.point()
    }

    /// The numbers.
    #[must_use]
    pub fn values(&self) -> &Values {
        &self.values
    }
}

impl Deref for Residual {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values
    }
}

impl Sub for Residual {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { values: self.values - other.values, ..self }
    }
}

impl Mul<f64> for Residual {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { values: self.values * factor, ..self }
    }
}

impl Div<f64> for Residual {
    type Output = Self;

    fn div(self, divisor: f64) -> Self {
        Self { values: self.values / divisor, ..self }
    }
}

impl std::fmt::Display for Residual {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.values)
    }
}

/// What statistics are made of: how far off something is, m.
pub trait Miss {
    /// m
    fn miss(&self) -> f64;
}

impl Miss for Residual {
    fn miss(&self) -> f64 {
        self.norm()
    }
}

impl Miss for Vector3<f64> {
    fn miss(&self) -> f64 {
        self.norm()
    }
}

/// How many equations some rows give.
#[must_use]
pub fn equations(rows: &[Row], of: &[usize]) -> usize {
    of.iter().map(|row| kind(&rows[*row]).components().len()).sum()
}
