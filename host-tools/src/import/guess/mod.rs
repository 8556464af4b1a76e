//! What the columns mean: by their names, by their numbers, and by the arm.

mod arrangement;
mod clues;
mod named;
mod orientation;
mod others;
mod overrides;
mod units;

use std::collections::BTreeMap;

use super::config::Config;
use super::join;
use crate::error::Result;
pub(super) use clues::Clues;

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
    let (join, join_because) = join::decide(clues.tables, &clues.options.join, complete)?;
    let rows = join::rows(clues.tables, &join, found.point[0].file, warnings)?;
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
    others::add(clues, &given, &mut columns);
    Ok(Config {
        files: clues.tables.iter().map(|t| t.settled.clone()).collect(),
        evidence: clues.tables.iter().map(|t| t.evidence.clone()).collect(),
        join,
        join_because,
        columns,
    })
}
