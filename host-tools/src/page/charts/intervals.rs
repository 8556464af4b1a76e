use crate::identify::certainty::error_bars::ParameterBar;
use crate::plot::{Axis, Ink, Mark, Panel, Series};

/// Parameters of a link in their order, and the unit of each.
const PARAMETERS: [(&str, &str); 5] =
    [("alpha", "deg"), ("a", "mm"), ("theta", "deg"), ("d", "mm"), ("beta", "deg")];

/// Corrections of all links with their intervals, those that are `drawn`: lengths, then angles.
#[must_use]
pub fn corrections(bars: &[ParameterBar], drawn: fn(&ParameterBar) -> bool) -> Vec<Panel> {
    let joints = bars.len().div_ceil(PARAMETERS.len());
    let panel = |title: &str, unit: &'static str| {
        let own = PARAMETERS.iter().enumerate().filter(|(_, p)| p.1 == unit);
        let series = own.map(|(k, (name, _))| {
            let at = |joint: usize| bars.get(PARAMETERS.len() * joint + k).filter(|b| drawn(b));
            let of: Vec<(usize, &ParameterBar)> =
                (0..joints).filter_map(|joint| Some((joint, at(joint)?))).collect();
            let points = of.iter().map(|(j, b)| (*j as f64 + 1.0, b.correction)).collect();
            let ends =
                of.iter().map(|(_, b)| (b.correction - b.half_width, b.correction + b.half_width));
            let note = |(_, b): &(usize, &ParameterBar)| {
                format!("{}: {:+.4} +- {:.4} {}", b.name, b.correction, b.half_width, b.unit)
            };
            let notes = of.iter().map(note).collect();
            Series::new(*name, points, Mark::Intervals)
                .ends(ends.collect())
                .notes(notes)
                .ink(Ink(k))
        });
        let names = (1..=joints).map(|joint| format!("joint {joint}")).collect();
        let y = Axis::signed(format!("correction, {unit}"));
        let told = series.filter(|s| !s.points.is_empty());
        Panel::new(title, Axis::names(names), y, told.collect())
    };
    vec![
        panel("Corrections of lengths, 95 % intervals", "mm"),
        panel("Corrections of angles, 95 % intervals", "deg"),
    ]
}
