//! Which kinds of measurements effects are named from, and how noisy each is.

use super::node::Node;
use super::question::Question;
use crate::error::{Kind, Result};
use crate::identify::robust::Crowd;
use crate::identify::{Noise, Problem, State, components};
use crate::model::Measurements;
use crate::observations::{kind, not_taken, to_point};

/// Rows as effects are named from them: of a pose its point, of other kinds what they
/// measure of where the target is.
///
/// # Errors
/// Rows of a kind that hangs on how the last frame is turned, or on two postures of
/// the arm: how effects move those is not worked out.
pub fn taken(data: &Measurements) -> Result<Measurements> {
    let mut out = data.clone();
    for (i, row) in out.rows.iter_mut().enumerate() {
        let own = kind(row);
        if !to_point(row) && (own.turns() || own.joined_by().is_some()) {
            let give = "points, poses, distances, touches, holes of a plate or closures";
            return Err(not_taken(data, i, "diagnose", give));
        }
    }
    let used: Vec<usize> = (0..out.instruments.len())
        .filter(|i| out.rows.iter().any(|r| r.refers.contains(i)))
        .collect();
    out.instruments = used.iter().map(|i| data.instruments[*i].clone()).collect();
    let places = out.rows.iter_mut().flat_map(|row| &mut row.refers);
    places.for_each(|i| *i = used.iter().position(|u| u == i).unwrap_or(0));
    Ok(out)
}

/// By how much each kind is noisier than stated, from a state; where many rows
/// contradict the others they are what is shown, and nothing is known of the noise.
///
/// # Errors
/// As for [`components::noise`].
pub fn noise(problem: &Problem, rows: &[usize], state: &State, crowd: Crowd) -> Result<Noise> {
    let problem = problem.with_terms(state.terms.len());
    match components::noise(&problem, rows, state) {
        Err(e) if crowd == Crowd::Described && e.kind() == Kind::Contradiction => Ok(problem.noise),
        found => found,
    }
}

/// A change of what one kind weighs beside the others that is worth weighing anew.
const WEIGHS_OTHERWISE: f64 = 1.25;

/// The noise of each kind beside a model, if it is another than what was weighed with:
/// what geometry alone leaves is no noise, and weighs the kind that shows it least.
///
/// # Errors
/// As for [`components::noise`].
pub fn heard_anew(q: &Question, best: &Node) -> Result<Option<Noise>> {
    let found = noise(q.problem, q.rows, &best.fit.fit.state, q.flags.crowd)?;
    let ratios = found.over(&q.problem.noise, q.problem.data);
    let [least, most] = [f64::min, f64::max].map(|of| ratios.iter().copied().reduce(of));
    let apart = least.zip(most).is_some_and(|(least, most)| most > WEIGHS_OTHERWISE * least);
    Ok(apart.then_some(found))
}
