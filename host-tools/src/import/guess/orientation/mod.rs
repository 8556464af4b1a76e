//! The target's orientation, in whatever form it is given.

mod ways;

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::clues::{Clues, Place};
use crate::error::{Error, Result};
use crate::headings::{Quantity, Unit};
use crate::import::agreement;
use crate::import::config::Pick;
use crate::import::join::RowRef;
use crate::import::turn::{Form, asked};
use crate::units::joint_from_file;
use ways::{Reading, readings};

/// Adds its columns, if there are any.
///
/// # Errors
/// A form that cannot be told, with the flag that settles it.
pub(super) fn add(
    clues: &Clues,
    given: &BTreeMap<String, Place>,
    rows: &[RowRef],
    columns: &mut BTreeMap<String, Pick>,
) -> Result<()> {
    let wanted = clues.options.orientation.as_deref().map(asked).transpose()?;
    if let Some(None) = wanted {
        return Ok(());
    }
    let mut all = readings(clues, given, columns);
    if let Some(Some(wanted)) = wanted {
        let word = clues.options.orientation.as_deref().unwrap_or_default();
        let form = |r: &Reading| {
            r.form == wanted.form
                && (r.form != Form::Quaternion || r.flag.is_empty() || r.flag == word)
        };
        all.retain(form);
        let Some(reading) = all.first_mut() else {
            return Err(Error::usage(
                format!("--orientation {word}: no such columns"),
                format!(
                    "name them with --columns {}=HEADING,...",
                    wanted.form.columns().join("=HEADING,")
                ),
            ));
        };
        reading.unit = Some(wanted.unit);
        reading.because = "it was asked for".to_owned();
        all.truncate(1);
    }
    let Some(reading) = settled(clues, all, rows, columns)? else { return Ok(()) };
    let unit = reading.unit.unwrap_or(Unit::Plain);
    for (name, place) in reading.form.columns().iter().zip(&reading.places) {
        columns.insert((*name).to_owned(), clues.pick(place, unit, reading.because.clone()));
    }
    Ok(())
}

/// One reading, its unit known: the only one, or the one the arm agrees with.
fn settled(
    clues: &Clues,
    all: Vec<Reading>,
    rows: &[RowRef],
    columns: &BTreeMap<String, Pick>,
) -> Result<Option<Reading>> {
    let mut open: Vec<Reading> = Vec::new();
    for reading in all {
        for unit in units(clues, &reading) {
            let Reading { form, flag, .. } = reading;
            let places = reading.places.clone();
            open.push(Reading {
                form,
                places,
                unit: Some(unit),
                flag,
                because: reading.because.clone(),
            });
        }
    }
    if open.len() <= 1 {
        return Ok(open.pop());
    }
    let misfit = |r: &Reading| turns(clues, r, rows, columns);
    let mut scored: Vec<(usize, f64)> =
        open.iter().enumerate().filter_map(|(i, r)| Some((i, misfit(r)?))).collect();
    scored.sort_by(|a, b| a.1.total_cmp(&b.1));
    // 0.1 rad: an arm's true orientation is nearer to nominal than that.
    match scored[..] {
        [(best, misfit), (_, other), ..] if misfit < 0.1 && other > 2.0 * misfit => {
            let mut reading = open.swap_remove(best);
            let degrees = misfit.to_degrees();
            reading.because +=
                &format!("; so the hand turns as the nominal arm's within {degrees:.2} degrees");
            Ok(Some(reading))
        }
        _ => Err(ambiguous(clues, &open)),
    }
}

/// The units it may be in.
fn units(clues: &Clues, reading: &Reading) -> Vec<Unit> {
    if reading.form.quantity() == Quantity::Plain {
        return vec![Unit::Plain];
    }
    let said = reading.places.iter().find_map(|p| clues.said(p));
    if let Some(unit) = reading.unit.or(said) {
        return vec![unit];
    }
    let most = |p: &Place| clues.tables[p.file].most(p.column);
    match reading.places.iter().map(most).fold(0.0, f64::max) {
        most if most > 6.4 => vec![Unit::Deg],
        most if most > 1.0 => vec![Unit::Rad],
        _ => vec![Unit::Deg, Unit::Rad],
    }
}

fn turns(
    clues: &Clues,
    reading: &Reading,
    rows: &[RowRef],
    columns: &BTreeMap<String, Pick>,
) -> Option<f64> {
    let robot = clues.robot?;
    let mut q = Vec::new();
    let mut turns: Vec<Matrix3<f64>> = Vec::new();
    let value = |row: &RowRef, pick: (usize, usize), unit: Unit| {
        let (file, at) = row.at(pick.0);
        Some(unit.to_file(clues.tables[file].number(at, pick.1)?))
    };
    for row in rows {
        let joint = |(j, joint): (usize, &crate::model::Joint)| {
            let pick = columns.get(&format!("q{}", j + 1))?;
            Some(joint_from_file(joint.link.kind, value(row, (pick.file, pick.column), pick.unit)?))
        };
        let joints: Option<Vec<f64>> = robot.joints.iter().enumerate().map(joint).collect();
        let unit = reading.unit.unwrap_or(Unit::Plain);
        let scale = if unit.quantity() == Quantity::Angle { 1_f64.to_radians() } else { 1.0 };
        let numbers =
            reading.places.iter().map(|p| Some(value(row, (p.file, p.column), unit)? * scale));
        let turn = numbers.collect::<Option<Vec<f64>>>().and_then(|v| reading.form.rotation(&v));
        if let (Some(joints), Some(turn)) = (joints, turn) {
            q.push(joints);
            turns.push(turn);
        }
    }
    agreement::turns(robot, &q, &turns)
}

fn ambiguous(clues: &Clues, open: &[Reading]) -> Error {
    let names: Vec<&str> = open[0]
        .places
        .iter()
        .map(|p| clues.tables[p.file].headings[p.column].text.as_str())
        .collect();
    let word = |r: &Reading| match (r.form, r.unit) {
        (Form::Quaternion, _) if r.flag.is_empty() => "xyzw".to_owned(),
        (Form::Quaternion, _) => r.flag.to_owned(),
        (Form::Matrix, _) => "matrix".to_owned(),
        (Form::Rpy, unit) => format!("rpy-{}", unit.map_or("deg", Unit::word)),
        (Form::Vector, unit) => format!("vector-{}", unit.map_or("deg", Unit::word)),
    };
    let flags: Vec<String> = open.iter().map(|r| format!("--orientation {}", word(r))).collect();
    Error::usage(
        format!("the orientation ({}) may be read in {} ways", names.join(", "), open.len()),
        format!(
            "say which: {}, or --orientation none to leave it out; a robot.toml given with --robot may \
                 settle it",
            flags.join(", ")
        ),
    )
}
