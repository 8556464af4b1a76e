//! Does the compensated arm go where it is told? Measured after flashing.
//!
//! A commanded pose means the tool point of the *nominal* arm with the
//! identified marker, in the commanded frame; the compensation is to bring the
//! real tool there. Errors are measured less commanded: of points in that frame,
//! of other kinds what they show of an arm that stands as commanded. No row is left
//! out.

mod conformity;
mod frames;
mod kinds;
mod moved;
mod record;
mod refit;
mod test_poses;
mod tolerances;

pub use conformity::Conformity;
pub use kinds::{COVERAGE_FACTOR, KindVerified};
pub use moved::FrameMoved;
pub use record::{OfPoints, OverPoses, Verification};
pub use test_poses::test_poses;
pub use tolerances::Tolerances;

use std::collections::HashMap;

use nalgebra::Vector3;
use truearm::Pose;

use crate::error::{Result, count};
use crate::evaluate::residuals;
use crate::identify::{Conditions, State};
use crate::model::{Commanded, Measurements, Model, ModelTerm};
use crate::observations::{Residual, kind};
use crate::statistics::Stats;
use kinds::Judged;

/// Repetitions that ISO 9283:1998 (8.2) measures every pose with.
pub const STANDARD_REPEATS: usize = 30;

/// Verifies the rows of a file. With `refit` the frame of every station is fitted to the points
/// of the file itself, for each pose to those of the others, which takes out what up to six
/// directions of the error have in common.
///
/// # Errors
/// Unknown stations, markers or places, or too few points to fit a frame.
pub fn verify(model: &Model, commanded: &Commanded, refit: bool) -> Result<Verification> {
    let (mut commanded, mut warnings) = kinds::judgeable(commanded)?;
    let markers = frames::markers(model, &commanded)?;
    let targets = frames::targets(model, &commanded, &markers);
    let (frames, frame) = match refit {
        true => refit::refitted(&mut commanded.to_mut().data, &targets)?,
        false => (frames::frames(model, &commanded.data)?, frame_variance(model)),
    };
    let (data, joints) = (&commanded.data, commanded.points.is_empty());
    frames::in_tracker_frame(&commanded, &frames, model)?;
    let errors = errors(data, &targets, &frames);
    let aim = aim(model, data, &frames, &markers);
    let of_points = |(row, error): (&crate::model::Row, &Option<Vector3<f64>>)| {
        Residual::new(row, error.unwrap_or_default().into())
    };
    let conditions =
        if joints { Conditions::new(data, &model.robot) } else { Conditions::default() };
    let left = match joints {
        true => residuals(data, &conditions, &aim),
        false => data.rows.iter().zip(&errors).map(of_points).collect(),
    };
    if joints {
        model.timed(data)?;
    }
    // What the model expects of an arm that is not compensated hangs on torques, the verdict
    // does not.
    let untold = joints.then(|| model.loaded(data).err()).flatten();
    warnings
        .extend(untold.iter().map(|error| format!("{error}: what was to be expected is not told")));
    let before = (joints && untold.is_none()).then(|| predicted(model, data, &aim, &left));
    let judged = Judged { data, aim: &aim, conditions: &conditions, frame };
    let distinct = data.distinct();
    warnings.extend(copies(data, distinct.len()));
    let poses = poses(data, &distinct);
    let repeats = poses.iter().map(Vec::len);
    let to_file = model.robot.base.pose().rotation;
    let points = of_points_alone(&judged, &poses, &errors, before.as_deref());
    let held = points.as_ref().filter(|_| !refit);
    let moved = held.and_then(|of| moved::moved(data, &targets, &frames, of));
    warnings.extend(moved.map(|moved| moved.remark(data)));
    Ok(Verification {
        file: data.path.display().to_string(),
        rows: data.rows.len(),
        poses: poses.len(),
        repeats: [repeats.clone().min().unwrap_or(0), repeats.max().unwrap_or(0)],
        reregistered: if refit { "base" } else { "none" },
        frame_moved: moved,
        points,
        kinds: judged.kinds(&left, before.as_deref()),
        joints_not_covered: match joints {
            true => crate::evaluate::not_covered(model, data),
            false => Vec::new(),
        },
        row_errors: errors.iter().map(|e| e.map(|e| to_file * e)).collect(),
        residuals: left,
        warnings,
    })
}

/// Measured points beyond where they were commanded, in the commanded frame, m; nothing of rows
/// that measured none.
fn errors(
    data: &Measurements,
    targets: &[Vector3<f64>],
    frames: &[Pose<f64>],
) -> Vec<Option<Vector3<f64>>> {
    let error = |(row, target): (&crate::model::Row, &Vector3<f64>)| {
        let point = kind(row).point(row)?;
        Some(frames[row.station].inverse().transform_point(&point) - target)
    };
    data.rows.iter().zip(targets).map(error).collect()
}

/// A remark on rows that were written twice.
fn copies(data: &Measurements, distinct: usize) -> Option<String> {
    let again = data.rows.len() - distinct;
    (again > 0).then(|| {
        let (path, again) = (data.path.display(), count(again, "row"));
        format!("{path}: {again} of the same cells as others: no repetitions, but copies")
    })
}

/// Some rows of the same commanded pose and marker, in the order of the first of each.
fn poses(data: &Measurements, rows: &[usize]) -> Vec<Vec<usize>> {
    let mut out: Vec<Vec<usize>> = Vec::new();
    let mut place_of = HashMap::new();
    for i in rows.iter().copied() {
        let row = &data.rows[i];
        let place = *place_of.entry((row.pose, row.marker)).or_insert(out.len());
        match out.get_mut(place) {
            Some(rows) => rows.push(i),
            None => out.push(vec![i]),
        }
    }
    out
}

/// What points say; `None` without any.
fn of_points_alone(
    judged: &Judged,
    poses: &[Vec<usize>],
    errors: &[Option<Vector3<f64>>],
    before: Option<&[Residual]>,
) -> Option<OfPoints> {
    let all: Vec<Vector3<f64>> = errors.iter().flatten().copied().collect();
    let of = |rows: &Vec<usize>| rows.iter().filter_map(|i| errors[*i]).collect::<Vec<_>>();
    let of_poses: Vec<_> = poses.iter().map(of).filter(|errors| !errors.is_empty()).collect();
    let accuracy: Vec<f64> = of_poses.iter().map(|errors| accuracy(errors)).collect();
    let repeatability: Vec<f64> = of_poses.iter().filter_map(|e| repeatability(e)).collect();
    let seen = |before: &[Residual]| {
        let own = before.iter().zip(errors).filter(|(_, error)| error.is_some());
        Stats::of(own.map(|(r, _)| r.point()))
    };
    Some(OfPoints {
        errors: Stats::of(&all)?,
        accuracy: over_poses(&accuracy)?,
        repeatability: over_poses(&repeatability),
        expanded_uncertainty_mm: judged.of_points() * 1e3,
        predicted_without_compensation: before.and_then(seen),
    })
}

/// AP of the errors of one pose, m.
#[must_use]
pub fn accuracy(errors: &[Vector3<f64>]) -> f64 {
    (errors.iter().sum::<Vector3<f64>>() / errors.len() as f64).norm()
}

/// RP of the errors of one pose, m; `None` of a single one.
#[must_use]
pub fn repeatability(errors: &[Vector3<f64>]) -> Option<f64> {
    let n = errors.len() as f64;
    if errors.len() < 2 {
        return None;
    }
    let centre = errors.iter().sum::<Vector3<f64>>() / n;
    let l: Vec<f64> = errors.iter().map(|e| (e - centre).norm()).collect();
    let mean = l.iter().sum::<f64>() / n;
    let spread = l.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (n - 1.0);
    Some(mean + 3.0 * spread.sqrt())
}

fn over_poses(values: &[f64]) -> Option<OverPoses> {
    (!values.is_empty()).then(|| OverPoses {
        poses: values.len(),
        mean_mm: values.iter().sum::<f64>() / values.len() as f64 * 1e3,
        max_mm: values.iter().copied().fold(0.0, f64::max) * 1e3,
    })
}

/// An arm that stands as it was commanded.
fn aim(
    model: &Model,
    data: &Measurements,
    frames: &[Pose<f64>],
    markers: &[Vector3<f64>],
) -> State {
    State {
        bases: frames.to_vec(),
        markers: markers.to_vec(),
        instruments: data.instruments.clone(),
        links: model.robot.nominal(),
        terms: Vec::new(),
    }
}

/// What the model predicts to be measured beyond what was commanded without compensation;
/// `left` is what was measured beyond it.
fn predicted(model: &Model, data: &Measurements, aim: &State, left: &[Residual]) -> Vec<Residual> {
    let small = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let arm = model.terms.iter().filter(|t| matches!(t, ModelTerm::Arm(_)));
    let state = State {
        bases: aim.bases.iter().map(|frame| frame.compose(&small)).collect(),
        links: model.links(),
        terms: arm.cloned().collect(),
        ..aim.clone()
    };
    let real = residuals(data, &Conditions::of_model(data, model), &state);
    left.iter().zip(&real).map(|(left, real)| *left - *real).collect()
}

/// Of the six parameters of a frame as it was identified, along any direction, m^2: `n` points
/// determine them to `6 sigma^2 / n`, a third of it along a direction.
fn frame_variance(model: &Model) -> f64 {
    let each = (model.provenance.rows as f64 / model.stations.len().max(1) as f64).max(1.0);
    2.0 * model.robot.sigma.powi(2) / each
}
