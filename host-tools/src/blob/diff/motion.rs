//! How far the tool moves from one blob to the other.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::Serialize;
use truearm::effects::Term;
use truearm::{Approach, JointKind};
use truearm_sized::{Conditions, Parameters, real_arm};

use crate::units::{joint_to_file, point_to_mm};

/// Temperatures drawn: so far from the reference temperature, K.
const WARMTH: f64 = 10.0;
/// Range of a joint of which nothing is known, rad and m.
const UNKNOWN: [f64; 2] = [std::f64::consts::PI, 1.0];

/// How far the tool moves between the blobs, over drawn poses.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Motion {
    /// Where the poses were drawn.
    pub region: &'static str,
    /// How many.
    pub poses: usize,
    /// Largest way of the tool point.
    pub largest_mm: f64,
    /// Root mean square.
    pub rms_mm: f64,
    /// Largest turn of its frame.
    pub turn_deg: f64,
    /// The pose of the largest way, degrees or mm.
    pub worst_pose: Vec<f64>,
    /// That way.
    pub by_mm: [f64; 3],
}

/// The tool's motion within the limits and within what both covered, and its words.
pub(super) fn motion(
    text: &mut String,
    a: &Parameters,
    b: &Parameters,
    (poses, seed): (usize, u64),
) -> Vec<Motion> {
    let joints = a.nominal.len();
    let limit = |i: usize| {
        let unknown = UNKNOWN[usize::from(a.nominal[i].kind == JointKind::Prismatic)];
        a.limits[i].or(a.covered[i]).unwrap_or([-unknown, unknown])
    };
    let limits: Vec<_> = (0..joints).map(limit).collect();
    let common = |i: usize| {
        let ([low, high], [l, h]) = (a.covered[i]?, b.covered[i]?);
        let both = [low.max(l), high.min(h)];
        (both[0] <= both[1]).then_some(both)
    };
    let covered: Vec<_> = (0..joints).filter_map(common).collect();
    let mut motions = Vec::new();
    motions.extend(farthest(a, b, (poses, seed), "within the joint limits", &limits));
    let within_both = Some(covered).filter(|both| both.len() == joints);
    motions.extend(within_both.as_ref().and_then(|covered| {
        farthest(a, b, (poses, seed), "within what both identifications covered", covered)
    }));
    *text += "\n";
    motions.iter().for_each(|motion| *text += &told(motion, &a.kinds()));
    if within_both.is_none() {
        *text += "no pose lies within what both identifications covered\n";
    }
    *text += &format!(
        "(poses drawn with seed {seed}, approach directions drawn, temperature within {WARMTH} K of the\n\
         reference, no payload, each blob with its own tool point)\n"
    );
    if [a, b].into_iter().any(reads_torques) {
        *text += "(springs that follow torques that are read: none taken)\n";
    }
    motions
}

/// How far the tool moves within some ranges of the joints; `None` of no poses.
fn farthest(
    a: &Parameters,
    b: &Parameters,
    (poses, seed): (usize, u64),
    region: &'static str,
    ranges: &[[f64; 2]],
) -> Option<Motion> {
    let arms = [real_arm(a), real_arm(b)];
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let unloaded = vec![0.0; ranges.len()];
    let (mut worst, mut square, mut turn) = (None, 0.0, 0.0_f64);
    for _ in 0..poses {
        let q: Vec<f64> = ranges.iter().map(|[low, high]| rng.random_range(*low..=*high)).collect();
        let side = |_| if rng.random() { Approach::Positive } else { Approach::Negative };
        let approach: Vec<_> = ranges.iter().map(side).collect();
        let conditions = Conditions {
            approach: &approach,
            payload: Some(0.0),
            temperature: Some(a.reference_temperature + rng.random_range(-WARMTH..=WARMTH)),
            torque: None,
        };
        // Torques that are read nobody knows here: both as if they held nothing.
        let torque = (reads_torques(a) || reads_torques(b)).then_some(&unloaded[..]);
        let [x, y] =
            arms.each_ref().map(|arm| arm.real_pose(&q, &Conditions { torque, ..conditions }));
        let by = y.translation - x.translation;
        square += by.norm_squared();
        turn = turn.max(x.inverse().compose(&y).rotation_vector().norm());
        if worst.as_ref().is_none_or(|(most, _): &(Vector3<f64>, Vec<f64>)| by.norm() > most.norm())
        {
            worst = Some((by, q));
        }
    }
    let (by, q) = worst?;
    Some(Motion {
        region,
        poses,
        largest_mm: by.norm() * 1e3,
        rms_mm: (square / poses as f64).sqrt() * 1e3,
        turn_deg: turn.to_degrees(),
        worst_pose: a
            .nominal
            .iter()
            .zip(&q)
            .map(|(link, q)| joint_to_file(link.kind, *q))
            .collect(),
        by_mm: point_to_mm(&by),
    })
}

/// Whether terms follow torques that are read.
fn reads_torques(p: &Parameters) -> bool {
    p.masses.is_none() && p.terms.iter().any(Term::needs_torque)
}

fn told(motion: &Motion, kinds: &[JointKind]) -> String {
    let joints = motion.worst_pose.iter().zip(kinds);
    let unit = |kind: &JointKind| if *kind == JointKind::Revolute { "deg" } else { "mm" };
    let shown: Vec<String> = joints.map(|(q, kind)| format!("{q:.2} {}", unit(kind))).collect();
    let Motion { region, poses, largest_mm, rms_mm, turn_deg, by_mm: [x, y, z], .. } = motion;
    format!(
        "{region}, {poses} poses: the tool moves by {largest_mm:.4} mm at worst, {rms_mm:.4} mm RMS, its frame turns by\n\
         {turn_deg:.5} deg at worst; worst pose {}: by {x:.4} {y:.4} {z:.4} mm\n",
        shown.join(", ")
    )
}
