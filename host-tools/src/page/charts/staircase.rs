use crate::plot::{Axis, Ink, Mark, Panel, Rule, Series};

/// A model and the errors it leaves, mm.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Step {
    /// What the model is.
    pub name: String,
    /// RMS of the fitted rows.
    pub fitted: Option<f64>,
    /// RMS of rows held out in folds.
    pub held_out: Option<f64>,
    /// RMS of a file of its own.
    pub other: Option<f64>,
}

/// Room for one tread with its value.
const TREAD: f64 = 48.0;
/// A fall by more than this factor is drawn on an axis of decades.
const FAR: f64 = 5.0;

/// The gap from the first model to the last, with the floor that noise leaves.
#[must_use]
pub fn staircase(steps: &[Step], floor_mm: Option<f64>) -> Panel {
    let names = steps.iter().map(|s| s.name.clone()).collect();
    let of = |value: fn(&Step) -> Option<f64>| {
        let numbered = steps.iter().enumerate();
        numbered.filter_map(|(k, s)| Some((k as f64 + 1.0, value(s)?))).collect::<Vec<_>>()
    };
    let series = [
        ("fitted rows", of(|s| s.fitted), Ink::FITTED),
        ("held out in folds", of(|s| s.held_out), Ink::AFTER),
        ("hold-out file", of(|s| s.other), Ink::MODEL),
    ];
    let drawn = series.into_iter().filter(|(_, points, _)| !points.is_empty()).map(
        |(name, points, ink)| {
            let notes = points.iter().map(|p| format!("{name}: {:.4} mm RMS", p.1)).collect();
            Series::new(name, points, Mark::Steps).ink(ink).notes(notes)
        },
    );
    let title = "RMS position error from the drawing to the final model";
    // Steps that end far below where they began are told apart on decades.
    let all = steps.iter().flat_map(|s| [s.fitted, s.held_out, s.other]).flatten();
    let (low, high) = all.fold((f64::INFINITY, 0.0_f64), |m, v| (m.0.min(v), m.1.max(v)));
    let y = match high > FAR * low && low > 0.0 {
        true => Axis::log("RMS position error, mm"),
        false => Axis::linear("RMS position error, mm"),
    };
    let mut panel = Panel::new(title, Axis::names(names), y, drawn.collect());
    let treads = steps.len() * panel.series.len().max(2);
    let wide = (TREAD * treads as f64 / 0.84 + 80.0).clamp(560.0, 1100.0);
    panel.size = (wide, 380.0);
    panel.rules = floor_mm
        .map(|at| Rule { at, name: format!("noise alone: {at:.3} mm") })
        .into_iter()
        .collect();
    panel
}
