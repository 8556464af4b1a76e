//! What the columns mean: by their names, by their numbers, and by the arm.

mod arrangement;
mod clues;
mod contradiction;
mod named;
mod orientation;
mod others;
mod overrides;
mod readings;
mod units;

use std::collections::BTreeMap;

use super::config::{Config, Pick};
use super::join;
use crate::error::{Error, Result};
pub(super) use clues::Clues;
use clues::Place;
pub(super) use contradiction::contradicted;

/// The best guess of what the columns mean.
///
/// # Errors
/// What cannot be told, with the flag that settles it.
pub(super) fn guess(clues: &Clues, warnings: &mut Vec<String>) -> Result<Config> {
    let given = overrides::read(clues)?;
    let found = match named::joints_and_point(clues, &given)? {
        Some(found) => found,
        None => arrangement::find(clues)?,
    };
    let complete = clues.tables.len() > 1 && given.is_empty() && named::all_complete(clues);
    let (join, join_because) = join::decide(clues.tables, &clues.options.join, complete, warnings)?;
    let of_kinds = || clues.tables.iter().position(|t| t.headings.iter().any(|h| h.text == "kind"));
    let base = found.point.first().map(|place| place.file).or_else(of_kinds).unwrap_or(0);
    let rows = join::rows(clues.tables, &join, base, warnings)?;
    let mut columns = BTreeMap::new();
    let (joints, point) = units::decide(clues, &found, &rows, warnings)?;
    for (i, (place, (unit, because))) in found.joints.iter().zip(joints).enumerate() {
        columns.insert(format!("q{}", i + 1), clues.pick(place, unit, because));
    }
    for (name, (place, (unit, because))) in
        ["x", "y", "z"].iter().zip(found.point.iter().zip(point))
    {
        columns.insert((*name).to_owned(), clues.pick(place, unit, because));
    }
    orientation::add(clues, &given, &rows, &mut columns)?;
    others::add(clues, &given, &mut columns, warnings)?;
    refuse_twins(clues, &given, &columns)?;
    Ok(Config {
        files: clues.tables.iter().map(|t| t.settled.clone()).collect(),
        evidence: clues.tables.iter().map(|t| t.evidence.clone()).collect(),
        join,
        join_because,
        columns,
    })
}

/// What was taken by its heading must be the only column of that heading, unless
/// the user named it.
fn refuse_twins(
    clues: &Clues,
    given: &BTreeMap<String, Place>,
    columns: &BTreeMap<String, Pick>,
) -> Result<()> {
    for (to, pick) in
        columns.iter().filter(|(to, pick)| !given.contains_key(*to) && !pick.name.is_empty())
    {
        let table = &clues.tables[pick.file];
        let twin = |(column, heading): &(usize, &crate::headings::Heading)| {
            *column != pick.column && heading.text.eq_ignore_ascii_case(&pick.name)
        };
        let Some((twin, _)) = table.headings.iter().enumerate().find(twin) else { continue };
        let (first, second) = (pick.column.min(twin) + 1, pick.column.max(twin) + 1);
        return Err(Error::usage(
            format!(
                "{}: columns {first} and {second} are both called \"{}\"",
                table.path.display(),
                pick.name
            ),
            format!("say which is meant: --columns {to}={first} or --columns {to}={second}"),
        ));
    }
    Ok(())
}
