//! Scoring a model on other data, in the frames of its training or, when asked
//! for, in frames fitted to that data.

mod evidence;
mod frames;

use schemars::JsonSchema;
use serde::Serialize;

use crate::error::{Error, ErrorKind, Result};
use crate::identify::noise_estimate::{KindScore, scores};
use crate::identify::start::zeros;
use crate::identify::{Conditions, Predictor, State, View};
use crate::model::{Measurements, Model};
use crate::observations::Residual;
use crate::statistics::Stats;
pub use evidence::{StandingOut, own_evidence};
pub use frames::{known_instruments, state_on};
use frames::{registered, with_bases};

/// A file of poses that were not fitted, scored.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Validation {
    /// The file.
    pub file: String,
    /// Rows scored.
    pub rows: usize,
    /// `none`, `base` or `base+tool`: what was fitted on this file.
    pub reregistered: &'static str,
    /// Rows left out on their own evidence (beyond 10 robust standard
    /// deviations of their kind, at most 1 % of the rows), counted from 1.
    pub left_out: Vec<usize>,
    /// Other rows that are as far off, counted from 1; their errors count.
    pub standing_out: Vec<usize>,
    /// Errors of the rows; nothing where no row says how far off something is.
    #[serde(flatten)]
    pub stats: Option<Stats>,
    /// The same with the rows left out.
    pub all_rows: Option<Stats>,
    /// RMS with the nominal geometry in the same frames (its own registration
    /// where the file was registered anew), mm.
    pub nominal_rms_mm: Option<f64>,
    /// RMS if a base were fitted on this file; `null` where it was.
    pub base_refitted_rms_mm: Option<f64>,
    /// Kinds of measurements, each in its own units.
    pub kinds: Vec<KindScore>,
    /// Joints with values outside the identified range, counted from 1.
    pub joints_not_covered: Vec<usize>,
}

/// Whether none of its rows is fitted in what `training` names, where so many are: poses that
/// were fitted are no hold-out.
///
/// # Errors
/// How many are.
pub fn not_fitted(training: &str, shared: usize, holdout: &Measurements) -> Result<()> {
    if shared == 0 {
        return Ok(());
    }
    let (file, rows) = (holdout.path.display(), holdout.rows.len());
    Err(Error::usage(
        format!("{file}: {shared} of {rows} rows are fitted in {training}"),
        "judge by poses that were not fitted; without them cross-validation judges",
    ))
}

/// What may be fitted on the scored file itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reregister {
    /// Nothing: its stations and markers are those of the training.
    #[default]
    Nothing,
    /// Each station's base; markers are those of the training.
    Base,
    /// Each station's base and each marker.
    BaseAndTool,
}

impl Reregister {
    /// As in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "none",
            Self::Base => "base",
            Self::BaseAndTool => "base+tool",
        }
    }
}

/// Scores a model.
///
/// # Errors
/// A station or marker the training did not have, naming `--reregister`; springs and
/// no torques; an arm that warms up late and no times.
pub fn evaluate(model: &Model, data: &Measurements, frames: Reregister) -> Result<Validation> {
    model.loaded(data)?;
    model.timed(data)?;
    let data = &*zeros::as_found(data, &model.instruments);
    let conditions = Conditions::of_model(data, model);
    let rigid = Conditions::at(data, &model.robot, &model.links());
    let state = state_on(model, data, frames)?;
    let residuals = residuals(data, &conditions, &state);
    let StandingOut { left_out, counted } = own_evidence(data, &residuals);
    let kept: Vec<_> =
        (0..residuals.len()).filter(|i| !left_out.contains(i)).map(|i| residuals[i]).collect();
    if residuals.iter().all(|r| r.is_empty()) {
        return Err(Error::data(ErrorKind::NoRows, "no rows to score", "give a file with rows"));
    }
    let stats = |r: &[Residual]| Stats::of(r.iter().copied().filter(Residual::is_length));
    let rms_without = |state: &State, conditions: &Conditions| -> Option<f64> {
        let all = self::residuals(data, conditions, state);
        let kept: Vec<_> =
            (0..all.len()).filter(|i| !left_out.contains(i)).map(|i| all[i]).collect();
        Some(stats(&kept)?.rms_mm)
    };
    let nominal = registered(model, data, rigid.clone(), model.robot.nominal(), Vec::new())?;
    let base_refitted = match frames {
        Reregister::Nothing => {
            let refitted = with_bases(data, &conditions, model, state.markers.clone());
            // Too few rows to fit a base are no reason not to score them.
            refitted.ok().and_then(|s| rms_without(&s, &conditions))
        }
        _ => None,
    };
    Ok(Validation {
        file: data.path.display().to_string(),
        rows: data.rows.len(),
        reregistered: frames.name(),
        left_out: left_out.iter().map(|i| i + 1).collect(),
        standing_out: counted.iter().map(|i| i + 1).collect(),
        stats: stats(&kept),
        all_rows: stats(&residuals),
        nominal_rms_mm: rms_without(&nominal, &rigid),
        base_refitted_rms_mm: base_refitted,
        kinds: scores(data, &self::residuals(data, &rigid, &nominal), &residuals, &left_out),
        joints_not_covered: not_covered(model, data),
    })
}

/// Measured minus predicted of every row, SI.
#[must_use]
pub fn residuals(data: &Measurements, conditions: &Conditions, state: &State) -> Vec<Residual> {
    let view = View { model: &Predictor::new(state), data, conditions };
    (0..data.rows.len()).map(|row| Residual::of(row, &view)).collect()
}

/// Joints, counted from 1, with readings outside the range of the identification, or where
/// their curve is not known.
#[must_use]
pub fn not_covered(model: &Model, data: &Measurements) -> Vec<usize> {
    let outside = |j: &usize| {
        let Some([low, high]) = model.covered[*j] else { return true };
        let curve = model.curves.iter().find(|curve| usize::from(curve.joint()) == *j);
        let known = |q: f64| curve.is_none_or(|curve| curve.knows(q));
        let within = |q: f64| (low..=high).contains(&q) && known(q);
        data.rows.iter().any(|row| !within(row.q[*j]))
    };
    (0..model.covered.len()).filter(outside).map(|j| j + 1).collect()
}
