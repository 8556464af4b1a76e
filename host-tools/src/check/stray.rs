//! Rows that the best explanation leaves far off: how many, which, what they have
//! in common, and whether one mistake made in them alone explains them. A robust
//! fit of the others looks sound however many there are.

use std::collections::{BTreeMap, BTreeSet};

use super::chains::Chains;
use super::judged::GROSS;
use super::mistake::Mistake;
use super::sample::Sample;
use super::scene::{Scene, Sight};
use super::search::{Found, Search};
use crate::model::{Measurements, Robot};
use crate::statistics::median;
use crate::units::to_mm;

/// Off by less, m, is for `diagnose`: targets slip and trackers drift by so much.
const LEAST: f64 = 2e-3;
/// A sound file has no larger part of such rows: of spoiled shots (beams broken,
/// wrong targets) careful sessions have one in a hundred, poor ones one in thirty;
/// half as many again beyond these.
const MOST: f64 = 0.05;
/// In a short file so many poses are single slips, read how often they may be: the
/// paper's 18 points have two.
const SLIPS: usize = 2;
/// Where a larger part of the poses is off nobody knows which rows are right, however few they are.
const DOUBTFUL: f64 = 0.15;
/// Rows from the first to the last of them are one block if so many of them are off:
/// a wrong sense is not seen where the joint is near zero.
const TOGETHER: f64 = 0.85;
/// Of fewer rows one mistake has no chance to be told from another.
const LEAST_OF_BLOCK: usize = 4;
/// A base has six unknowns: fewer rows with a base of their own explain themselves.
pub(super) const LEAST_OF_BASE: usize = 8;
/// Ranges that a sentence names.
const NAMED: usize = 8;

/// Rows far off.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Stray {
    /// Which, counted from 1: `3, 37 to 60`.
    pub rows: String,
    /// How many.
    pub count: usize,
    /// Of how many.
    pub of: usize,
    /// Whether they are more than a sound file has.
    pub many: bool,
    /// `station B`, `series 2`, `marker M` if they are its rows and no others.
    pub of_label: Option<String>,
    /// How far they are off, median, mm.
    pub off_mm: f64,
    /// Root mean square misfit of the other rows, mm.
    pub others_mm: f64,
    /// What explains them: a mistake that was made in these rows only.
    pub explained: Option<String>,
    /// The same, as what undoes it; none of a tracker that was moved.
    #[serde(skip)]
    pub change: Option<Mistake>,
    /// The rows of that mistake, counted from 0.
    #[serde(skip)]
    pub block: Vec<usize>,
    /// Root mean square misfit of these with it undone, m.
    #[serde(skip)]
    pub left: f64,
}

impl std::fmt::Display for Stray {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { rows, count, of, off_mm, others_mm, .. } = self;
        let (are, name) = if *count == 1 { ("is", "row") } else { ("are", "rows") };
        write!(f, "{count} of {of} rows {are} far off, by {off_mm:.0} mm (median): {name} {rows}")?;
        if let Some(label) = &self.of_label {
            write!(f, ", those of {label} and no others")?;
        }
        write!(f, "; the other {} agree to {others_mm:.2} mm RMS", of - count)?;
        match &self.explained {
            Some(why) => write!(f, "; {why}"),
            None if self.many => write!(f, "; what was different when these were taken?"),
            None => Ok(()),
        }
    }
}

/// All points of a file as an explanation has them, and how far they are off.
pub(super) struct Seen {
    pub(super) sample: Sample,
    /// Rows of the file.
    pub(super) rows: Vec<usize>,
    pub(super) far: Vec<f64>,
    /// How far a row may be off.
    pub(super) limit: f64,
}

impl Seen {
    fn of(search: &Search, data: &Measurements, found: &Found) -> Self {
        let (sample, rows) = Sample::whole(data, search.sample);
        let scene = Scene::new(search.links, search.tool, &sample, &found.changes);
        let chains = Chains::new(&found.fitted.state);
        let at = |s: &Sight| chains.of(s.station, s.marker).pose(&s.q).translation;
        let far = scene.sights.iter().map(|s| (s.point - at(s)).norm()).collect();
        Self { sample, rows, far, limit: (GROSS * found.fitted.spread).max(LEAST) }
    }

    fn astray(&self) -> Vec<usize> {
        (0..self.far.len()).filter(|i| self.far[*i] > self.limit).collect()
    }
}

/// The rows that an explanation leaves far off; `None` if it leaves none.
pub(super) fn rows(
    search: &Search,
    robot: &Robot,
    data: &Measurements,
    found: &Found,
) -> Option<Stray> {
    let seen = Seen::of(search, data, found);
    let astray = seen.astray();
    if astray.is_empty() {
        return None;
    }
    let (count, of) = (astray.len(), seen.far.len());
    let others: Vec<f64> = seen.far.iter().copied().filter(|d| *d <= seen.limit).collect();
    let poses: BTreeSet<usize> = astray.iter().map(|i| data.rows[seen.rows[*i]].pose).collect();
    // A single slip is one, and what a mistake leaves is not asked of few rows.
    let all: BTreeSet<usize> = seen.rows.iter().map(|row| data.rows[*row].pose).collect();
    let doubtful = poses.len() as f64 > DOUBTFUL * all.len() as f64;
    let few = poses.len() > 1 && found.changes.is_empty() && doubtful;
    let many = few || poses.len() > SLIPS && count as f64 > MOST * of as f64;
    let mut stray = Stray {
        rows: ranges(&astray.iter().map(|i| seen.rows[*i]).collect::<Vec<_>>()),
        count,
        of,
        many,
        of_label: None,
        off_mm: to_mm(median(&astray.iter().map(|i| seen.far[*i]).collect::<Vec<_>>())),
        others_mm: to_mm(rms(&others)),
        explained: None,
        change: None,
        block: Vec::new(),
        left: 0.0,
    };
    let block = match labelled(&seen, data, &astray) {
        Some((label, block)) => {
            stray.of_label = Some(label);
            block
        }
        None => together(&astray).unwrap_or_default(),
    };
    if many && block.len() >= LEAST_OF_BLOCK && found.changes.is_empty() {
        stray.explain(search, robot, found, &seen, &block);
    }
    Some(stray)
}

pub(super) fn rms(far: &[f64]) -> f64 {
    (far.iter().map(|d| d * d).sum::<f64>() / far.len().max(1) as f64).sqrt()
}

/// The block from the first to the last, if most of it is off.
fn together(astray: &[usize]) -> Option<Vec<usize>> {
    let (first, last) = (*astray.first()?, *astray.last()?);
    let block: Vec<usize> = (first..=last).collect();
    (astray.len() as f64 >= TOGETHER * block.len() as f64).then_some(block)
}

/// The station, series or marker whose rows they are and no others, and its rows.
fn labelled(seen: &Seen, data: &Measurements, astray: &[usize]) -> Option<(String, Vec<usize>)> {
    type Label<'a> = Box<dyn Fn(usize) -> Option<String> + 'a>;
    let row = |i: usize| &data.rows[seen.rows[i]];
    let named = |what: &str, of: &[String], at: usize| {
        (of.len() > 1).then(|| format!("{what} {}", of.get(at).map_or("", String::as_str)))
    };
    let labels: [Label<'_>; 3] = [
        Box::new(|i| named("station", &data.stations, row(i).station)),
        Box::new(|i| row(i).series.as_ref().map(|series| format!("series {series}"))),
        Box::new(|i| named("marker", &data.markers, row(i).marker)),
    ];
    for label in labels {
        let mut all: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for i in 0..seen.far.len() {
            all.entry(label(i).unwrap_or_default()).or_default().push(i);
        }
        if all.len() < 2 {
            continue;
        }
        let theirs = |(name, rows): &(String, Vec<usize>)| {
            let off = rows.iter().filter(|i| seen.far[**i] > seen.limit).count();
            let most = TOGETHER * rows.len().max(astray.len()) as f64;
            !name.is_empty() && off as f64 >= most
        };
        if let Some(found) = all.into_iter().find(theirs) {
            return Some(found);
        }
    }
    None
}

/// `3, 9 and 37 to 60` of rows counted from 0.
pub(super) fn ranges(rows: &[usize]) -> String {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for row in rows {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == *row => *last = *row,
            _ => runs.push([*row, *row]),
        }
    }
    let more = runs.len().saturating_sub(NAMED);
    let word = |[first, last]: &[usize; 2]| match last - first {
        0 => format!("{}", first + 1),
        1 => format!("{}, {}", first + 1, last + 1),
        _ => format!("{} to {}", first + 1, last + 1),
    };
    let mut text = runs.iter().take(NAMED).map(word).collect::<Vec<_>>().join(", ");
    if more > 0 {
        text += ", ...";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_in_words() {
        assert_eq!(ranges(&[2]), "3");
        assert_eq!(ranges(&[0, 1, 4, 5, 6]), "1, 2, 5 to 7");
        let many: Vec<usize> = (0..20).map(|i| 2 * i).collect();
        assert!(ranges(&many).ends_with("15, ..."), "{}", ranges(&many));
    }
}
