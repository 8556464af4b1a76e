//! Axes: what they count, and where their ticks stand.

use std::ops::Range;

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
        match self.log {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value,
        }
    }

    /// Where ticks stand, about as many as there is room for, and what they say.
    pub(super) fn ticks(&self, range: &Range<f64>, room: usize) -> Vec<(f64, String)> {
        let within = |v: &f64| (range.start..=range.end).contains(v);
        if !self.names.is_empty() {
            let named = self.names.iter().enumerate().map(|(k, n)| (k as f64 + 1.0, n.clone()));
            return named.filter(|(at, _)| within(at)).collect();
        }
        if !self.log {
            return steps(range, room).into_iter().map(|v| (v.0, decimals(v.0, v.1))).collect();
        }
        let width = range.end - range.start;
        // Every decade, or every few; between them 2 and 5 where there is room.
        let step = (width / room.max(1) as f64).ceil().max(1.0);
        let parts: &[f64] = if 1.7 * width < room as f64 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let first = (range.start / step).floor() as i64;
        let last = (range.end / step).ceil() as i64;
        let decade = |k: i64| parts.iter().map(move |p| k as f64 * step + p.log10());
        let ticks: Vec<f64> = (first..=last).flat_map(decade).filter(within).collect();
        if ticks.len() > 1 {
            return ticks.into_iter().map(|v| (v, short(10_f64.powf(v)))).collect();
        }
        // Less than a step of 1, 2, 5: round numbers as on a linear axis.
        let values = 10_f64.powf(range.start)..10_f64.powf(range.end);
        steps(&values, room).into_iter().map(|v| (v.0.log10(), decimals(v.0, v.1))).collect()
    }
}

/// Round numbers of a range, with the step between them.
fn steps(range: &Range<f64>, room: usize) -> Vec<(f64, f64)> {
    let rough = (range.end - range.start) / room.max(2) as f64;
    if !(rough > 0.0 && rough.is_finite()) {
        return Vec::new();
    }
    let size = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * size).into_iter().find(|s| *s >= rough);
    let step = step.unwrap_or(rough);
    let (first, last) = ((range.start / step).ceil() as i64, (range.end / step).floor() as i64);
    (first..=last).map(|k| (k as f64 * step, step)).collect()
}

/// With as many decimals as the step between ticks has.
fn decimals(value: f64, step: f64) -> String {
    if value.abs() >= 1e6 || (value != 0.0 && step < 1e-6) {
        return format!("{value:.1e}");
    }
    let places = (-step.log10() + 1e-9).floor().max(-1.0) as i32 + 1;
    let text = format!("{value:.*}", places.max(0) as usize);
    // No trailing zeros, and no zero below zero.
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A number in few characters.
fn short(value: f64) -> String {
    match value.abs() {
        x if !(0.999e-3..1e5).contains(&x) => format!("{value:.0e}"),
        // No trailing zeros of rounding.
        _ => format!("{}", (value * 1e4).round() / 1e4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_log_axis_has_ticks() {
        let axis = Axis::log("mm");
        for (low, high) in [(0.21_f64, 0.23_f64), (0.51, 0.99), (1.01, 1.9), (0.0301, 0.0302)] {
            let range = low.log10()..high.log10();
            let ticks = axis.ticks(&range, 6);
            assert!(ticks.len() > 1, "{low} to {high}: {ticks:?}");
            let near = range.start - 1e-9..range.end + 1e-9;
            assert!(ticks.iter().all(|t| near.contains(&t.0)), "{ticks:?}");
        }
        let texts: Vec<String> = axis.ticks(&(-2.1..0.1), 8).into_iter().map(|t| t.1).collect();
        assert_eq!(texts, ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
    }

    #[test]
    fn ticks_are_round() {
        let texts = |low: f64, high: f64| {
            let ticks = Axis::signed("").ticks(&(low..high), 6);
            ticks.into_iter().map(|t| t.1).collect::<Vec<_>>()
        };
        assert_eq!(texts(-0.11, 0.12), ["-0.1", "-0.05", "0", "0.05", "0.1"]);
        assert_eq!(texts(0.0, 12.0), ["0", "2", "4", "6", "8", "10", "12"]);
        assert_eq!(texts(-900.0, 900.0), ["-500", "0", "500"]);
        assert!(texts(1.0, 1.0).is_empty());
    }
}
