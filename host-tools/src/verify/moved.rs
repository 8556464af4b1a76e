//! Whether a frame has moved since the identification: then its errors are not the arm's.

use nalgebra::{Rotation3, Vector3};
use schemars::JsonSchema;
use serde::Serialize;
use truearm::Pose;

use super::{OfPoints, refit};
use crate::identify::Pairs;
use crate::model::Measurements;
use crate::observations::kind;
use crate::statistics::Stats;

/// A motion explains nearly all where no larger share of the errors, root mean square, is left.
const LEFT: f64 = 1.0 / 3.0;

/// One rigid motion of the frame of every station that explains nearly all of the errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct FrameMoved {
    /// Root mean square of the errors that it leaves, mm: of each pose in the frame that the
    /// others fix.
    pub left_rms_mm: f64,
    /// The largest of them, mm.
    pub left_max_mm: f64,
    /// How far it moves the middle of the points, of the station that is moved most, mm.
    pub shift_mm: f64,
    /// How far it turns the frame, of the station that is turned most, degrees.
    pub turn_deg: f64,
    /// The option that takes it out.
    pub option: &'static str,
}

/// That motion, of what was found in these frames; `None` where they are as good as any.
pub fn moved(
    data: &Measurements,
    targets: &[Vector3<f64>],
    frames: &[Pose<f64>],
    found: &OfPoints,
) -> Option<FrameMoved> {
    if found.errors.rms_mm <= found.expanded_uncertainty_mm {
        return None;
    }
    let mut apart = data.clone();
    let (own, _) = refit::refitted(&mut apart, targets).ok()?;
    let mut pairs = vec![Pairs::default(); frames.len()];
    let mut left: Vec<Vector3<f64>> = Vec::new();
    for ((row, target), first) in apart.rows.iter().zip(targets).zip(&data.rows) {
        if let Some(point) = kind(row).point(row) {
            pairs[first.station].add(*target, point);
            left.push(own[row.station].inverse().transform_point(&point) - target);
        }
    }
    let left = Stats::of(&left).filter(|left| left.rms_mm <= LEFT * found.errors.rms_mm)?;
    let motion = |(frame, pairs): (&Pose<f64>, &Pairs)| {
        let motion = frame.inverse().compose(&pairs.transform()?);
        let middle = pairs.sums[0] / pairs.count;
        let shift = (motion.transform_point(&middle) - middle).norm();
        Some([shift * 1e3, Rotation3::from_matrix_unchecked(motion.rotation).angle().to_degrees()])
    };
    let motions: Vec<[f64; 2]> = frames.iter().zip(&pairs).filter_map(motion).collect();
    let [shift_mm, turn_deg] = [0, 1].map(|k| motions.iter().map(|m| m[k]).fold(0.0, f64::max));
    Some(FrameMoved {
        left_rms_mm: left.rms_mm,
        left_max_mm: left.max_mm,
        shift_mm,
        turn_deg,
        option: "--reregister base",
    })
}

impl FrameMoved {
    /// What it says of a file.
    #[must_use]
    pub fn remark(&self, data: &Measurements) -> String {
        let Self { left_rms_mm, left_max_mm, shift_mm, turn_deg, option } = self;
        let (file, one) = (data.path.display(), data.stations.len() == 1);
        let frame = if one { "the frame" } else { "the frame of each station" };
        format!(
            "{file}: one rigid motion of {frame} ({shift_mm:.3} mm, {turn_deg:.4} degrees) explains \
             nearly all of the errors: {left_rms_mm:.4} mm RMS and {left_max_mm:.4} mm at most are \
             left with {option}, which is right if the tracker or the foot of the arm was moved \
             since the identification; if neither was, these errors are the arm's"
        )
    }
}
