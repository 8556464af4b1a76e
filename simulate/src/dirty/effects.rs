//! Effects at the sizes real arms show.

use nalgebra::Vector3;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use truearm::JointKind;

use super::Columns;
use crate::arm::Arm;
use crate::body::Moment;
use crate::effects::{Defect, DefectKind, drawn};
use crate::{Robot, vector};

/// What an arm has: what a report can name, and what it cannot.
#[derive(Debug, Clone, Default)]
pub struct Hidden {
    pub listed: Vec<Defect>,
    /// With a word for it.
    pub unlisted: Option<(&'static str, Vec<Defect>)>,
}

/// Log-uniform.
pub(super) fn size(low: f64, high: f64, rng: &mut ChaCha8Rng) -> f64 {
    low * (high / low).powf(rng.random_range(0.0..1.0))
}

/// Three to eight effects that the columns let a user find, in a third of the
/// arms one that no report can name.
pub fn draw(arm: &Arm, columns: &Columns, masses: bool, rng: &mut ChaCha8Rng) -> Hidden {
    let count = rng.random_range(3..=8);
    let mut out = Hidden::default();
    while out.listed.len() < count {
        let defect = listed(arm, columns, masses, rng);
        let known = |d: &Defect| same_place(&d.kind, &defect.kind);
        if !out.listed.iter().any(known) {
            out.listed.push(defect);
        }
    }
    if rng.random_bool(1.0 / 3.0) {
        out.unlisted = Some(unlisted(arm, rng));
    }
    out
}

/// Whether two are one effect at one place.
pub(super) fn same_place(a: &DefectKind, b: &DefectKind) -> bool {
    let periodic = |k: &DefectKind| matches!(k, DefectKind::JointPeriodicError { .. });
    // A joint may have several lines, and a measurement one drift only.
    a.name() == b.name() && a.joints() == b.joints() && !(periodic(a) && periodic(b))
}

pub(super) fn listed(arm: &Arm, columns: &Columns, masses: bool, rng: &mut ChaCha8Rng) -> Defect {
    let n = arm.kinds.len();
    let revolute: Vec<usize> = (0..n).filter(|j| arm.kinds[*j] == JointKind::Revolute).collect();
    loop {
        let joint = *revolute.choose(rng).unwrap_or(&0);
        let wrist = joint + 3 >= n;
        let phase = rng.random_range(0.0..std::f64::consts::TAU);
        let (kind, size) = match rng.random_range(0..17) {
            0..4 if masses => {
                let size = if wrist { size(2e-5, 3e-4, rng) } else { size(1e-6, 1.5e-5, rng) };
                (DefectKind::JointCompliance { joint }, size)
            }
            4 if masses => (
                DefectKind::BaseCompliance { ratio: rng.random_range(0.7..1.4) },
                size(1e-6, 1.5e-5, rng),
            ),
            5 => (DefectKind::EncoderEccentricity { joint, phase }, size(2e-5, 4e-4, rng)),
            6..9 => {
                let phases = [phase, rng.random_range(0.0..std::f64::consts::TAU)];
                (DefectKind::GearTransmissionError { joint, phases }, size(1.3e-5, 3.1e-4, rng))
            }
            9 => {
                let order = f64::from(rng.random_range(3..=60));
                (DefectKind::JointPeriodicError { joint, order, phase }, size(1.3e-5, 3.1e-4, rng))
            }
            10 => (DefectKind::JointGain { joint }, size(1e-5, 3e-4, rng)),
            11 => {
                let source = *revolute.choose(rng).unwrap_or(&0);
                if source == joint {
                    continue;
                }
                (DefectKind::JointCoupling { source, joint }, size(1e-5, 3e-4, rng))
            }
            12 if columns.directions => {
                let most = if wrist { 2.85e-4 } else { 1.4e-4 };
                // Friction beyond what gravity ever reaches: the gap follows the motion.
                (DefectKind::Backlash { joint, friction: 1e9 }, size(1e-5, most, rng))
            }
            13 if columns.temperature => (DefectKind::ThermalExpansion, size(3e-6, 2e-5, rng)),
            14 if columns.series => (
                DefectKind::ToolRemount { direction: vector(rng).normalize() },
                size(2e-5, 3e-4, rng),
            ),
            15 if columns.time => {
                let (shift, turn) = (vector(rng).normalize(), vector(rng).normalize());
                (DefectKind::MeasurementDrift { shift, turn }, size(1e-5, 2e-4, rng))
            }
            16 if masses && joint > 0 => {
                let size = if wrist { size(1e-4, 5e-4, rng) } else { size(1e-6, 1.5e-5, rng) };
                (DefectKind::LateralCompliance { joint }, size)
            }
            _ => continue,
        };
        return Defect { kind, size };
    }
}

/// One spring of a joint that gravity loads by design.
pub fn spring(robot: &Robot, arm: &Arm, poses: &[Moment], rng: &mut ChaCha8Rng) -> Hidden {
    let kind = drawn("joint-compliance", robot, &arm.body, poses, rng);
    let wrist = kind.joints().first().is_some_and(|j| j + 2 >= arm.kinds.len());
    let size = if wrist { size(2e-5, 3e-4, rng) } else { size(1e-6, 1.5e-5, rng) };
    Hidden { listed: vec![Defect { kind, size }], unlisted: None }
}

fn unlisted(arm: &Arm, rng: &mut ChaCha8Rng) -> (&'static str, Vec<Defect>) {
    let n = arm.kinds.len();
    let joint = loop {
        let joint = rng.random_range(0..n);
        if arm.kinds[joint] == JointKind::Revolute {
            break joint;
        }
    };
    let phase = rng.random_range(0.0..std::f64::consts::TAU);
    match rng.random_range(0..4) {
        0 | 1 => {
            let (sd, length) = (size(1e-4, 4e-4, rng), rng.random_range(2.0..6.0));
            ("joint error curve", curve(joint, sd, length, rng))
        }
        2 => {
            let joint = joint.min(n - 2);
            let kind = DefectKind::BearingWobble {
                joint,
                order: f64::from(rng.random_range(2..=4)),
                phase,
            };
            ("bearing wobble", vec![Defect { kind, size: size(2e-5, 3e-4, rng) }])
        }
        _ => {
            let size = size(1e-5, 3e-4, rng);
            ("memory of the last pose", vec![Defect { kind: DefectKind::Memory { joint }, size }])
        }
    }
}

/// A smooth, random-like error of a joint angle, 2 pi-periodic: standard
/// deviation in rad, length scale in degrees (squared-exponential covariance, by
/// its Fourier series).
pub fn curve(joint: usize, sd: f64, length: f64, rng: &mut ChaCha8Rng) -> Vec<Defect> {
    let bend = length.to_radians();
    let weight = |n: f64| (-(n * bend).powi(2) / 2.0).exp();
    let orders: Vec<f64> = (1..400).map(f64::from).filter(|n| weight(*n) > 1e-6).collect();
    let total: f64 = orders.iter().map(|n| weight(*n)).sum();
    let line = |n: &f64| {
        let two: Vector3<f64> = Vector3::from_fn(|_, _| StandardNormal.sample(rng));
        let size = sd * (weight(*n) / total).sqrt() * two.xy().norm();
        let phase = two.y.atan2(two.x);
        Defect { kind: DefectKind::JointPeriodicError { joint, order: *n, phase }, size }
    };
    orders.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn a_curve_has_its_size() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut square = 0.0;
        for _ in 0..200 {
            let lines = curve(0, 4e-4, 3.0, &mut rng);
            // The mean square of a sine is one half.
            square += lines.iter().map(|d| d.size.powi(2) / 2.0).sum::<f64>() / 200.0;
        }
        assert!((square.sqrt() / 4e-4 - 1.0).abs() < 0.1, "{}", square.sqrt());
    }
}
