//! Error curves of joints: smooth functions of the joint angle that stand beside
//! geometry under a prior of their own.

pub mod choice;
pub mod worth;

use nalgebra::DVector;

use crate::evidence::Geometry;
use crate::evidence::smooth::{self, Prior};
use crate::model::ErrorCurve;

/// Nodes of a table: with 64 a real arm loses a third, with 256 nothing.
const NODES: usize = 256;
/// Angles at which a band is asked for.
const LOOKS: usize = 40;

/// A joint, counted from 0, and the prior of its curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// Counted from 0.
    pub joint: usize,
    /// Length and size.
    pub prior: Prior,
}

impl Curve {
    /// Orders of its series.
    #[must_use]
    pub fn orders(&self) -> usize {
        smooth::orders(self.prior.length)
    }

    /// Values of its columns at an angle.
    #[must_use]
    pub fn basis(&self, angle: f64) -> Vec<f64> {
        smooth::basis(self.orders(), angle)
    }

    /// The table of coefficients; `None` of what no controller takes.
    #[must_use]
    pub fn table(&self, coefficients: &[f64], band: f64) -> Option<ErrorCurve> {
        let value = |angle: f64| {
            let basis = self.basis(angle);
            basis.iter().zip(coefficients).map(|(b, c)| b * c).sum()
        };
        let joint = u8::try_from(self.joint).ok()?;
        ErrorCurve::of_function(joint, NODES, band.min(0.05), value).ok().map(|(curve, _)| curve)
    }
}

/// Columns of curves.
#[must_use]
pub fn columns(curves: &[Curve]) -> usize {
    curves.iter().map(|c| 2 * c.orders()).sum()
}

/// Standard deviation of a curve, RMS over the angles that were measured; its
/// columns stand at `first` in geometry.
#[must_use]
pub fn band(
    curve: &Curve,
    angles: impl ExactSizeIterator<Item = f64>,
    geometry: &Geometry,
    first: usize,
) -> f64 {
    let every = angles.len().div_ceil(LOOKS).max(1);
    let squares: Vec<f64> = angles
        .step_by(every)
        .map(|angle| {
            let mut at = DVector::zeros(geometry.unknowns());
            for (k, value) in curve.basis(angle).into_iter().enumerate() {
                at[first + k] = value;
            }
            geometry.variance(&at)
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}
