//! Axes: what they count, and where their ticks stand.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

/// An axis.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// What it counts, with its unit.
    pub label: String,
    /// Decades.
    pub log: bool,
    /// Values stand for themselves: the axis need not start at zero.
    pub signed: bool,
    /// Names of 1, 2, 3... instead of numbers.
    pub names: Vec<String>,
}

impl Axis {
    /// Linear.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// Linear, as wide as the values.
    pub fn signed(label: impl Into<String>) -> Self {
        Self { signed: true, ..Self::linear(label) }
    }

    /// Logarithmic; values from zero down are left out.
    pub fn log(label: impl Into<String>) -> Self {
        Self { log: true, ..Self::linear(label) }
    }

    /// Categories at 1, 2, 3...
    pub fn names(names: Vec<String>) -> Self {
        Self { names, ..Self::default() }
    }

    pub(super) fn place(&self, value: f64) -> f64 {
        if self.log { value.log10() } else { value }
    }

    /// Where ticks stand.
    pub(super) fn ticks(&self, range: &Range<f64>) -> Vec<f64> {
        let within = |v: &f64| (range.start..=range.end).contains(v);
        if !self.names.is_empty() {
            return (1..=self.names.len()).map(|k| k as f64).filter(within).collect();
        }
        let width = range.end - range.start;
        if self.log {
            // Every decade, or every few; between them 2 and 5 where there is room.
            let step = (width / 10.0).ceil().max(1.0);
            let first = (range.start / step).floor() as i64;
            let last = (range.end / step).ceil() as i64;
            let parts: &[f64] = if width < 3.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
            let decade = |k: i64| parts.iter().map(move |p| k as f64 * step + p.log10());
            return (first..=last).flat_map(decade).filter(within).collect();
        }
        let rough = width / 8.0;
        let size = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * size).into_iter().find(|s| *s >= rough);
        let step = step.unwrap_or(rough);
        let (first, last) = ((range.start / step).ceil() as i64, (range.end / step).floor() as i64);
        (first..=last).map(|k| k as f64 * step).collect()
    }

    pub(super) fn tick(&self, value: f64) -> String {
        if !self.names.is_empty() {
            let name = self.names.get((value.round() as usize).saturating_sub(1));
            return name.cloned().unwrap_or_default();
        }
        let shown = if self.log { 10_f64.powf(value) } else { value };
        match shown.abs() {
            x if x < 1e-12 && !self.log => "0".to_owned(),
            x if !(0.999e-3..1e5).contains(&x) => format!("{shown:.0e}"),
            // No trailing zeros of rounding.
            _ => format!("{}", (shown * 1e4).round() / 1e4),
        }
    }
}

/// A range with its own ticks.
pub(super) struct Ticked {
    pub range: Range<f64>,
    pub ticks: Vec<f64>,
}

impl Ranged for Ticked {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, _: H) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}
