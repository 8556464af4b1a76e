use nalgebra::Vector3;

use super::super::picture::Arrow;
use crate::plot::{Axis, Ink, Mark, Panel, Series};
use crate::statistics::median;
use crate::units::{point_to_mm, to_mm};

/// How many times errors are drawn larger than they are: a round number that makes
/// the median one a twelfth of the workspace.
#[must_use]
pub fn magnified(arrows: &[Arrow]) -> f64 {
    let (low, high) = corners(arrows);
    let sizes = arrows.iter().filter_map(|a| a.before.or(a.after)).map(|e| e.norm());
    let typical = median(&sizes.collect::<Vec<_>>());
    let wanted = 0.08 * (high - low).amax() / typical;
    if !(wanted.is_finite() && wanted > 1.0) {
        return 1.0;
    }
    let size = 10_f64.powf(wanted.log10().floor());
    [5.0, 2.0, 1.0].map(|m| m * size).into_iter().find(|m| *m <= wanted).unwrap_or(size)
}

fn corners(arrows: &[Arrow]) -> (Vector3<f64>, Vector3<f64>) {
    let start = Vector3::repeat(f64::INFINITY);
    let low = arrows.iter().fold(start, |m, a| m.inf(&a.point));
    let high = arrows.iter().fold(-start, |m, a| m.sup(&a.point));
    (low, high)
}

/// Points from above, from the front and from the side, with their errors.
#[must_use]
pub fn projections(arrows: &[Arrow], names: [&str; 2], times: f64) -> Vec<Panel> {
    let panel = |title: &str, across: usize, up: usize| {
        let flat = |p: &Vector3<f64>| (point_to_mm(p)[across], point_to_mm(p)[up]);
        let of = |error: fn(&Arrow) -> Option<Vector3<f64>>, name: &str, ink: Ink| {
            let own: Vec<_> = arrows.iter().filter_map(|a| Some((a, error(a)?))).collect();
            let ends = own.iter().map(|(a, e)| flat(&(a.point + e * times))).collect();
            let notes =
                own.iter().map(|(a, e)| format!("row {}: {:.3} mm", a.row, to_mm(e.norm())));
            let points = own.iter().map(|(a, _)| flat(&a.point)).collect();
            Series::new(name, points, Mark::Arrows).ends(ends).notes(notes.collect()).ink(ink)
        };
        let series =
            [of(|a| a.before, names[0], Ink::BEFORE), of(|a| a.after, names[1], Ink::AFTER)];
        let mut series: Vec<Series> = series.into_iter().filter(|s| !s.points.is_empty()).collect();
        if series.is_empty() {
            let points = arrows.iter().map(|a| flat(&a.point)).collect();
            let notes = arrows.iter().map(|a| format!("pose {}", a.row)).collect();
            series.push(Series::points("poses", points).notes(notes).ink(Ink::AFTER));
        }
        let axis = |k: usize| Axis::signed(format!("{}, mm", ["x", "y", "z"][k]));
        let mut panel = Panel::new(title, axis(across), axis(up), series);
        panel.equal = true;
        panel.size = (420.0, 400.0);
        panel
    };
    vec![panel("From above", 0, 1), panel("From the front", 0, 2), panel("From the side", 1, 2)]
}
