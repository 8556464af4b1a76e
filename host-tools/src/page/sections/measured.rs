use std::f64::consts::TAU;

use truearm::JointKind;

use crate::model::Model;
use crate::units::joint_to_file;

/// Where the figures of a model hold: where its joints were measured.
pub fn measured(model: &Model) -> String {
    let kinds: Vec<JointKind> = model.robot.joints.iter().map(|j| j.link.kind).collect();
    let unit = |kind: JointKind| if kind == JointKind::Revolute { "deg" } else { "mm" };
    let range = |j: usize, [low, high]: [f64; 2]| {
        let [low, high] = [low, high].map(|q| joint_to_file(kinds[j], q));
        format!("{low:.0} to {high:.0}")
    };
    let of_joint = |j: usize| {
        let covered = model.covered.get(j).copied().flatten()?;
        let curve = model.curves.iter().find(|curve| usize::from(curve.joint()) == j);
        let gaps: Vec<String> = curve
            .into_iter()
            .flat_map(|c| c.gap_ranges())
            .map(|gap| range(j, within(gap, covered)))
            .collect();
        let but = match gaps.is_empty() {
            true => String::new(),
            false => format!(" but {}, where too few rows tell its curve", gaps.join(", ")),
        };
        Some(format!("joint {} {} {}{but}", j + 1, range(j, covered), unit(kinds[j])))
    };
    let all: Vec<String> = (0..kinds.len()).filter_map(of_joint).collect();
    format!(
        "These figures hold where joints were measured: {}. Elsewhere the model extrapolates, and a \
         controller is told so.",
        all.join("; ")
    )
}

/// A stretch of a turn as many turns on as it takes to lie in a range.
fn within([low, high]: [f64; 2], covered: [f64; 2]) -> [f64; 2] {
    let turns = ((covered[0] - low) / TAU).ceil();
    // One that begins before the range may end in it.
    let by = if high + (turns - 1.0) * TAU > covered[0] + 1e-9 { turns - 1.0 } else { turns } * TAU;
    [low + by, high + by]
}
