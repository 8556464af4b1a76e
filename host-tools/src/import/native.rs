//! Columns that measurements.csv has for what rows measure beyond points: a table of
//! truearm's own keeps them as they are.

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

/// Whether a row of this kind has a point.
pub(super) fn has_point(kind: &str) -> bool {
    ["", "point", "pose"].contains(&kind)
}
