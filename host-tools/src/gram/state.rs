//! What a state is to its parts: unknowns in one order, whatever labels the rows of a part have.

use std::borrow::Cow;

use nalgebra::Vector3;

use crate::error::{Error, ErrorKind, Label, Result, listed};
use crate::files::digest_of_text;
use crate::identify::{Conditions, Problem, Scaling, State};
use crate::model::{KindId, Measurements, Model};
use crate::observations::kind;

/// Which state it is: by where it came from, whose numbers stand in every copy alike, and by what
/// a hand may have changed since (`changed` tells of the arm's corrections). Places and angles to
/// a nanometre and a nanoradian: from degrees and back the last bit is another.
pub(super) fn digest(model: &Model) -> u64 {
    let Model { robot, provenance, gram, changed, .. } = model;
    let nano = |value: f64| (value * 1e9).round() as i64;
    let stations = model.stations.iter().map(|(label, base)| {
        let turned = base.rotation.iter().copied();
        (label, turned.chain(base.translation.iter().copied()).map(nano).collect::<Vec<_>>())
    });
    let at = |place: &Vector3<f64>| [place.x, place.y, place.z].map(nano);
    let markers = model.markers.iter().map(|(label, place)| (label, at(place)));
    let (stations, markers): (Vec<_>, Vec<_>) = (stations.collect(), markers.collect());
    let targets: Vec<_> = places(model).iter().map(at).collect();
    let sigma = nano(robot.sigma * 1e3);
    let gram = gram.as_ref().map(|g| (g.stage, g.settled, g.k, g.weights, g.flagged));
    digest_of_text(&format!(
        "{} {} {provenance:?} {gram:?} {changed} {stations:?} {markers:?} {targets:?} {sigma}",
        robot.name, robot.serial
    ))
}

/// The state as the unknowns have it.
pub(super) fn state(model: &Model) -> State {
    State {
        bases: model.stations.iter().map(|(_, base)| *base).collect(),
        markers: model.markers.iter().map(|(_, place)| *place).collect(),
        instruments: Vec::new(),
        links: model.links(),
        terms: model.terms.clone(),
    }
}

/// The problem of rows that are labelled as the model is.
pub(super) fn problem<'a>(model: &Model, data: &'a Measurements) -> Problem<'a> {
    let conditions = Conditions::of_model(data, model);
    let problem = Problem::under(data, &model.robot, Scaling::Prior, conditions);
    problem.with_terms(model.terms.len())
}

/// No rows, with the labels of the model.
pub(super) fn no_rows(model: &Model) -> Measurements {
    Measurements {
        path: model.robot.path.clone(),
        behind: Vec::new(),
        rows: Vec::new(),
        stations: labels(&model.stations),
        markers: labels(&model.markers),
        known_markers: Vec::new(),
        guessed_markers: Vec::new(),
        instruments: Vec::new(),
        base: truearm::Pose::identity(),
        poses: 0,
        extra_columns: Vec::new(),
        directions_from_order: false,
        order_from_rows: false,
        sides_found: Vec::new(),
        warnings: Vec::new(),
    }
}

/// Where targets are held: where they were when it began.
pub(super) fn places(model: &Model) -> Vec<Vector3<f64>> {
    match &model.gram {
        Some(gram) if gram.targets.len() == model.markers.len() => gram.targets.clone(),
        _ => model.markers.iter().map(|(_, place)| *place).collect(),
    }
}

/// The rows under the labels of the model, in its order.
///
/// # Errors
/// Rows that are no points, and a station or marker that the model does not know.
pub(super) fn labelled<'d>(model: &Model, data: &'d Measurements) -> Result<Cow<'d, Measurements>> {
    if let Some(row) = data.rows.iter().position(|row| row.kind != KindId::default()) {
        let of = &data.rows[row];
        return Err(Error::data(
            ErrorKind::Usage,
            format!("{} line {}: a {}", data.file_of(row).display(), of.line, kind(of).name()),
            "parts are of points alone; `truearm identify` takes all kinds in one file",
        ));
    }
    let stations = places_of(data, Label::Station, &data.stations, &labels(&model.stations))?;
    let markers = places_of(data, Label::Marker, &data.markers, &labels(&model.markers))?;
    let own = no_rows(model);
    if data.stations == own.stations && data.markers == own.markers {
        return Ok(Cow::Borrowed(data));
    }
    let mut all = data.clone();
    for row in &mut all.rows {
        (row.station, row.marker) = (stations[row.station], markers[row.marker]);
    }
    Ok(Cow::Owned(Measurements { stations: own.stations, markers: own.markers, ..all }))
}

fn labels<T>(known: &[(String, T)]) -> Vec<String> {
    known.iter().map(|(label, _)| label.clone()).collect()
}

fn places_of(
    data: &Measurements,
    of: Label,
    labels: &[String],
    known: &[String],
) -> Result<Vec<usize>> {
    let find = |label: &String| {
        known.iter().position(|own| own == label).ok_or_else(|| {
            let (file, what) = (data.path.display(), of.name());
            let names: Vec<String> = known.iter().map(|own| format!("\"{own}\"")).collect();
            Error::data(
                of.unknown(),
                format!(
                    "{file}: {what} \"{label}\" is unknown to the state, which knows {}",
                    listed(&names)
                ),
                "begin with `truearm identify` of rows that have every station and marker",
            )
        })
    };
    labels.iter().map(find).collect()
}
