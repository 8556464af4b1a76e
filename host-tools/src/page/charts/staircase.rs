use crate::plot::{Axis, Ink, Mark, Panel, Rule, Series};

/// A model and the errors it leaves.
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

/// What the errors are told in, and the floor that noise leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// What they are, with the unit.
    pub axis: &'static str,
    /// The unit of one.
    pub unit: &'static str,
    /// What noise alone leaves.
    pub at: Option<f64>,
}

/// The gap from the first model to the last, with the floor that noise leaves.
#[must_use]
pub fn staircase(steps: &[Step], floor: Floor) -> Panel {
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
            let notes =
                points.iter().map(|p| format!("{name}: {:.4} {} RMS", p.1, floor.unit)).collect();
            Series::new(name, points, Mark::Steps).ink(ink).notes(notes)
        },
    );
    let title = "RMS error from the drawing to the final model";
    // Steps that end far below where they began are told apart on decades.
    let all = steps.iter().flat_map(|s| [s.fitted, s.held_out, s.other]).flatten();
    let (low, high) = all.fold((f64::INFINITY, 0.0_f64), |m, v| (m.0.min(v), m.1.max(v)));
    let y = match high > FAR * low && low > 0.0 {
        true => Axis::log(floor.axis),
        false => Axis::linear(floor.axis),
    };
    let mut panel = Panel::new(title, Axis::names(names), y, drawn.collect());
    let treads = steps.len() * panel.series.len().max(2);
    let wide = (TREAD * treads as f64 / 0.84 + 80.0).clamp(560.0, 1100.0);
    panel.size = (wide, 380.0);
    let Floor { at, unit, .. } = floor;
    panel.rules = at
        .map(|at| Rule { at, name: format!("noise alone: {at:.3} {unit}") })
        .into_iter()
        .collect();
    panel
}
