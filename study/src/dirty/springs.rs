//! What a diagnosis says of one spring that gives way under loads nobody states.

use truearm_host::diagnose::{DiagnoseOptions, diagnose};

use super::set::{DirtySet, Sort};
use super::told::alone;
use super::truth::Place;
use crate::blind::score::of;

/// A set and what was said of it.
#[derive(Debug)]
pub struct Answer {
    pub seed: u64,
    pub rows: usize,
    /// The spring's, counted from 1.
    pub joint: usize,
    /// How far the spring is from nothing, and from nothing or any other effect, in standard
    /// deviations; in noise floors.
    pub from_nothing: f64,
    pub sure: f64,
    pub floors: f64,
    /// Whether it is named.
    pub right: bool,
    /// What else is named.
    pub second: Vec<Place>,
}

/// Diagnoses the set of a seed.
///
/// # Errors
/// The diagnosis', with the seed.
pub fn answer(seed: u64) -> Result<Answer, String> {
    let set = DirtySet::draw(seed, Sort::Spring);
    let (robot, [data, _]) = set.read();
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ());
    let report = found.map_err(|e| format!("seed {seed}: {e}"))?.outcome;
    let spring = set.open().hidden.listed.first().ok_or_else(|| format!("seed {seed}"))?;
    let place = (spring.kind.name().to_owned(), spring.kind.joints());
    let alone = alone(&set).ok_or_else(|| format!("seed {seed}: not registered"))?;
    let [from_nothing, sure] = alone.first().map_or([0.0; 2], |a| [a.from_nothing, a.sure]);
    let claims = of(&report.effects);
    let other = |p: &Place| p.0 != "outliers" && *p != place;
    Ok(Answer {
        seed,
        rows: data.rows.len(),
        joint: place.1[0],
        from_nothing,
        sure,
        floors: from_nothing / (3.0 * data.rows.len() as f64).sqrt(),
        right: claims.contains(&place),
        second: claims.into_iter().filter(other).collect(),
    })
}
