//! The target's orientation, in whatever form it is given.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::clues::{Clues, Place};
use super::named::groups;
use crate::error::{Error, Result};
use crate::headings::{Quantity, Role, Unit};
use crate::import::agreement;
use crate::import::config::Pick;
use crate::import::join::RowRef;
use crate::import::turn::{Form, asked};
use crate::units::joint_from_file;

/// One way to read it: the form, its columns in the form's order, its unit.
struct Reading {
    form: Form,
    places: Vec<Place>,
    unit: Option<Unit>,
    /// The word that asks for it.
    flag: &'static str,
    because: String,
}

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

/// All ways to read what is there.
fn readings(
    clues: &Clues,
    given: &BTreeMap<String, Place>,
    columns: &BTreeMap<String, Pick>,
) -> Vec<Reading> {
    let mut all = Vec::new();
    for form in Form::ALL {
        let places: Option<Vec<Place>> =
            form.columns().iter().map(|name| given.get(*name).cloned()).collect();
        if let Some(places) = places {
            return vec![Reading {
                form,
                places,
                unit: None,
                flag: "",
                because: "it was asked for".to_owned(),
            }];
        }
    }
    let mut push =
        |of: &dyn Fn(Role) -> Option<usize>, count: usize, form: Form, flag: &'static str| {
            let group = groups(clues, of)
                .into_iter()
                .filter(|g| g.columns.len() == count && g.preference > -8);
            if let Some(group) = group.max_by_key(|g| g.preference) {
                let places = group.places(clues);
                let because = "of what its columns are called".to_owned();
                all.push(Reading { form, places, unit: None, flag, because });
            }
        };
    push(&|r| if let Role::Quaternion(c) = r { Some(c) } else { None }, 4, Form::Quaternion, "");
    push(&|r| if let Role::Rpy(c) = r { Some(c) } else { None }, 3, Form::Rpy, "");
    push(&|r| if let Role::Turn(c) = r { Some(c) } else { None }, 3, Form::Rpy, "rpy");
    push(&|r| if let Role::Turn(c) = r { Some(c) } else { None }, 3, Form::Vector, "vector");
    push(&|r| if let Role::Matrix(i, j) = r { Some(3 * i + j) } else { None }, 9, Form::Matrix, "");
    all.extend(euler_parameters(clues, columns));
    match anonymous(clues, columns) {
        four if four.is_empty() => all.extend(kuka(clues)),
        four => all.extend(four),
    }
    if all.is_empty() {
        all = nameless(clues, columns);
    }
    all
}

/// `q0, q1, q2, q3` that are no joints: the scalar stands first.
fn euler_parameters(clues: &Clues, columns: &BTreeMap<String, Pick>) -> Option<Reading> {
    let joint = |role| if let Role::Joint(n) = role { Some(n) } else { None };
    let free = |place: &Place| {
        !columns.values().any(|pick| (pick.file, pick.column) == (place.file, place.column))
    };
    let all = groups(clues, joint).into_iter().filter(|g| g.columns.keys().copied().eq(0..4));
    let places = all.map(|g| g.places(clues)).find(|places| places.iter().all(free))?;
    let [w, x, y, z] = <[Place; 4]>::try_from(places).ok()?;
    let because = "q0 to q3 are no joints: the scalar stands first".to_owned();
    Some(Reading {
        form: Form::Quaternion,
        places: vec![x, y, z, w],
        unit: None,
        flag: "",
        because,
    })
}

/// KUKA's A, B, C: yaw, pitch, roll in degrees.
fn kuka(clues: &Clues) -> Option<Reading> {
    for (file, table) in clues.tables.iter().enumerate() {
        let at = |name: &str| {
            let place = table.headings.iter().position(|h| h.words == [name]);
            place.filter(|column| table.numeric(*column))
        };
        if let (Some(a), Some(b), Some(c)) = (at("a"), at("b"), at("c")) {
            let because = "A, B, C turn about z, y, x on a KUKA".to_owned();
            let places = [c, b, a].map(|column| Place { file, column, because: because.clone() });
            let unit = Some(Unit::Deg);
            return Some(Reading {
                form: Form::Rpy,
                places: places.to_vec(),
                unit,
                flag: "",
                because,
            });
        }
    }
    None
}

/// Columns a, b, c, d of length one are a quaternion, no angles A, B, C: either order.
fn anonymous(clues: &Clues, columns: &BTreeMap<String, Pick>) -> Vec<Reading> {
    for (file, table) in clues.tables.iter().enumerate() {
        let at = |name: &&str| table.headings.iter().position(|h| h.words == [*name]);
        let four: Option<Vec<usize>> = ["a", "b", "c", "d"].iter().map(at).collect();
        if let Some(four) = four {
            return of_length_one(clues, file, &four, columns);
        }
    }
    Vec::new()
}

/// Four columns of length one behind the point, in a table without headings:
/// either order.
fn nameless(clues: &Clues, columns: &BTreeMap<String, Pick>) -> Vec<Reading> {
    let Some(z) = columns.get("z") else { return Vec::new() };
    if clues.tables[z.file].named() {
        return Vec::new();
    }
    of_length_one(clues, z.file, &(z.column + 1..z.column + 5).collect::<Vec<_>>(), columns)
}

/// Both readings of four columns, if they are a quaternion in every row.
fn of_length_one(
    clues: &Clues,
    file: usize,
    four: &[usize],
    columns: &BTreeMap<String, Pick>,
) -> Vec<Reading> {
    let table = &clues.tables[file];
    let taken = columns.values().any(|p| p.file == file && four.contains(&p.column));
    let unit = |row: usize| {
        let q: Option<Vec<f64>> = four.iter().map(|c| table.number(row, *c)).collect();
        q.is_some_and(|q| (q.iter().map(|v| v * v).sum::<f64>().sqrt() - 1.0).abs() < 1e-2)
    };
    if taken || !(0..table.rows.len()).all(unit) {
        return Vec::new();
    }
    let reading = |order: [usize; 4], flag: &'static str| {
        let because = format!("four columns have together the length 1, in the order {flag}");
        let place = |i: usize| Place { file, column: four[i], because: because.clone() };
        let places = order.map(place).to_vec();
        Reading { form: Form::Quaternion, places, unit: None, flag, because: because.clone() }
    };
    vec![reading([0, 1, 2, 3], "xyzw"), reading([1, 2, 3, 0], "wxyz")]
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
