//! What is measured beyond what is modelled, in the components of a kind.

use std::ops::{Deref, Div, Mul, Sub};

use nalgebra::Vector3;

use super::{Measure, Seen, kind, of};
use crate::model::{KindId, Row, Values};

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

    /// What a component is measured in.
    #[must_use]
    pub fn measure(&self, component: usize) -> Measure {
        of(self.kind).measure(component)
    }

    /// The numbers in the units of files: mm, degrees, px.
    #[must_use]
    pub fn in_files(&self) -> Vec<f64> {
        self.iter().enumerate().map(|(c, v)| self.measure(c).to_file(*v)).collect()
    }

    /// Whether it says how far off something is: angles and pixels do not.
    #[must_use]
    pub fn is_length(&self) -> bool {
        (0..self.len()).any(|c| self.measure(c) == Measure::Length)
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

impl<T: Miss> Miss for &T {
    fn miss(&self) -> f64 {
        (*self).miss()
    }
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
