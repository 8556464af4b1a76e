//! Station, marker, series, order, time, temperature, payload, sides, sigma.

use std::collections::BTreeMap;

use super::clues::{Clues, Place};
use crate::headings::{Named, Quantity, Role, Unit};
use crate::import::clock::seconds;
use crate::import::config::Pick;
use crate::import::native::own;
use crate::import::table::Table;

/// Adds what names and numbers tell; what is not clear is left out, and so
/// named among the columns left out.
pub(super) fn add(
    clues: &Clues,
    given: &BTreeMap<String, Place>,
    columns: &mut BTreeMap<String, Pick>,
) {
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
            let Some(named) = Named::of(heading).filter(|n| n.preference >= 0) else { continue };
            let Some(to) = name(named.role) else { continue };
            let taken = columns.values().any(|p| (p.file, p.column) == (file, column));
            if taken || columns.contains_key(&to) || !holds(table, column, &to) {
                continue;
            }
            let because = format!("it is called \"{}\"", heading.text);
            let place = Place { file, column, because: because.clone() };
            if let Some(unit) = unit(clues, &to, &place) {
                columns.insert(to, clues.pick(&place, unit, because));
            }
        }
    }
    ours(clues, columns);
}

/// What rows measure beyond points, under the names that it has in measurements.csv:
/// in a table that says the kind of every row, and what joints hold in any.
fn ours(clues: &Clues, columns: &mut BTreeMap<String, Pick>) {
    for (file, table) in clues.tables.iter().enumerate() {
        let kinds = table.headings.iter().any(|heading| heading.text == "kind");
        for (column, heading) in table.headings.iter().enumerate() {
            let to = &heading.text;
            let held = to.starts_with("torque") || to.starts_with("force");
            let taken = columns.values().any(|p| (p.file, p.column) == (file, column))
                || to == "sigma_mm" && columns.contains_key("sigma");
            if own(to).is_none() || !(kinds || held) || taken || columns.contains_key(to) {
                continue;
            }
            let because = "measurements.csv calls it so".to_owned();
            let place = Place { file, column, because: because.clone() };
            columns.insert(to.clone(), clues.pick(&place, Unit::Plain, because));
        }
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
