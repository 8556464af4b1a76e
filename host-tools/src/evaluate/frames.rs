//! The frames of a file that was not fitted: those of the training, or fitted to it.

use std::sync::Arc;

use nalgebra::Vector3;
use truearm::{Link, Pose};

use super::{Reregister, own_evidence, residuals};
use crate::error::{Error, ErrorKind, Label, Result};
use crate::identify::fit::{Freedom, fit};
use crate::identify::start::registration::register;
use crate::identify::{Conditions, Predictor, Problem, Scaling, State, rigid_transform};
use crate::model::{Instrument, Measurements, Model, ModelTerm};
use crate::observations::{kind, measuring};
use crate::statistics::points_apart;

/// The model with the frames of a file: those of the training, or fitted to it.
///
/// # Errors
/// As for [`super::evaluate`].
pub fn state_on(model: &Model, data: &Measurements, frames: Reregister) -> Result<State> {
    match frames {
        Reregister::Nothing => trained(model, data),
        Reregister::Base => {
            let markers = known_markers(model, data)?;
            with_bases(data, &Conditions::of_model(data, model), model, markers)
        }
        Reregister::BaseAndTool => {
            let conditions = Conditions::of_model(data, model);
            registered(model, data, conditions, model.links(), arm_terms(model))
        }
    }
}

fn unknown(data: &Measurements, of: Label, label: &str, known: &str, option: &str) -> Error {
    let what = of.name();
    let message = if label.is_empty() {
        format!(
            "{}: no column `{what}`, but the model was identified with {what} {known}",
            data.path.display()
        )
    } else {
        format!(
            "{}: {what} \"{label}\" is unknown to the model, which knows {known}",
            data.path.display()
        )
    };
    Error::data(
        of.unknown(),
        message,
        format!(
            "a new {what} has its own frame; --reregister {option} fits it on this file and says so in the report"
        ),
    )
}

fn find<'a, T>(
    data: &Measurements,
    of: Label,
    label: &str,
    known: &'a [(String, T)],
    option: &str,
) -> Result<&'a T> {
    let names = || match known {
        [] => "none".to_owned(),
        _ => known.iter().map(|(l, _)| format!("\"{l}\"")).collect::<Vec<_>>().join(", "),
    };
    let found = known.iter().find(|(l, _)| l == label);
    found.map(|(_, v)| v).ok_or_else(|| unknown(data, of, label, &names(), option))
}

fn known_markers(model: &Model, data: &Measurements) -> Result<Vec<Vector3<f64>>> {
    let marker = |m: &String| find(data, Label::Marker, m, &model.markers, "base+tool").copied();
    data.markers.iter().map(marker).collect()
}

/// What to do where the rows of a scored file refer to something else.
const SCORED: &str = "give rows whose labels the training has, or --reregister base+tool";

/// What the rows of a file refer to, as the training found it.
///
/// # Errors
/// One that the training does not have, with what to do then.
pub fn known_instruments(
    known: &[Instrument],
    data: &Measurements,
    help: &'static str,
) -> Result<Vec<Instrument>> {
    let find = |wanted: &Instrument| {
        let same = |i: &&Instrument| (i.form, &i.label) == (wanted.form, &wanted.label);
        let stated = wanted.unknowns().is_empty().then_some(wanted);
        known.iter().find(same).or(stated).cloned().ok_or_else(|| {
            let (what, label) = (wanted.form.name(), &wanted.label);
            Error::data(
                ErrorKind::UnknownMarker,
                format!("{}: {what} \"{label}\" is unknown to the model", data.path.display()),
                help,
            )
        })
    };
    data.instruments.iter().map(find).collect()
}

fn trained(model: &Model, data: &Measurements) -> Result<State> {
    let station = |s: &String| find(data, Label::Station, s, &model.stations, "base").copied();
    Ok(State {
        bases: data.stations.iter().map(station).collect::<Result<_>>()?,
        markers: known_markers(model, data)?,
        instruments: known_instruments(&model.instruments, data, SCORED)?,
        links: model.links(),
        terms: model.terms.clone(),
    })
}

/// Bases fitted by SVD (Eq. 17) on the rows of each station, without those that
/// stand out by their own evidence.
pub(super) fn with_bases(
    data: &Measurements,
    conditions: &Conditions,
    model: &Model,
    markers: Vec<Vector3<f64>>,
) -> Result<State> {
    let mut state = State {
        bases: vec![Pose::identity(); data.stations.len()],
        markers,
        instruments: known_instruments(&model.instruments, data, SCORED)?,
        links: model.links(),
        terms: arm_terms(model),
    };
    let arm = Predictor::new(&state);
    let points: Vec<_> =
        data.rows.iter().enumerate().map(|(i, r)| arm.point(r, &conditions.rows[i])).collect();
    let mut bases = Vec::new();
    for (s, label) in data.stations.iter().enumerate() {
        let of = |i: &usize| {
            data.rows[*i].station == s && kind(&data.rows[*i]).point(&data.rows[*i]).is_some()
        };
        let rows: Vec<_> = (0..data.rows.len()).filter(of).collect();
        let from: Vec<_> = rows.iter().map(|i| points[*i]).collect();
        let to: Vec<_> = rows.iter().map(|i| data.rows[*i].measured.point()).collect();
        let fail = || {
            Error::data(
                ErrorKind::FrameUndetermined,
                format!("station \"{label}\": {} rows do not fix a tracker frame", rows.len()),
                "measure at least three points that are not on a line",
            )
        };
        let mut weights = vec![1.0; rows.len()];
        let mut base =
            rigid_transform(&from, &to, &weights).filter(|_| rows.len() >= 3).ok_or_else(fail)?;
        for _ in 0..3 {
            let errors: Vec<_> =
                from.iter().zip(&to).map(|(a, b)| base.transform_point(a) - b).collect();
            let out = points_apart(&errors);
            weights = (0..rows.len()).map(|i| f64::from(u8::from(!out.contains(&i)))).collect();
            base = rigid_transform(&from, &to, &weights).ok_or_else(fail)?;
        }
        bases.push(base);
    }
    state.bases = bases;
    Ok(state)
}

/// Terms of the arm and of its read-out: another session has its own drift and mounting.
fn arm_terms(model: &Model) -> Vec<ModelTerm> {
    let stays = |t: &&ModelTerm| matches!(t, ModelTerm::Arm(_) | ModelTerm::Lag { .. });
    model.terms.iter().filter(stays).cloned().collect()
}

/// Base and tool registered on the file, links and terms as given.
pub(super) fn registered(
    model: &Model,
    data: &Measurements,
    conditions: Conditions,
    links: Vec<Link<f64>>,
    terms: Vec<ModelTerm>,
) -> Result<State> {
    let tool = model.tool();
    let start = State { terms, ..register(data, &links, tool)? };
    let problem = Problem {
        nominal: links,
        conditions: Arc::new(conditions),
        ..Problem::new(data, &model.robot, Scaling::Prior)
    };
    let mut rows = measuring(&data.rows);
    let mut state = fit(&problem, &rows, None, &start, Freedom::Frames)?.state;
    let out = own_evidence(data, &residuals(data, &problem.conditions, &state)).left_out;
    if !out.is_empty() {
        rows.retain(|r| !out.contains(r));
        state = fit(&problem, &rows, None, &start, Freedom::Frames)?.state;
    }
    Ok(state)
}
