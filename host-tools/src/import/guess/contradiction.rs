//! What the nominal arm says against units that are settled without it.

use super::clues::{Clues, Found, Place};
use super::readings::{Readings, Told};
use crate::error::Result;
use crate::headings::Quantity;
use crate::import::config::{Config, Pick};
use crate::import::join::{self, RowRef};

/// Where the arm contradicts what the joints or the point say.
pub(super) fn contradictions(
    clues: &Clues,
    found: &Found,
    quantities: &[Quantity],
    rows: &[RowRef],
    told: [&[Option<Told>]; 2],
) -> Vec<String> {
    let nothing = vec![None; found.joints.len() + found.point.len()];
    let unsaid = Readings::of(clues, found, quantities, rows, &nothing);
    let of = |(what, told, arm): (&str, &[Option<Told>], Option<Told>)| {
        // Columns that differ are read as they say: no one unit is the arm's.
        let first = told.first().and_then(Option::as_ref);
        let same = told.iter().flatten().all(|t| Some(t.0) == first.map(|f| f.0));
        let known = first.filter(|_| same && told.iter().all(Option::is_some))?;
        Readings::contradiction(what, known, arm)
    };
    let both = [("joints", told[0], unsaid.joints()), ("points", told[1], unsaid.points())];
    both.into_iter().filter_map(of).collect()
}

/// Where the arm contradicts the units of an import.toml.
///
/// # Errors
/// Files that do not fit together as it says.
pub(in crate::import) fn contradicted(clues: &Clues, config: &Config) -> Result<Vec<String>> {
    let point: Vec<&Pick> = ["x", "y", "z"].iter().filter_map(|a| config.columns.get(*a)).collect();
    let base = config.file_of_what_was_measured();
    let rows = join::rows(clues.tables, &config.join, base, &mut Vec::new())?;
    let places = |picks: &[&Pick]| -> Vec<Place> {
        let place =
            |p: &&Pick| Place { file: p.file, column: p.column, because: p.because.clone() };
        picks.iter().map(place).collect()
    };
    let told = |picks: &[&Pick]| -> Vec<Option<Told>> {
        picks.iter().map(|pick| Some((pick.unit, pick.because.clone()))).collect()
    };
    let joints = config.joints();
    let found = Found { joints: places(&joints), point: places(&point) };
    let quantities: Vec<Quantity> = joints.iter().map(|pick| pick.unit.quantity()).collect();
    Ok(contradictions(clues, &found, &quantities, &rows, [&told(&joints), &told(&point)]))
}
