//! What an instrument adds to every length, found where nobody said that it might: a wire
//! that leaves its drum before its zero, balls that are not where the bar ends. As a known
//! nothing it bends the arm, and looks like an effect of it; beside an effect it is not
//! beyond chance of geometry alone.

use std::borrow::Cow;

use super::alone::Alone;
use crate::identify::problem::Unknown;
use crate::model::{Form, Instrument, Measurements, Robot};
use crate::observations::{kind, refer_to_zeros};
use crate::tikhonov::covariance;

/// Standard deviations beyond which it is no chance.
const SURE: f64 = 5.0;
/// Lengths to one anchor that tell its place, an offset and something of the arm.
const ENOUGH: usize = 20;

/// What is added to lengths beyond chance, a sentence an anchor, as geometry alone has it; of
/// measurements in which that is known to be nothing.
#[must_use]
pub fn doubtful(robot: &Robot, data: &Measurements) -> Vec<String> {
    let found = || {
        let open = freed(data)?;
        let Alone { problem, fit: found } = Alone::of(robot, &open)?;
        let cov = covariance(&found.fit.normal, problem.unknowns.free(), 1.0);
        let zero = |(k, unknown): (usize, &Unknown)| {
            let Unknown::Instrument(i, ..) = unknown else { return None };
            let own = &found.fit.state.instruments[*i];
            let sd = found.scale * cov[(k, k)].max(0.0).sqrt() * problem.unit(*unknown);
            (own.form == Form::Zero).then(|| sentence(own, sd)).flatten()
        };
        Some(problem.unknowns.list().iter().enumerate().filter_map(zero).collect())
    };
    found().unwrap_or_default()
}

/// The same of what was found with an arm and its effects.
#[must_use]
pub fn found(instruments: &[Instrument]) -> Vec<String> {
    let zeros = instruments.iter().filter(|own| own.form == Form::Zero && !own.spread.is_empty());
    zeros.filter_map(|own| sentence(own, own.spread.row(ADDED).norm())).collect()
}

/// Where it is beyond chance.
fn sentence(own: &Instrument, sd: f64) -> Option<String> {
    let added = own.numbers[0];
    (added.abs() > SURE * sd).then(|| {
        format!(
            "lengths to anchor \"{}\" have {:+.3} mm (+-{:.3}) added to each: the zero of the \
             instrument",
            own.label,
            added * 1e3,
            2.0 * sd * 1e3
        )
    })
}

/// The number, behind the six of a place.
const ADDED: usize = 6;

/// Measurements in which what is added to lengths is unknown, to anchors that enough are
/// measured to and of whose zero nothing is stated; `None` where there are none.
#[must_use]
pub fn freed(data: &Measurements) -> Option<Measurements> {
    let lengths = |anchor: usize| {
        data.rows.iter().filter(|row| kind(row).has_zero() && row.refers[..] == [anchor]).count()
    };
    let anchors = data.instruments.iter().enumerate();
    let anchors = anchors.filter(|(i, own)| own.form == Form::Anchor && lengths(*i) >= ENOUGH);
    let zeros: Vec<Instrument> = anchors
        .map(|(_, own)| Instrument { stated: true, ..Instrument::unknown(Form::Zero, &own.label) })
        .collect();
    (!zeros.is_empty()).then(|| as_found(data, &zeros).into_owned())
}

/// Measurements with what is added to lengths, where instruments that were found have it and
/// theirs do not.
#[must_use]
pub fn as_found<'d>(data: &'d Measurements, instruments: &[Instrument]) -> Cow<'d, Measurements> {
    if instruments.iter().all(|own| own.form != Form::Zero) {
        return Cow::Borrowed(data);
    }
    let mut out = data.clone();
    let has = |out: &Measurements, form: Form, label: &str| {
        out.instruments.iter().any(|i| i.form == form && i.label == label)
    };
    for zero in instruments.iter().filter(|own| own.form == Form::Zero) {
        if has(&out, Form::Anchor, &zero.label) && !has(&out, Form::Zero, &zero.label) {
            out.instruments.push(zero.clone());
        }
    }
    refer_to_zeros(&mut out);
    Cow::Owned(out)
}
