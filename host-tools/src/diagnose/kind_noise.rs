//! How noisy each kind of measurement is.

use super::node::Node;
use super::question::Question;
use crate::error::{ErrorKind, Result};
use crate::identify::fit::robust::Crowd;
use crate::identify::{Noise, Problem, State, noise_estimate};

/// By how much each kind is noisier than stated, from a state; where many rows
/// contradict the others they are what is shown, and nothing is known of the noise.
///
/// # Errors
/// As for [`noise_estimate::noise`].
pub fn noise(problem: &Problem, rows: &[usize], state: &State, crowd: Crowd) -> Result<Noise> {
    let problem = problem.with_terms(state.terms.len());
    match noise_estimate::noise(&problem, rows, state) {
        Err(e) if crowd == Crowd::Described && e.kind() == ErrorKind::Contradiction => {
            Ok(problem.noise)
        }
        found => found,
    }
}

/// A change of what one kind weighs beside the others that is worth weighing anew.
const WEIGHS_OTHERWISE: f64 = 1.25;

/// The noise of each kind beside a model, if it is another than what was weighed with:
/// what geometry alone leaves is no noise, and weighs the kind that shows it least.
///
/// # Errors
/// As for [`noise_estimate::noise`].
pub fn heard_anew(q: &Question, best: &Node) -> Result<Option<Noise>> {
    let found = noise(q.problem, q.rows, &best.fit.fit.state, q.flags.crowd)?;
    let ratios = found.over(&q.problem.noise, q.problem.data);
    let [least, most] = [f64::min, f64::max].map(|of| ratios.iter().copied().reduce(of));
    let apart = least.zip(most).is_some_and(|(least, most)| most > WEIGHS_OTHERWISE * least);
    Ok(apart.then_some(found))
}
