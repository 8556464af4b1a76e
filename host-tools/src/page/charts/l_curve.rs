use super::super::numbers::digits;
use crate::identify::LCurvePoint;
use crate::plot::{Axis, Ink, Panel, Series};

/// The L-curve with the chosen point, the last of the list, and the corner.
#[must_use]
pub fn l_curve(
    points: &[LCurvePoint],
    scaling: &str,
    rule: &str,
    corner: Option<f64>,
) -> Option<Panel> {
    let (chosen, curve) = points.split_last()?;
    let place = |p: &LCurvePoint| (p.residual, p.corrections);
    let at = |p: &LCurvePoint| format!("lambda {}", digits(p.lambda));
    let line = curve.iter().map(place).collect();
    let mut series = vec![
        Series::line("every lambda", line).ink(Ink::DATA),
        Series::points(format!("chosen by {rule}: {}", digits(chosen.lambda)), vec![place(chosen)])
            .notes(vec![at(chosen)])
            .ink(Ink::BEFORE),
    ];
    let near = |lambda: f64| {
        let far = |p: &&LCurvePoint| (p.lambda.ln() - lambda.ln()).abs();
        curve.iter().min_by(|a, b| far(a).total_cmp(&far(b)))
    };
    if let Some(corner) = corner.and_then(near) {
        let name = format!("corner: {}", digits(corner.lambda));
        series.push(Series::points(name, vec![place(corner)]).notes(vec![at(corner)]).ink(Ink(3)));
    }
    let (x, y) = match scaling {
        "prior" => (
            "RMS residual, standard deviations of the noise",
            "norm of the corrections, tolerances",
        ),
        _ => ("RMS residual, m", "norm of the corrections, m and rad"),
    };
    Some(Panel::new("L-curve", Axis::log(x), Axis::log(y), series))
}
