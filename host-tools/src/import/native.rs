//! Columns that measurements.csv has for what rows measure beyond points: a table of
//! truearm's own keeps them as they are.

use crate::headings::{Heading, Quantity, Unit};
use crate::observations::columns_of_kinds;

/// What every import makes, whatever it is called before.
const OF_POINTS: [&str; 7] = ["x_mm", "y_mm", "z_mm", "qx", "qy", "qz", "qw"];

/// What such a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Own {
    Number,
    Label,
}

/// By the name, which is the heading as well; `None` of others.
pub(super) fn own(name: &str) -> Option<Own> {
    if OF_POINTS.contains(&name) {
        return None;
    }
    let (numbers, labels) = columns_of_kinds();
    let of_joint = |prefix: &str, unit: &str| {
        let number = name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(unit));
        number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
    };
    let held = of_joint("torque", "_nm") || of_joint("force", "_n");
    if held || ["sigma_mm", "sigma_deg", "sigma_px"].contains(&name) || numbers.contains(&name) {
        return Some(Own::Number);
    }
    (name == "kind" || labels.contains(&name)).then_some(Own::Label)
}

/// Such a column of numbers under another heading, and its unit: of `distance_m`, `Distance
/// [in]` and `length (mm)` it is `distance_mm`.
pub(super) fn meant(heading: &Heading) -> Option<(&'static str, Unit)> {
    const LENGTHS: [&str; 4] = ["length", "range", "abstand", "länge"];
    let unit = heading.unit?;
    let words = heading.words.join("_");
    let base = if LENGTHS.contains(&words.as_str()) { "distance" } else { &words };
    let (numbers, _) = columns_of_kinds();
    let own = numbers.into_iter().filter(|name| !OF_POINTS.contains(name));
    let same = |name: &&str| match name.rsplit_once('_') {
        Some((stem, "mm")) => stem == base && unit.quantity() == Quantity::Length,
        Some((stem, "deg")) => stem == base && unit.quantity() == Quantity::Angle,
        _ => false,
    };
    own.into_iter().find(same).map(|name| (name, unit))
}

/// Whether a row of this kind has a point.
pub(super) fn has_point(kind: &str) -> bool {
    ["", "point", "pose"].contains(&kind)
}
