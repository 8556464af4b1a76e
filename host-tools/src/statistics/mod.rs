//! Statistics of residuals, said alike wherever errors of points are reported.

pub mod repeats;

use schemars::JsonSchema;
use serde::Serialize;

use crate::observations::Miss;
use crate::units::to_mm;

/// Distances between measured and predicted points, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Stats {
    /// Mean.
    pub mean_mm: f64,
    /// Root mean square.
    pub rms_mm: f64,
    /// Largest.
    pub max_mm: f64,
    /// Sample standard deviation.
    pub sd_mm: f64,
}

impl Stats {
    /// Of how far off things are; `None` of none.
    #[must_use]
    pub fn of(residuals: impl IntoIterator<Item = impl Miss>) -> Option<Self> {
        let d: Vec<f64> = residuals.into_iter().map(|r| to_mm(r.miss())).collect();
        let n = d.len() as f64;
        if d.is_empty() {
            return None;
        }
        let mean = d.iter().sum::<f64>() / n;
        let square = |about: f64| d.iter().map(|x| (x - about).powi(2)).sum::<f64>();
        Some(Self {
            mean_mm: mean,
            rms_mm: (square(0.0) / n).sqrt(),
            max_mm: d.iter().copied().fold(0.0, f64::max),
            sd_mm: (square(mean) / (n - 1.0).max(1.0)).sqrt(),
        })
    }
}

/// Measured points to leave out on their own evidence: beyond 10 robust standard
/// deviations, the worst first, at most 1 % of them.
#[must_use]
pub fn points_apart(residuals: &[impl Miss]) -> Vec<usize> {
    let d: Vec<f64> = residuals.iter().map(Miss::miss).collect();
    let scale = robust_distance_scale(&d);
    let mut rows: Vec<usize> = (0..d.len()).filter(|i| d[*i] > 10.0 * scale).collect();
    rows.sort_by(|a, b| d[*b].total_cmp(&d[*a]));
    rows.truncate(d.len() / 100);
    rows.sort_unstable();
    rows
}

/// Standard deviation of one coordinate from the median of 3-D distances.
#[must_use]
pub fn robust_distance_scale(distances: &[f64]) -> f64 {
    // Median of the chi distribution with three degrees of freedom.
    median(distances) / 1.538_172
}

/// Middle value; 0 of nothing.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let (half, even) = (values.len() / 2, values.len().is_multiple_of(2));
    if values.is_empty() {
        return 0.0;
    }
    let (below, middle, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    match below.iter().copied().max_by(f64::total_cmp) {
        Some(before) if even => (before + *middle) / 2.0,
        _ => *middle,
    }
}

/// Robust standard deviation of values about zero.
#[must_use]
pub fn mad_scale(values: &[f64]) -> f64 {
    1.4826 * median(&values.iter().map(|v| v.abs()).collect::<Vec<_>>())
}
