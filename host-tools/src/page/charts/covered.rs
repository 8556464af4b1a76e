use truearm::JointKind;

use crate::plot::{Axis, Ink, Mark, Panel, Series};
use crate::units::{joint_to_file, joint_unit};

/// Joint values of poses within the limits of each joint, rad or m.
#[must_use]
pub fn covered(kinds: &[JointKind], limits: &[[f64; 2]], poses: &[Vec<f64>]) -> Panel {
    let of = |j: usize, value: f64| joint_to_file(kinds[j], value);
    let band = limits.iter().enumerate().map(|(j, [low, high])| (of(j, *low), of(j, *high)));
    let ends: Vec<(f64, f64)> = band.collect();
    let middles = ends.iter().enumerate().map(|(j, e)| (j as f64 + 1.0, (e.0 + e.1) / 2.0));
    let limits =
        Series::new("limits", middles.collect(), Mark::Intervals).ends(ends).ink(Ink::DATA);
    let mut points = Vec::new();
    for (k, q) in poses.iter().enumerate() {
        let aside = 0.5 * ((k as f64 + 0.5) / poses.len() as f64 - 0.5);
        points.extend(q.iter().enumerate().map(|(j, v)| (j as f64 + 1.0 + aside, of(j, *v))));
    }
    let names = (1..=kinds.len()).map(|j| format!("joint {j}")).collect();
    let mut units: Vec<&str> = kinds.iter().map(|kind| joint_unit(*kind)).collect();
    units.dedup();
    let y = Axis::signed(format!("joint value, {}", units.join(" or ")));
    let poses = Series::points("planned poses, side by side", points).ink(Ink::AFTER);
    Panel::new("What the planned poses cover", Axis::names(names), y, vec![limits, poses])
}
