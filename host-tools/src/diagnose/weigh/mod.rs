//! What the data hold beyond geometry: searches one after another, each from what the ones
//! before it found (`search`).

mod between;
mod curve;
mod doubts;
mod follows;
mod given_back;
mod gross;
mod halves;
mod joint_curves;
mod judge;
mod lags;
mod late;
mod likelihood;
mod lines;
mod nameless;
mod offered;
mod partial_fits;
mod possible;
mod rescan;
mod row_parts;
pub mod scan;
mod scattering;
mod screen;
mod search;
mod search_result;
mod settled;
mod settling;
mod sheet;
mod sights;
pub mod slips;
mod start;
pub mod start_sides;
mod swallowed;
mod unbent;
mod unweighed_springs;
mod weighed;
mod weights;

use super::candidates::Candidate;
use super::node::Node;
use super::question::Question;
use crate::error::Result;
use curve::Curve;
pub use follows::{Covariate, Follows};
use given_back::given_back;
pub use gross::gross;
use joint_curves::choice::Chosen;
pub use nameless::{Nameless, without};
use partial_fits::FIRST;
pub use possible::What;
use search::{AT_FIRST, BESIDE_SCATTER, WHOLE, search};
use search_result::Searched;
pub use sheet::{Moved, Scattered, Weights};
use start::Start;
pub use start::with_curves;
use unweighed_springs::sprung;
pub use weighed::{Curved, Doubt, Named, Stage, Unnamed, Weighed};
pub use weights::scatter;

/// Rounds of finding the orders of lines anew without a part of the poses.
const RESCANS: usize = 3;

/// Weighs everything, from a fit of geometry: first without error curves; where
/// joints turn out to have some, again from nothing beside them.
///
/// # Errors
/// When a fit does not converge.
pub fn weigh(q: &Question, root: &Node, progress: &dyn Fn()) -> Result<Weighed> {
    let regained = given_back(q, root);
    let root = regained.as_ref().unwrap_or(root);
    let (begin, mut plain) = from_geometry(q, root, progress)?;
    let found = (&plain.best.added[..], &plain.best.fit.fit.state);
    if let Some((node, bent)) = sprung(q, found, &plain.weights, plain.found.scale)? {
        let start = Start { bent, node, ..begin.clone() };
        plain = search(q, start, AT_FIRST, progress)?;
    }
    // What one line explains is no curve; it is weighed with everything else first.
    let Chosen { mut curves, mut lines, few } = plain.wanted(q);
    if !lines.is_empty() || !few.is_empty() {
        lines.extend(few.iter().flat_map(|few| few.lines.clone()));
        let start = Start { lines, ..plain.with_few(q, &few)? };
        plain = search(q, start, AT_FIRST, progress)?;
        curves = plain.wanted(q).curves;
    }
    if curves.is_empty() {
        let found = match plain.found.best.members.len() < FIRST.members {
            true => plain,
            // It went as far as it was let: farther.
            false => search(q, plain.again(), WHOLE, progress)?,
        };
        return replicated(q, found, progress)?.judged(q);
    }
    let (scale, refused, surely_refused) = (plain.found.scale, plain.refused, plain.surely_refused);
    let start = Start { curves, scale, refused, surely_refused, bent: plain.bent, ..begin };
    let first = search(q, start, AT_FIRST, progress)?;
    // At the noise that is left now, lengths and sizes are told better.
    let curves = first.wanted(q).curves;
    let mut again = Start { curves, ..first.again() };
    again.keep_tables();
    let mut found = replicated(q, search(q, again, WHOLE, progress)?, progress)?;
    loop {
        let mut less = found.again();
        let answer = found.judged(q)?;
        // Beside a joint that scatters what drew a curve may be nothing.
        let doubtful = |c: &Curve| {
            let is = |own: &Curved| usize::from(own.table.joint()) == c.joint && own.log_odds < 0.0;
            !answer.scattering.is_empty() && answer.curves.iter().any(is)
        };
        let all = less.curves.len();
        less.curves.retain(|c| !doubtful(c));
        if less.curves.len() == all {
            return Ok(answer);
        }
        less.keep_tables();
        found = replicated(q, search(q, less, WHOLE, progress)?, progress)?;
    }
}

/// A search from geometry and where it began: where evidence may have been lost to tails and
/// flags, with all rows alike.
fn from_geometry(q: &Question, root: &Node, progress: &dyn Fn()) -> Result<(Start, Searched)> {
    let start = Start::at(q, root);
    let found = search(q, start.clone(), AT_FIRST, progress)?;
    let Some(node) = swallowed::all_alike(q, root, &found) else { return Ok((start, found)) };
    let alike = Start { even: true, ..Start::at(q, &node) };
    Ok(match search(q, alike.clone(), AT_FIRST, progress) {
        Ok(other) if swallowed::is_better(q, &other, &found) => (alike, other),
        _ => (start, found),
    })
}

/// The same where joints may scatter by themselves, without lines that do not predict poses
/// held out of their scan; of their joints no other is looked for.
fn replicated(q: &Question, mut found: Searched, progress: &dyn Fn()) -> Result<Searched> {
    let mut dropped = Vec::new();
    loop {
        if let Some(change) = scattering::next(q, &found, &dropped) {
            dropped.extend(change.dropped());
            found = search(q, scattering::after(q, &found, change)?, BESIDE_SCATTER, progress)?;
            continue;
        }
        if found.ended {
            break;
        }
        found = search(q, found.again(), WHOLE, progress)?;
        // Of what is as it was, no other question has another answer.
        if found.still {
            break;
        }
    }
    for _ in 0..RESCANS {
        let ghosts = rescan::ghosts(q, &found);
        if ghosts.is_empty() {
            break;
        }
        let (out, kept): (Vec<Candidate>, Vec<Candidate>) =
            found.best.added.iter().cloned().partition(|c| ghosts.contains(c));
        let mut start = found.again();
        start.fit(q, kept)?;
        start.refused.extend(out);
        start.closed.extend(ghosts.iter().flat_map(|c| c.joints()).map(|joint| joint - 1));
        found = search(q, start, WHOLE, progress)?;
    }
    Ok(found)
}
