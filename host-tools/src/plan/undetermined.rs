//! What stays open however many measurements of a kind are made, in words.

use super::{Candidate, Imagined, PlanOptions};
use crate::error::Result;
use crate::identify::certainty::scale::{SCALE_OPEN, is_open};
use crate::model::Robot;
use crate::observations::KINDS;

/// Of these measurements; of the kind in general where its candidates leave something open. The
/// scale may be open of those that were chosen though others would have told it.
pub fn words(
    robot: &Robot,
    options: &PlanOptions,
    chosen: &[Candidate],
    open: bool,
) -> Result<Vec<String>> {
    let imagined = Imagined::new(robot, chosen, options.kind, &options.instruments)?;
    let problem = imagined.problem(robot);
    let kind = KINDS[usize::from(options.kind.0)];
    let scale = is_open(&problem, imagined.state()).then(|| SCALE_OPEN.to_owned());
    let leaves = format!("{} alone leaves open: {}", kind.name(), kind.leaves());
    Ok(scale.into_iter().chain(open.then_some(leaves)).collect())
}
