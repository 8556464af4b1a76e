//! RPIM: from measurements to identified parameters.
//!
//! registration (first guesses) -> robust fit (flags) -> lambda -> fit ->
//! cross-validation -> report. Nothing here reads or writes a file.

mod blame;
mod blind_tool;
pub mod certainty;
pub mod cross_validation;
mod figures;
pub mod fit;
mod kind_figures;
pub mod noise_estimate;
pub mod problem;
mod remarks;
pub mod start;
mod summary;
#[cfg(test)]
mod tests;
pub mod typical;

pub use blame::blamed;
pub use figures::{AllRows, Condition, Drawn, Figures, FlaggedRow};
pub use fit::{LCurvePoint, LambdaChoice, LambdaRule, choose, l_curve};
pub use kind_figures::KindFigures;
pub use problem::{
    Beside, Conditions, Equations, Layout, Linearised, Noise, Place, Predictor, Problem, Scaling,
    Scatterer, State, Surroundings, TOLERANCE_ANGLE, TOLERANCE_LENGTH, Target, Turns, Unit,
    Unknown, Unknowns, View, firmness, in_deviations, link_corrections, measurement_column,
    spreads,
};
pub(crate) use problem::{Group, groups};
pub use start::{Pairs, rigid_transform};
pub use summary::Findings;

use crate::error::{Error, ErrorKind, Result};
use crate::model::{KindId, Measurements, Model, Robot, Row};
use crate::observations::{Residual, kind, measuring};
use crate::tikhonov::Normal;
use certainty::scale;
use cross_validation::cross_validate;
use fit::estimate::{Estimate, estimate};
use fit::folds;
use fit::{Freedom, fit};

/// What the user may choose.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// How lambda is chosen.
    pub rule: LambdaRule,
    /// What lambda weighs.
    pub scaling: Scaling,
    /// Identify even where the measurements give fewer equations than unknowns.
    pub allow_few_poses: bool,
}

/// The result.
#[derive(Debug, Clone)]
pub struct Identification {
    /// For evaluation and packing.
    pub model: Model,
    /// Figures.
    pub figures: Figures,
    /// Per row: residual of the fit, held-out residual, flagged; m.
    pub rows: Vec<RowResult>,
    /// What the rows say of the links, frames and instruments taken out: their
    /// corrections beyond the expected ones in units of the problem.
    pub links: Normal,
}

/// What became of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowResult {
    /// Measured minus nominal geometry, SI.
    pub nominal: Residual,
    /// Measured minus identified, SI.
    pub identified: Residual,
    /// Measured minus predicted without its fold, SI.
    pub held_out: Option<Residual>,
    /// Flagged as a gross error.
    pub flagged: bool,
}

/// Called with (done, of so many) as the work goes on.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Identifies the arm.
///
/// # Errors
/// Too few or too similar poses, points on a line, or data that contradict the
/// nominal geometry; each with its remedy.
pub fn identify(
    robot: &Robot,
    data: &Measurements,
    options: &Options,
    progress: Progress,
) -> Result<Identification> {
    let pointless = |row: &Row| row.kind != KindId::default();
    if options.scaling == Scaling::Printed && data.rows.iter().any(pointless) {
        return Err(Error::usage(
            "--scaling printed weighs metres, and the file has more than points",
            "leave it out: the prior scaling weighs every kind by its own sigma",
        ));
    }
    enough(&Problem::rigid(data, robot, options.scaling), options)?;
    let robot = &*typical::as_measured(robot, data)?;
    let problem = Problem::rigid(data, robot, options.scaling);
    let start = start::first(&problem, robot.tool)?;
    let mut problem = problem.about(&start);
    let rows = problem.counted();
    let blamed = |problem: &Problem, e: Error| blame::named(problem, &rows, &start, e);
    let noise = noise_estimate::noise(&problem, &rows, &start);
    problem.noise = noise.map_err(|e| blamed(&problem, e))?;
    let rule = in_force(options.rule, &problem, &start);
    let folds = folds::random(data, &rows, folds::SEED);
    let blocks = folds::blocked(data, &rows);
    let total = 1 + folds.len() + blocks.as_ref().map_or(0, Vec::len);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let tick = || {
        let now = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        progress(now, total);
    };

    let found = estimated(&problem, rule, &rows, &start).map_err(|e| blamed(&problem, e))?;
    noise_estimate::none_is_lost(data, &rows, &found.robust.outliers)?;
    tick();
    let held_out = cross_validate(&problem, rule, &folds, &found, &tick)?;
    let blocked = match &blocks {
        Some(folds) => Some(cross_validate(&problem, rule, folds, &found, &tick)?),
        None => None,
    };
    let nominal = nominal_state(&problem, &found.robust.kept, &start)?;
    let identified = Findings {
        rule,
        robot,
        problem: &problem,
        rigid: &problem,
        curves: Vec::new(),
        nominal,
        found,
        held_out,
        blocked,
        cross_validation: folds_in_words(folds.len(), data.poses),
    }
    .summarise();
    noise_estimate::none_is_given_up(&problem, &identified.figures.kinds)?;
    Ok(identified)
}

/// The estimate; where it fails, or leaves more than the nominal links do, once more from
/// frames and instruments that were fitted beside those. What an arm of few joints carries
/// has several places that nearly fit.
fn estimated(
    problem: &Problem,
    rule: LambdaRule,
    rows: &[usize],
    start: &State,
) -> Result<Estimate> {
    let left = |state: &State, rows: &[usize]| -> f64 {
        let at = problem.linearise(state);
        rows.iter().map(|row| at.scaled_residual(*row).norm_squared()).sum()
    };
    let first = estimate(problem, rule, rows, start, true);
    let kept = first.as_ref().map_or(rows, |found| &found.robust.kept);
    let Ok(nominal) = nominal_state(problem, kept, start) else { return first };
    if let Ok(found) = &first
        && left(&found.fit.state, kept) <= MORE * left(&nominal, kept)
    {
        return first;
    }
    match (first, estimate(problem, rule, rows, &nominal, true)) {
        (Ok(found), Ok(again)) => {
            let of = |found: &Estimate| left(&found.fit.state, rows);
            Ok(if of(&again) < of(&found) { again } else { found })
        }
        (first, again) => again.or(first),
    }
}

/// How much more a regularised fit may leave than nominal links: rounding, no more.
const MORE: f64 = 1.0 + 1e-6;

/// How lambda is chosen. Where no length is held against the arm a smaller arm fits better:
/// nothing but the tolerances holds it, at their own weight.
fn in_force(asked: LambdaRule, problem: &Problem, start: &State) -> LambdaRule {
    let given = matches!(asked, LambdaRule::Fixed(_));
    match !given && scale::is_open(problem, start) {
        true => LambdaRule::MaximumAPosteriori,
        false => asked,
    }
}

/// How it was cross-validated.
fn folds_in_words(folds: usize, poses: usize) -> String {
    match folds {
        n if n == poses => format!("leave-one-out over {n} poses"),
        n => format!("{n} random folds of poses"),
    }
}

/// Base and tool registered with nominal links.
///
/// # Errors
/// As for [`fit::fit`].
pub fn nominal_state(problem: &Problem, rows: &[usize], start: &State) -> Result<State> {
    let prior = Problem { scaling: Scaling::Prior, ..problem.with_terms(0) };
    let mut start = State { links: problem.nominal.clone(), terms: Vec::new(), ..start.clone() };
    if let Some(some) = folds::sample(problem.data, rows) {
        start = fit(&prior, &some, None, &start, Freedom::Frames)?.state;
    }
    Ok(fit(&prior, rows, None, &start, Freedom::Frames)?.state)
}

/// Enough equations for the unknowns?
pub(crate) fn enough(problem: &Problem, options: &Options) -> Result<()> {
    let data = problem.data;
    if data.poses == 1 {
        return Err(Error::data(
            ErrorKind::TooFewPoses,
            format!("{}: all rows have the same joint values", data.path.display()),
            "measure different poses; column q1_deg.. is the encoder reading of each",
        ));
    }
    let key = |i: &usize| {
        let row = &data.rows[*i];
        // Another point of the same pose is the same; another label is not.
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<u64>>();
        let own = if kind(row).point(row).is_some() { Vec::new() } else { bits(&row.measured) };
        (row.pose, row.marker, row.kind.0, row.refers.clone(), own)
    };
    let mut distinct = measuring(&data.rows);
    distinct.sort_by_key(key);
    distinct.dedup_by_key(|i| key(i));
    let (points, equations) = (distinct.len(), problem.equations(&distinct));
    let unknowns = problem.unknowns.list().len();
    if equations < unknowns && !options.allow_few_poses {
        return Err(Error::data(
            ErrorKind::TooFewEquations,
            format!(
                "{}: {points} distinct points give {equations} equations for {unknowns} unknowns",
                data.path.display(),
            ),
            format!("measure at least {} poses, better 50", fewest(unknowns, equations, points)),
        ));
    }
    Ok(())
}

/// How many measurements are taken at least, of which so many give so many equations: as many
/// equations as unknowns, though points do not determine them all.
#[must_use]
pub fn fewest(unknowns: usize, equations: usize, of: usize) -> usize {
    (unknowns * of).div_ceil(equations.max(1))
}

/// The error of an identification for a caller who may go on with fewer equations than unknowns,
/// by this option.
#[must_use]
pub fn allowing(error: Error, option: &str) -> Error {
    if error.kind() != ErrorKind::TooFewEquations {
        return error;
    }
    error.advising(&format!(
        "; {option} goes on, and the tolerances then decide what the data leave open"
    ))
}
