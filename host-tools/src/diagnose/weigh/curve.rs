//! Error curves of joints: smooth functions of the joint angle that stand beside
//! geometry under a prior of their own.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::evidence::Geometry;
use crate::evidence::smooth::{self, Prior};
use crate::model::ErrorCurve;

/// Nodes of a table: with 64 a real arm loses a third, with 256 nothing.
const NODES: usize = 256;
/// Angles at which a band is asked for.
const LOOKS: usize = 40;
/// A curve is known where the data take away this share of its prior's variance.
const KNOWN: f64 = 0.5;
/// So many poses in a stretch and the two beside it tell it without being asked.
const ENOUGH: usize = 8;

/// A joint that errs by a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// Counted from 0.
    pub joint: usize,
    /// Length and size.
    pub prior: Prior,
    /// Log odds of a few waves of whole orders in its place.
    pub few: f64,
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

    /// The table of coefficients, not known in these stretches between its nodes; `None` of
    /// what no controller takes.
    #[must_use]
    pub fn table(&self, coefficients: &[f64], band: f64, gaps: &[usize]) -> Option<ErrorCurve> {
        let value = |angle: f64| {
            let basis = self.basis(angle);
            basis.iter().zip(coefficients).map(|(b, c)| b * c).sum()
        };
        let joint = u8::try_from(self.joint).ok()?;
        let (table, _) = ErrorCurve::of_function(joint, NODES, band.min(0.05), value).ok()?;
        table.with_gaps(self.prior.size, gaps).ok()
    }

    /// Its variance at some angles; its columns stand at `first` in geometry.
    fn variances(&self, angles: &[f64], geometry: &Geometry, first: usize) -> Vec<f64> {
        let mut at = DMatrix::zeros(geometry.unknowns(), angles.len());
        for (mut column, angle) in at.column_iter_mut().zip(angles) {
            column.rows_mut(first, 2 * self.orders()).copy_from_slice(&self.basis(*angle));
        }
        geometry.variances(at)
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
pub fn band(curve: &Curve, angles: &[f64], geometry: &Geometry, first: usize) -> f64 {
    let every = angles.len().div_ceil(LOOKS).max(1);
    let looks: Vec<f64> = angles.iter().copied().step_by(every).collect();
    let squares = curve.variances(&looks, geometry, first);
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// Stretches between the nodes of its table, within the range of the angles that were
/// measured, where a curve is hardly known better than its prior knows it.
#[must_use]
pub fn gaps(curve: &Curve, angles: &[f64], geometry: &Geometry, first: usize) -> Vec<usize> {
    let place = |angle: f64| (angle * NODES as f64 / TAU).floor();
    let stretch = |place: f64| place.rem_euclid(NODES as f64) as usize % NODES;
    let mut rows = [0; NODES];
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for angle in angles {
        let place = place(*angle);
        rows[stretch(place)] += 1;
        (low, high) = (low.min(place), high.max(place));
    }
    let count = ((high - low).max(0.0) as usize + 1).min(NODES);
    let most = (1.0 - KNOWN) * curve.prior.size.powi(2);
    let few = |k: &usize| {
        let near: usize = [NODES - 1, 0, 1].iter().map(|by| rows[(k + by) % NODES]).sum();
        near < ENOUGH
    };
    let asked: Vec<usize> = (0..count).map(|k| stretch(low + k as f64)).filter(few).collect();
    let middle = |k: &usize| (*k as f64 + 0.5) * TAU / NODES as f64;
    let middles: Vec<f64> = asked.iter().map(middle).collect();
    let variances = curve.variances(&middles, geometry, first);
    asked.into_iter().zip(variances).filter(|(_, v)| *v > most).map(|(k, _)| k).collect()
}
