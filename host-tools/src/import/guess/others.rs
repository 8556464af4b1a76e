//! Station, marker, series, order, date, time, temperature, payload, sides, sigma.

use std::collections::BTreeMap;

use super::clues::{Clues, Place};
use crate::error::{Error, Result};
use crate::headings::{Named, Quantity, Role, Unit};
use crate::import::clock::{dated, is_of_day, seconds};
use crate::import::config::Pick;
use crate::import::native::{Own, meant, own};
use crate::import::table::Table;

/// Adds what names and numbers tell; what is not clear is left out, and so
/// named among the columns left out.
///
/// # Errors
/// Times in a unit that is not known, and a date asked for without them.
pub(super) fn add(
    clues: &Clues,
    given: &BTreeMap<String, Place>,
    columns: &mut BTreeMap<String, Pick>,
    warnings: &mut Vec<String>,
) -> Result<()> {
    for (to, place) in given {
        if columns.values().any(|p| (p.file, p.column) == (place.file, place.column))
            || columns.contains_key(to)
        {
            continue;
        }
        let unit = unit(clues, to, place).unwrap_or(Unit::Plain);
        columns.insert(to.clone(), clues.pick(place, unit, place.because.clone()));
    }
    for (file, table) in clues.tables.iter().enumerate() {
        for (column, heading) in table.headings.iter().enumerate() {
            let measured = |n: &Named| n.preference >= 0 || n.role == Role::Sigma;
            let Some(named) = Named::of(heading).filter(measured) else { continue };
            let Some(to) = name(named.role) else { continue };
            let taken = columns.values().any(|p| (p.file, p.column) == (file, column));
            if taken || columns.contains_key(&to) || !holds(table, column, &to) {
                continue;
            }
            let because = format!("it is called \"{}\"", heading.text);
            let place = Place { file, column, because: because.clone() };
            if to == "time" {
                known_time(table, column)?;
            }
            if let Some(unit) = unit(clues, &to, &place) {
                columns.insert(to, clues.pick(&place, unit, because));
            }
        }
    }
    ours(clues, columns);
    date(clues, columns, warnings);
    let of_day = |time: &Pick| !clues.tables[time.file].numeric(time.column);
    if given.contains_key("date") && !columns.get("time").is_some_and(of_day) {
        return Err(Error::usage(
            "--columns date=: a date belongs to a column of times of day, and there is none",
            "name it as well, date=Day,time=Clock; a column of dates with times is the time: time=Day",
        ));
    }
    Ok(())
}

/// Refuses times in a unit that is none of time: as seconds they would be wrong in silence.
fn known_time(table: &Table, column: usize) -> Result<()> {
    let heading = &table.headings[column];
    let other = heading.unit.filter(|unit| unit.quantity() != Quantity::Time).map(Unit::word);
    match heading.strange.as_deref().or(other).filter(|_| table.numeric(column)) {
        None => Ok(()),
        Some(unit) => Err(Error::usage(
            format!(
                "{}: {}: \"{unit}\" is no unit of time that is known",
                table.path.display(),
                table.called(column)
            ),
            format!(
                "convert the column to s, ms, min or h; if it is in seconds, say so: --columns time={}",
                column + 1
            ),
        )),
    }
}

/// The date of a time of day, in a column of its own.
fn date(clues: &Clues, columns: &mut BTreeMap<String, Pick>, warnings: &mut Vec<String>) {
    let Some(time) = columns.get("time").filter(|_| !columns.contains_key("date")) else { return };
    let (file, table) = (time.file, &clues.tables[time.file]);
    let timed = |row: &usize| !table.text(*row, time.column).is_empty();
    let rows: Vec<usize> = (0..table.rows.len()).filter(timed).collect();
    let of_day = |row: &usize| is_of_day(table.text(*row, time.column));
    let free = |column: &usize| !columns.values().any(|p| (p.file, p.column) == (file, *column));
    let is_date = |c: &usize| Named::of(&table.headings[*c]).is_some_and(|n| n.role == Role::Date);
    let found = (0..table.headings.len()).filter(free).find(is_date);
    let Some(column) = found.filter(|_| !table.numeric(time.column) && rows.iter().all(of_day))
    else {
        return;
    };
    let read = |row: &usize| dated(table.text(*row, column), table.text(*row, time.column));
    if let Some(row) = rows.iter().find(|row| read(row).is_none()) {
        warnings.push(format!(
            "{}:{}, {}: \"{}\" and \"{}\" give no date and time (2021-03-05 and 12:03:55 do; of \
             03/05/2021 nothing says which is the month): times are read without dates, which days \
             apart makes too short",
            table.path.display(),
            table.rows[*row].number,
            table.called(column),
            table.text(*row, column),
            table.text(*row, time.column)
        ));
        return;
    }
    let because = format!("it is called \"{}\"", table.headings[column].text);
    let place = Place { file, column, because: because.clone() };
    columns.insert("date".to_owned(), clues.pick(&place, Unit::Plain, because));
}

/// What rows measure beyond points, under the names that it has in measurements.csv:
/// in a table that says the kind of every row; what joints hold and standard deviations
/// in any.
fn ours(clues: &Clues, columns: &mut BTreeMap<String, Pick>) {
    for (file, table) in clues.tables.iter().enumerate() {
        let kinds = table.headings.iter().any(|heading| heading.text == "kind");
        for (column, heading) in table.headings.iter().enumerate() {
            let to = &heading.text;
            let of_any = ["torque", "force", "sigma_"].iter().any(|begin| to.starts_with(begin))
                && own(to) == Some(Own::Number)
                && table.numeric(column);
            let taken = columns.values().any(|p| (p.file, p.column) == (file, column))
                || to == "sigma_mm" && columns.contains_key("sigma");
            if own(to).is_none() || !(kinds || of_any) || taken || columns.contains_key(to) {
                continue;
            }
            let because = "measurements.csv calls it so".to_owned();
            let place = Place { file, column, because: because.clone() };
            columns.insert(to.clone(), clues.pick(&place, Unit::Plain, because));
        }
        let others = (0..table.headings.len())
            .filter(|c| kinds && table.numeric(*c) && own(&table.headings[*c].text).is_none());
        for column in others {
            measured(clues, columns, &Place { file, column, because: String::new() });
        }
    }
}

/// What rows measure beyond points under another heading, in the unit that this says.
fn measured(clues: &Clues, columns: &mut BTreeMap<String, Pick>, place: &Place) {
    let heading = &clues.tables[place.file].headings[place.column];
    let taken = |p: &Pick| (p.file, p.column) == (place.file, place.column);
    let Some((to, unit)) = meant(heading).filter(|_| !columns.values().any(taken)) else { return };
    if !columns.contains_key(to) {
        let because = format!("the heading \"{}\" says {}", heading.text, unit.word());
        columns.insert(to.to_owned(), clues.pick(place, unit, because));
    }
}

fn name(role: Role) -> Option<String> {
    Some(match role {
        Role::Direction(joint) => format!("dir{joint}"),
        Role::Station => "station".to_owned(),
        Role::Marker => "marker".to_owned(),
        Role::Series => "series".to_owned(),
        Role::Order => "order".to_owned(),
        Role::Time => "time".to_owned(),
        Role::Temperature => "temperature".to_owned(),
        Role::Payload => "payload".to_owned(),
        Role::Sigma => "sigma".to_owned(),
        _ => return None,
    })
}

/// Whether a column holds what its name says.
fn holds(table: &Table, column: usize, to: &str) -> bool {
    match to {
        "station" | "marker" | "series" => {
            (0..table.rows.len()).any(|r| !table.text(r, column).is_empty())
        }
        "time" => table.numeric(column) || seconds(table.text(0, column)).is_some(),
        _ if to.starts_with("dir") => {
            table.numeric(column)
                && table.numbers(column).iter().all(|v| [-1.0, 0.0, 1.0].contains(v))
        }
        _ => table.numeric(column),
    }
}

/// Its unit: what the heading says, or what its numbers leave no doubt of.
fn unit(clues: &Clues, to: &str, place: &Place) -> Option<Unit> {
    let table = &clues.tables[place.file];
    let said = clues.said(place);
    let all = table.numbers(place.column);
    let inside =
        |low: f64, high: f64| !all.is_empty() && all.iter().all(|v| (low..=high).contains(v));
    let of = |quantity: Quantity| said.filter(|unit| unit.quantity() == quantity);
    match to {
        "time" if !table.numeric(place.column) => Some(Unit::Plain),
        // Clocks of computers: the year 2001 to 2286 in each unit.
        "time" => of(Quantity::Time).or_else(|| {
            let clocks = [(1e18, Unit::Ns), (1e15, Unit::Us), (1e12, Unit::Ms)];
            clocks
                .iter()
                .find(|(least, _)| inside(*least, 10.0 * least))
                .map(|c| c.1)
                .or(Some(Unit::S))
        }),
        "temperature" => of(Quantity::Temperature).or_else(|| match () {
            () if inside(-40.0, 80.0) => Some(Unit::C),
            () if inside(200.0, 400.0) => Some(Unit::K),
            () => None,
        }),
        // In another unit it is not taken, and so named among what is left out.
        "payload" => match (said, &table.headings[place.column].strange) {
            (None, None) => Some(Unit::Kg),
            _ => of(Quantity::Mass),
        },
        "sigma" => of(Quantity::Length),
        _ => Some(Unit::Plain),
    }
}
