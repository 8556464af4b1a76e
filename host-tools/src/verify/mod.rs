//! Does the compensated arm go where it is told? Measured after flashing.
//!
//! A commanded pose means the tool point of the *nominal* arm with the
//! identified marker, in the commanded frame; the compensation is to bring the
//! real tool there. Errors are measured less commanded, in that frame. No row
//! is left out.

mod record;
mod test_poses;

pub use record::{Conformity, OverPoses, Verification};
pub use test_poses::test_poses;

use nalgebra::Vector3;
use truearm::Pose;

use crate::error::{Error, Kind, Place, Result};
use crate::identify::rigid_transform;
use crate::identify::{Conditions, Predictor, State};
use crate::model::ModelTerm;
use crate::model::arm::chain;
use crate::model::{Commanded, Measurements, Model};
use crate::statistics::Stats;

/// Coverage factor of the expanded uncertainty: about 95 %.
pub const COVERAGE_FACTOR: f64 = 2.0;
/// Repetitions that ISO 9283:1998 (8.2) measures every pose with.
pub const STANDARD_REPEATS: usize = 30;

/// Verifies the rows of a file. With `refit` the frame of every station is
/// fitted to the file itself, which takes up to six directions of the error
/// out.
///
/// # Errors
/// Unknown stations or markers, or too few rows to fit a frame.
pub fn verify(model: &Model, commanded: &Commanded, refit: bool) -> Result<Verification> {
    let data = &commanded.data;
    let markers = markers(model, commanded)?;
    let targets = targets(model, commanded, &markers);
    let frames = frames(model, data, &targets, refit)?;
    in_tracker_frame(commanded, &frames, model)?;
    let to_robot = |row: &crate::model::Row| {
        frames[row.station].inverse().transform_point(&row.measured.point())
    };
    let errors: Vec<Vector3<f64>> =
        data.rows.iter().zip(&targets).map(|(row, target)| to_robot(row) - target).collect();

    let mut poses: Vec<((usize, usize), Vec<usize>)> = Vec::new();
    for (i, row) in data.rows.iter().enumerate() {
        let key = (row.pose, row.marker);
        match poses.iter_mut().find(|(k, _)| *k == key) {
            Some((_, rows)) => rows.push(i),
            None => poses.push((key, vec![i])),
        }
    }
    let of = |rows: &[usize]| rows.iter().map(|i| errors[*i]).collect::<Vec<_>>();
    let accuracy: Vec<f64> = poses.iter().map(|(_, rows)| accuracy(&of(rows))).collect();
    let repeatability: Vec<f64> =
        poses.iter().filter_map(|(_, rows)| repeatability(&of(rows))).collect();
    let repeats = poses.iter().map(|(_, rows)| rows.len());
    let to_file = model.robot.base.pose().rotation;
    let no_rows = || Error::data(Kind::NoRows, "no rows to verify", "give a file with rows");
    Ok(Verification {
        file: data.path.display().to_string(),
        rows: data.rows.len(),
        poses: poses.len(),
        repeats: [repeats.clone().min().unwrap_or(0), repeats.max().unwrap_or(0)],
        reregistered: if refit { "base" } else { "none" },
        errors: Stats::of(&errors).ok_or_else(no_rows)?,
        accuracy: over_poses(&accuracy).ok_or_else(no_rows)?,
        repeatability: over_poses(&repeatability),
        expanded_uncertainty_mm: expanded_uncertainty(model, data, refit) * 1e3,
        joints_not_covered: if commanded.points.is_empty() {
            crate::evaluate::not_covered(model, data)
        } else {
            Vec::new()
        },
        predicted_without_compensation: commanded
            .points
            .is_empty()
            .then(|| predicted(model, data, &markers, &frames, &targets))
            .flatten(),
        row_errors: errors.iter().map(|e| to_file * e).collect(),
    })
}

impl Verification {
    /// Whether the largest error conforms to a tolerance, mm. The decision rule
    /// is that of ISO 14253-1 for whoever has to prove conformity: the tolerance
    /// less the expanded uncertainty must hold it. With k = 2 the guard band is
    /// that of its editions of 1998 and 2013 and wider than the 1.65 standard
    /// uncertainties of 2017.
    #[must_use]
    pub fn conformity(&self, tolerance_mm: f64) -> Conformity {
        let (error, guard) = (self.errors.max_mm, self.expanded_uncertainty_mm);
        if error + guard <= tolerance_mm {
            Conformity::Pass
        } else if error - guard > tolerance_mm {
            Conformity::Fail
        } else {
            Conformity::NotProven
        }
    }
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

fn markers(model: &Model, commanded: &Commanded) -> Result<Vec<Vector3<f64>>> {
    if !commanded.points.is_empty() {
        // A point is a point, whatever target it was measured with.
        return Ok(vec![Vector3::zeros(); commanded.data.markers.len()]);
    }
    let known = || model.markers.iter().map(|m| format!("\"{}\"", m.0)).collect::<Vec<_>>();
    let find = |label: &String| {
        model.markers.iter().find(|m| m.0 == *label).map(|m| m.1).ok_or_else(|| {
            Error::data(
                Kind::UnknownMarker,
                format!(
                    "{}: marker \"{label}\" is unknown to the model, which knows {}",
                    commanded.data.path.display(),
                    known().join(", ")
                ),
                "measure with a target of the identification, or give commanded points",
            )
        })
    };
    commanded.data.markers.iter().map(find).collect()
}

/// Refuses commanded points that are in the tracker's frame: there they agree
/// with what was measured, and in the robot's they do not.
fn in_tracker_frame(commanded: &Commanded, frames: &[Pose<f64>], model: &Model) -> Result<()> {
    let base = model.robot.base.pose();
    let distances = |to: &dyn Fn(&crate::model::Row) -> Vector3<f64>, from: &Pose<f64>| {
        let rows = commanded.data.rows.iter().zip(&commanded.points);
        let mut all: Vec<f64> =
            rows.map(|(r, p)| (to(r) - from.transform_point(p)).norm()).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let measured = |row: &crate::model::Row| row.measured.point();
    let robot =
        |row: &crate::model::Row| frames[row.station].inverse().transform_point(&measured(row));
    let as_told = distances(&robot, &Pose::identity());
    let as_seen = distances(&measured, &base);
    // No arm misses by a decimetre, and none is right in both frames by chance.
    if as_told > 0.1 && as_seen < 0.1 * as_told {
        let (told, seen) = (as_told * 1e3, as_seen * 1e3);
        return Err(Error::file(
            &commanded.data.path,
            Place::default(),
            format!(
                "commanded points are {told:.0} mm from the measured ones in the robot's frame, \
                 {seen:.2} mm in the tracker's"
            ),
            "give cmd_x_mm, cmd_y_mm, cmd_z_mm as the controller was told, in the robot's frame; \
             what the tracker measured stays in the tracker's",
        ));
    }
    Ok(())
}

/// Where the target was told to be, in the commanded frame, m.
fn targets(model: &Model, commanded: &Commanded, markers: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    if !commanded.points.is_empty() {
        return commanded.points.clone();
    }
    let nominal = model.robot.nominal();
    let arms: Vec<_> = markers.iter().map(|m| chain(&nominal, Pose::identity(), *m)).collect();
    let rows = commanded.data.rows.iter();
    rows.map(|row| arms[row.marker].pose(&row.q).translation).collect()
}

/// The commanded frame seen from each station.
fn frames(
    model: &Model,
    data: &Measurements,
    targets: &[Vector3<f64>],
    refit: bool,
) -> Result<Vec<Pose<f64>>> {
    let file = data.path.display();
    let small = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let known = || model.stations.iter().map(|s| format!("\"{}\"", s.0)).collect::<Vec<_>>();
    let frame = |(s, label): (usize, &String)| {
        if refit {
            let rows: Vec<usize> =
                (0..targets.len()).filter(|i| data.rows[*i].station == s).collect();
            let from: Vec<_> = rows.iter().map(|i| targets[*i]).collect();
            let to: Vec<_> = rows.iter().map(|i| data.rows[*i].measured.point()).collect();
            let fitted = rigid_transform(&from, &to, &vec![1.0; rows.len()]);
            return fitted.filter(|_| rows.len() >= 4).ok_or_else(|| {
                Error::data(
                    Kind::FrameUndetermined,
                    format!(
                        "{file}: {} rows of station \"{label}\" do not fix a frame",
                        rows.len()
                    ),
                    "measure at least four points that are not on a line, better twenty",
                )
            });
        }
        let station = model.stations.iter().find(|(l, _)| l == label);
        station.map(|(_, base)| base.compose(&small.inverse())).ok_or_else(|| {
            Error::data(
                Kind::UnknownStation,
                format!(
                    "{file}: station \"{label}\" is unknown to the model, which knows {}",
                    known().join(", ")
                ),
                "a new station has its own frame; --reregister base fits it on this file, which \
                 also takes up to six directions of the error out",
            )
        })
    };
    data.stations.iter().enumerate().map(frame).collect()
}

/// What the model predicts the error to be without compensation.
fn predicted(
    model: &Model,
    data: &Measurements,
    markers: &[Vector3<f64>],
    frames: &[Pose<f64>],
    targets: &[Vector3<f64>],
) -> Option<Stats> {
    let small = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let arm = model.terms.iter().filter(|t| matches!(t, ModelTerm::Arm(_)));
    let state = State {
        bases: frames.iter().map(|frame| frame.compose(&small)).collect(),
        markers: markers.to_vec(),
        instruments: Vec::new(),
        links: model.links(),
        terms: arm.cloned().collect(),
    };
    let conditions = Conditions::of_model(data, model);
    let real = Predictor::new(&state);
    let error = |(i, row): (usize, &crate::model::Row)| {
        let seen = real.point(row, i, &conditions);
        frames[row.station].inverse().transform_point(&seen) - targets[i]
    };
    Stats::of(&data.rows.iter().enumerate().map(error).collect::<Vec<_>>())
}

/// Of the error of one row along any direction, k = 2, m: the measurement
/// (repeatability included) and the six parameters of the frame, which `n`
/// points determine to `6 sigma^2 / n`, a third of it along a direction.
fn expanded_uncertainty(model: &Model, data: &Measurements, refit: bool) -> f64 {
    let squares: f64 = data.rows.iter().map(|r| r.sigma * r.sigma).sum();
    let measured = squares / data.rows.len().max(1) as f64;
    let (points, stations, sigma) = if refit {
        (data.rows.len(), data.stations.len(), measured)
    } else {
        (model.provenance.rows, model.stations.len(), model.robot.sigma.powi(2))
    };
    let each = (points as f64 / stations.max(1) as f64).max(1.0);
    COVERAGE_FACTOR * (measured + 2.0 * sigma / each).sqrt()
}
