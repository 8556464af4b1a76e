//! How each kind is measured: what there is to measure on, as instruments.toml states it,
//! and which poses of the arm do. A kind that is planned for is a file here and a row of
//! `PLANNED`.

mod closure;
mod distance;
mod inclination;
mod pair;
mod pixel;
mod plate;
mod range;
mod touch;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::cell::Cell;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Instrument, PlannedRow};

/// The rows of one measurement: one, but for both ends of a pair and the corners of an
/// image.
pub type Candidate = Vec<PlannedRow>;

/// Where the arm stands for some measurements, one after another.
#[must_use]
pub fn poses(measurements: &[Candidate]) -> Vec<Vec<f64>> {
    let mut out: Vec<Vec<f64>> = Vec::new();
    for row in measurements.iter().flatten() {
        if out.last() != Some(&row.q) {
            out.push(row.q.clone());
        }
    }
    out
}

/// Measurements of a kind, in words.
#[must_use]
pub fn plural(kind: &str) -> String {
    if kind.ends_with("ch") { format!("{kind}es") } else { format!("{kind}s") }
}

/// One way to measure: on a surface, in a hole, from an anchor.
pub trait Spot: Sync {
    /// What it is, in words.
    fn name(&self) -> String;

    /// A measurement there; `None` where the draw led nowhere.
    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate>;
}

/// All the ways to measure, in a cell.
type Spots = fn(&Cell) -> Result<Vec<Box<dyn Spot>>>;

/// Kinds that are planned for with what instruments.toml states: points and poses are
/// measured anywhere.
const PLANNED: &[(&str, Spots)] = &[
    ("distance", distance::spots),
    ("pair", pair::spots),
    ("plate", plate::spots),
    ("touch", touch::spots),
    ("range", range::spots),
    ("inclination", inclination::spots),
    ("closure", closure::spots),
    ("pixel", pixel::spots),
];

/// Draws after which nothing can be measured somewhere.
const MOST_TRIES: usize = 3000;
/// Draws after which another measurement is drawn.
const TRIES: usize = 300;

/// Measurements of a kind that could be made, at most so many, the same of a seed; and
/// where none could.
///
/// # Errors
/// A kind that is not planned for, places that nothing is stated of, and none that the arm
/// reaches.
pub fn candidates(
    kind: &str,
    cell: &Cell,
    count: usize,
    seed: u64,
) -> Result<(Vec<Candidate>, Vec<String>)> {
    let Some((_, spots)) = PLANNED.iter().find(|(name, _)| *name == kind) else {
        return Err(Error::usage(
            format!("--kind {kind}: no poses are planned for it"),
            "poses planned for points do for it as well, though they are not the best",
        ));
    };
    let spots = spots(cell)?;
    let draw = |spot: &dyn Spot, number: u64, tries: usize| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number);
        (0..tries).find_map(|_| spot.draw(cell, &mut rng))
    };
    let open = spots.par_iter().enumerate();
    let open = open.map(|(k, spot)| draw(&**spot, k as u64, MOST_TRIES).is_some());
    let open: Vec<bool> = open.collect();
    let of = |is_open: bool| spots.iter().zip(&open).filter(move |(_, o)| **o == is_open);
    let closed: Vec<String> = of(false).map(|(spot, _)| spot.name()).collect();
    let open: Vec<&dyn Spot> = of(true).map(|(spot, _)| &**spot).collect();
    if open.is_empty() {
        return Err(Error::data(
            ErrorKind::NoPoses,
            format!(
                "{kind}: none of {MOST_TRIES} random poses within the joint limits leads to {}",
                crate::error::listed(&closed)
            ),
            "places of instruments.toml are mm in the frame that [base] of robot.toml is stated \
             in; correct them, or widen --limits, --box",
        ));
    }
    let first = spots.len() as u64;
    let numbers = (0..count).into_par_iter();
    let all = numbers.filter_map(|k| draw(open[k % open.len()], first + k as u64, TRIES)).collect();
    Ok((all, closed))
}

/// That the place of something is stated.
///
/// # Errors
/// Names the table and the keys.
pub(super) fn placed(of: &Instrument, table: &str, keys: &str) -> Result<()> {
    if of.stated {
        return Ok(());
    }
    let (form, label) = (of.form.name(), &of.label);
    Err(Error::data(
        ErrorKind::NoPoses,
        format!("{form} \"{label}\" has no place: nothing can be planned there"),
        format!(
            "add {keys} to its [[{table}]] in instruments.toml, with guess = true where it is \
             known roughly"
        ),
    ))
}

/// That there is something to measure on.
///
/// # Errors
/// Names the table to add.
pub(super) fn some<T>(all: Vec<T>, kind: &str, needs: &str, table: &str) -> Result<Vec<T>> {
    if !all.is_empty() {
        return Ok(all);
    }
    Err(Error::data(
        ErrorKind::NoPoses,
        format!("--kind {kind}: no {needs} is stated"),
        format!(
            "add {table} to an instruments.toml beside robot.toml, or give one with --instruments; \
             guess = true where places are known roughly"
        ),
    ))
}
