//! Which kind of measurement keeps the others from agreeing.

use super::problem::{Problem, Scaling};
use crate::error::{Error, ErrorKind};
use crate::identify::fit::robust::{Flags, robust_fit};
use crate::identify::problem::{Noise, State};
use crate::identify::start::registration::register;
use crate::model::{KindId, Measurements, Robot};
use crate::observations::KINDS;
use crate::statistics::median;

/// The error of a fit to data, naming the kind to blame, if one is.
#[must_use]
pub fn blamed(robot: &Robot, data: &Measurements, error: Error) -> Error {
    let problem = Problem::rigid(data, robot, Scaling::Prior);
    match register(data, &problem.nominal, robot.tool) {
        Ok(start) => {
            let problem = problem.about(&start);
            named(&problem, &problem.counted(), &start, error)
        }
        Err(_) => error,
    }
}

/// Standard deviation of a normalised residual below which rows agree.
const AGREE: f64 = 3.0;

/// The error of a fit, naming the kind without whose rows the others agree, if one is: the
/// farthest off first, and of several that one without which they agree best.
#[must_use]
pub(super) fn named(problem: &Problem, rows: &[usize], start: &State, error: Error) -> Error {
    if !matches!(
        error.kind(),
        ErrorKind::NotConverged | ErrorKind::Contradiction | ErrorKind::Singular
    ) {
        return error;
    }
    let data = problem.data;
    let mut kinds: Vec<KindId> = rows.iter().map(|row| data.rows[*row].kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    if let [kind] = kinds[..] {
        let known = KINDS[usize::from(kind.0)];
        let help = format!("check {}; or else: {}", known.check(), error.help());
        let pointless = kind != KindId::default();
        return if pointless { Error::data(error.kind(), error.to_string(), help) } else { error };
    }
    let noise = Noise::default();
    let problem = Problem { noise, scaling: Scaling::Prior, ..problem.clone() };
    let unknowns = problem.unknowns.list().len();
    let without = |kind: KindId| {
        let others: Vec<usize> =
            rows.iter().copied().filter(|row| data.rows[*row].kind != kind).collect();
        // Few rows agree with anything.
        let enough = problem.equations(&others) >= unknowns;
        let fit = || robust_fit(&problem, &others, start, Flags::default());
        let found = enough.then(fit)?.ok()?;
        Some((found.scale, kind))
    };
    let far = misfits(&problem, rows, start, &kinds);
    let mut order: Vec<usize> = (0..kinds.len()).collect();
    order.sort_by(|a, b| far[*b].total_cmp(&far[*a]));
    let mut best: Option<(f64, KindId)> = None;
    for (scale, kind) in order.into_iter().filter_map(|k| without(kinds[k])) {
        if best.is_none_or(|(least, _)| scale < least) {
            best = Some((scale, kind));
        }
        // No need to look whether others do as well: a fit that fails is a long one.
        if scale < AGREE {
            break;
        }
    }
    let Some((scale, kind)) = best else { return error };
    let known = KINDS[usize::from(kind.0)];
    let others = if scale < AGREE {
        "which agree without them".to_owned()
    } else {
        format!("which fit best without them, to {scale:.0} standard deviations")
    };
    Error::data(
        error.kind(),
        format!(
            "{}: the rows of kind {} contradict all others, {others}",
            data.path.display(),
            known.name()
        ),
        format!("check {}", known.check()),
    )
}

/// How far off the rows of each kind are at a state, in the middle, in standard deviations.
fn misfits(problem: &Problem, rows: &[usize], start: &State, kinds: &[KindId]) -> Vec<f64> {
    let at = problem.linearise(start);
    let of = |kind: &KindId| {
        let own = rows.iter().filter(|row| problem.data.rows[**row].kind == *kind);
        median(&own.map(|row| at.scaled_residual(*row).amax()).collect::<Vec<_>>())
    };
    kinds.iter().map(of).collect()
}
