//! Arms with one effect that no report has a name for, beside others that it has.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;

use super::Columns;
use super::effects::{Hidden, listed, same_place, size};
use crate::arm::Arm;
use crate::effects::{Defect, DefectKind, Outside};
use crate::vector;

/// The six kinds.
pub const KINDS: usize = 6;

/// Whether a kind goes with the temperature.
pub fn needs_temperature(kind: usize) -> bool {
    kind == 5
}

/// Up to three effects that the columns let a user find, and one of a kind that no report
/// can name.
pub fn draw(
    arm: &Arm,
    columns: &Columns,
    masses: bool,
    kind: usize,
    rng: &mut ChaCha8Rng,
) -> Hidden {
    let mut out = Hidden::default();
    let count = rng.random_range(0..=3);
    while out.listed.len() < count {
        let defect = listed(arm, columns, masses, rng);
        if !out.listed.iter().any(|d: &Defect| same_place(&d.kind, &defect.kind)) {
            out.listed.push(defect);
        }
    }
    let kinds = arm.kinds.iter().enumerate();
    let revolute = kinds.filter(|(_, kind)| **kind == JointKind::Revolute).map(|(j, _)| j);
    let revolute: Vec<usize> = revolute.collect();
    let joint = *revolute.choose(rng).unwrap_or(&0);
    let others: Vec<usize> = revolute.iter().copied().filter(|j| *j != joint).collect();
    let source = *others.choose(rng).unwrap_or(&0);
    let phase = rng.random_range(0.0..std::f64::consts::TAU);
    let order = f64::from(rng.random_range(1..=3));
    let (kind, size) = match kind {
        0 => (Outside::Hose { source, joint, order, phase }, size(1e-4, 6e-4, rng)),
        1 => {
            let (sin, cos) = rng.random_range(0.0..std::f64::consts::TAU).sin_cos();
            // The first joint's bolts: what leans once a turn is where the axis points.
            let order = order + 1.0;
            let joint = revolute[0];
            let way = [cos, sin];
            (Outside::Pedestal { joint, order, phase, way }, size(5e-5, 4e-4, rng))
        }
        2 => {
            let direction = vector(rng).normalize();
            let last = revolute.len().saturating_sub(3);
            let joint = *revolute[last..].choose(rng).unwrap_or(&0);
            (Outside::Holder { joint, order, phase, direction }, size(6e-5, 4e-4, rng))
        }
        3 => (Outside::Azimuth { order, phase }, size(4e-5, 3e-4, rng)),
        4 => {
            let length = rng.random_range(0.7..2.5);
            (Outside::Distance { length, phase }, size(6e-5, 4e-4, rng))
        }
        _ => (Outside::Warm { joint }, size(1e-5, 1e-4, rng)),
    };
    let kind = DefectKind::Outside(kind);
    out.unlisted = Some((kind.name(), vec![Defect { kind, size }]));
    out
}
