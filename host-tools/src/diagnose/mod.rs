//! Find, name, add, show: what rigid geometry cannot explain.
//!
//! robust geometric fit -> *where* the residuals are -> *what* explains them
//! ([`weigh`]) -> *show* the gap shrink on held-out poses -> verdict on what is
//! left.

mod beside;
pub mod candidates;
mod chi_square;
mod crowd;
mod described;
mod kind_noise;
pub mod moments;
mod mounting;
mod naming;
mod node;
mod orders;
mod outcome;
mod pipeline;
pub mod policy;
pub mod question;
mod remarks;
mod show;
mod tell;
mod torques;
mod verdict;
pub mod weigh;
mod white;

pub use described::{Described, ErrorCourse};
pub use naming::said;
pub use outcome::{Alternative, Coefficient, Effect, GapRow, GapUnit, Outcome, Verdict};
pub use tell::{instead, late, otherwise, place};
pub use weigh::Doubt;

use crate::error::{ErrorKind, Result};
use crate::identify::fit::estimate::Estimate;
use crate::identify::fit::folds;
use crate::identify::fit::robust::{Crowd, Flags};
use crate::identify::start::registration::register;
use crate::identify::start::{cameras, zeros};
use crate::identify::typical::as_measured;
use crate::identify::{
    Conditions, Findings, LambdaRule, Options, Problem, RowResult, Scaling, State, blamed, enough,
    nominal_state,
};
use crate::model::{ErrorCurve, Measurements, Model, ModelTerm, Mounting, Robot};
use crate::observations::kind;
use candidates::Candidate;
use moments::Moments;
use node::Node;
use pipeline::{answered, with_hand};
use policy::POLICY;
use question::Question;
use show::{HeldOut, Show};
use torques::same_torques;
use weigh::{Weighed, with_curves};

/// The result.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// With all terms, for evaluation and packing.
    pub model: Model,
    /// Figures and names.
    pub outcome: Outcome,
    /// Per row.
    pub rows: Vec<RowResult>,
    /// What was named, with base, marker and terms.
    pub state: State,
    /// The alternatives of the report, in its order.
    pub alternatives: Vec<State>,
    /// Springs fitted, but gave way against gravity as it was assumed.
    pub against_gravity: bool,
}

/// What the user may choose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnoseOptions {
    /// Highest order of a periodic error to scan, cycles a turn.
    pub highest_order: f64,
    /// Most terms of the arm that the model may have.
    pub most_terms: usize,
    /// Go on with fewer equations than unknowns.
    pub allow_few_poses: bool,
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        Self { highest_order: 420.0, most_terms: 128, allow_few_poses: false }
    }
}

/// Names what is missing in the geometry of `robot`. `holdout` poses are never
/// fitted; they only show.
///
/// # Errors
/// As for `identify`, and a hold-out file of unknown stations; but rows that
/// contradict each other are no error here, they are what is shown.
pub fn diagnose(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    if let Some(held) = holdout {
        same_torques(robot, data, held)?;
    }
    // An effect of the arm and a wrong zero of an instrument look like each other.
    let few = Options { allow_few_poses: options.allow_few_poses, ..Options::default() };
    let affordable =
        |freed: &Measurements| enough(&Problem::new(freed, robot, Scaling::Prior), &few).is_ok();
    let stated = data;
    let freed = zeros::freed(data).filter(affordable);
    let seen = cameras::freed(robot, freed.as_ref().unwrap_or(data)).filter(affordable);
    let freed = seen.or(freed);
    let with_zeros = |held| freed.as_ref().map(|freed| zeros::as_found(held, &freed.instruments));
    let held = holdout.and_then(with_zeros);
    let (data, holdout) = (freed.as_ref().unwrap_or(data), held.as_deref().or(holdout));
    let with =
        |crowd, mounting| diagnosed(robot, data, holdout, options, (crowd, mounting), progress);
    let mounted = |mounting| match with(Crowd::Refused, mounting) {
        Err(error) if error.kind() == ErrorKind::Contradiction => with(Crowd::Described, mounting),
        done => done,
    };
    let mut found = mounting::tried(&mounted).map_err(|error| blamed(robot, data, error))?;
    let of_cameras = cameras::found(&stated.instruments, &found.model.instruments);
    found.outcome.figures.warnings.extend(of_cameras);
    Ok(found)
}

fn diagnosed(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    (crowd, mounting): (Crowd, Mounting),
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    let read = data.has_torques();
    let stated = robot;
    let assumed = (!read).then(|| robot.with_assumed_loads(mounting)).flatten();
    let robot = assumed.as_ref().unwrap_or(robot);
    // Masses that were stated are as they are, however gravity pulls.
    let weightless = assumed.is_some() && stated.links.is_empty();
    let few = Options { allow_few_poses: options.allow_few_poses, ..Options::default() };
    enough(&Problem::new(data, robot, Scaling::Prior), &few)?;
    let robot = &*as_measured(robot, data)?;
    let unloaded = Robot { gravity: stated.gravity, links: stated.links.clone(), ..robot.clone() };
    let problem = Problem::new(data, robot, Scaling::Prior);
    let rows = problem.counted();
    let start = register(data, &problem.nominal, robot.tool)?;
    let mut problem = problem.about(&start);
    problem.noise = kind_noise::noise(&problem, &rows, &start, crowd)?;
    let flags = Flags { lambda: 1.0, gross: POLICY.gross, crowd };
    let sided = weigh::start_sides::found(&problem, &rows, &start, flags)?;
    let data = sided.as_ref().unwrap_or(data);
    if sided.is_some() {
        let noise = problem.noise;
        problem = Problem { noise, ..Problem::new(data, robot, Scaling::Prior).about(&start) };
    }
    let (offered, not_testable) = candidates::all(&problem, robot, weightless, holdout);
    let folds = folds::random(data, &rows, folds::SEED);
    // Torques that were read need no masses.
    let moments = (!read).then(|| Moments::of(robot, weightless)).flatten();
    let mut question = Question {
        problem: &problem,
        offered: &offered,
        highest_order: options.highest_order,
        flags,
        rows: &rows,
        folds: &folds,
        moments: moments.as_ref(),
        most_terms: options.most_terms,
    };
    let mut answer = answered(&mut question, &start, progress)?;
    let anew = kind_noise::heard_anew(&question, &answer.1.best)?;
    let problem = Problem { noise: anew.unwrap_or(problem.noise), ..problem.clone() };
    question = Question { problem: &problem, ..question };
    if anew.is_some() {
        answer = answered(&mut question, &start, progress)?;
    }
    let (root, weighed) = with_hand(&question, &start, answer, progress);
    let added = kept(&weighed);
    // Masses are found by what they bend: of a model without springs they stay.
    let bends = added.iter().any(|candidate| moments::bends(candidate.name()));
    let found = weighed.moments.as_ref().filter(|_| bends).and_then(Moments::robot);
    let robot = found.as_ref().unwrap_or(robot);
    progress("held-out poses");
    // What is fitted and judged from here on has the noise that was found.
    let heard = data.with_noise(weighed.scale);
    let loaded = Conditions::at(&heard, robot, &weighed.best.fit.fit.state.links);
    let rigid = Problem::under(&heard, robot, Scaling::Prior, loaded).about(&start);
    let rigid = Problem { noise: problem.noise, ..rigid };
    let root = node::geometry(&Question { problem: &rigid, ..question }, &root.fit.fit.state)?;
    let tables: Vec<ErrorCurve> = weighed.curves.iter().map(|c| c.table.clone()).collect();
    let mut problem = with_curves(&rigid, &tables);
    problem.scattering.clone_from(&weighed.scattering);
    let question = Question { problem: &problem, ..question };
    let best = node::fitted(&question, added, &weighed.best.fit.fit.state)?;
    let unloaded = assumed.is_some().then_some(&unloaded);
    let show =
        Show { question: &question, rigid: &rigid, tables: &tables, holdout, robot, unloaded };
    shown(&show, Found { weighed, best, root, start, not_testable })
}

/// Whether a term of a state bends under loads.
fn has_loads(state: &State) -> bool {
    let loaded = |t: &ModelTerm| matches!(t, ModelTerm::Arm(term) if term.needs_load());
    state.terms.iter().any(loaded)
}

/// Effects of the most probable model; where there are curves, those of the last stage.
fn kept(weighed: &Weighed) -> Vec<Candidate> {
    let mut added = weighed.best.added.clone();
    if let Some(stage) = weighed.stages.last() {
        added.retain(|candidate| stage.names.contains(&candidate.name()));
    }
    added
}

/// What was found.
struct Found {
    weighed: Weighed,
    best: Node,
    root: Node,
    /// Where the first fit began.
    start: State,
    not_testable: Vec<String>,
}

/// The model, and what shows how good it is.
fn shown(show: &Show, found: Found) -> Result<Diagnosis> {
    let Found { weighed, best, root, start, not_testable } = found;
    let problem = show.question.problem;
    let holdout = show.holdout.map(|held| held.with_noise(weighed.scale));
    let show = &Show { holdout: holdout.as_ref(), ..*show };
    let nominal = nominal_state(show.rigid, &best.fit.kept, &start)?;
    let shown = match weighed.stages.is_empty() {
        true => show.with_held_out_gain(&root, best, &nominal)?,
        false => show.beside_curves(&root, best, &nominal, &weighed.stages)?,
    };
    let (best, gap, held_out) = (shown.best, shown.gap, shown.held_out);
    let (whereabouts, least) = tell::sentences(show.rigid, &root, show.question.flags.lambda);
    let goes_with = least.filter(|(p, _)| *p < POLICY.beyond_chance).map(|(_, words)| words);
    let described = described::described(problem, &weighed);
    let judged = (&weighed, &described[..]);
    let (verdict, unnamed) = verdict::verdict(problem, judged, &best, &gap, goes_with);
    let alternatives = show::alternatives(show.question, show.robot, &best, &weighed.rivals);
    let (alternatives, rivals): (_, Vec<State>) = alternatives.into_iter().unzip();
    // What was assumed and moves nothing is in no model.
    let bent = rivals.iter().chain([&best.fit.fit.state]).any(has_loads);
    let robot = show.unloaded.filter(|_| !bent).unwrap_or(show.robot);
    let show = &Show { robot, ..*show };
    let terms = problem.with_terms(best.fit.fit.state.terms.len());
    let findings = findings(show, &terms, &best, nominal, held_out)?;
    let against_gravity = show.unloaded.is_some_and(|stated| stated.gravity.is_none())
        && weighed.refused.iter().any(|c| moments::bends(c.name()));
    let mut identified = findings.summarise();
    let point = &mut identified.figures.uncertainty.tool_point;
    *point = point.with(weighed.by_curves.mean, weighed.by_curves.largest);
    identified.figures.warnings.extend(remarks::all(problem, &best, &weighed));
    let worse = remarks::worse_elsewhere(problem.data, show.holdout, &gap);
    identified.figures.warnings.extend(worse);
    let hold_out = show.hold_out(&best)?;
    identified.figures.warnings.extend(hold_out.iter().flat_map(remarks::standing_out));
    identified.figures.warnings.extend(zeros::found(&identified.model.instruments));
    let kinds = &mut identified.figures.kinds;
    kinds.iter_mut().for_each(|kind| kind.noise_scale *= weighed.scale);
    let noise_scale = weighed.scale * problem.noise.middle(problem.data);
    let (effects, suspected) = show::effects(&findings, &gap, &best, &weighed);
    let outcome = Outcome {
        figures: identified.figures,
        verdict,
        effects,
        suspected,
        unnamed,
        described,
        noise_scale,
        beyond_repeats: remarks::over_repeats(problem, &best),
        nested_rms_mm: weighed.nested_rms_mm(&best),
        noise_floor_mm: noise_floor(problem.data) * 1e3 / weighed.scale,
        reduced_chi_square: best.reduced,
        geometry_reduced_chi_square: root.reduced,
        gap,
        hold_out,
        alternatives,
        not_testable,
        whereabouts,
    };
    Ok(Diagnosis {
        model: identified.model,
        outcome,
        rows: identified.rows,
        state: best.fit.fit.state,
        alternatives: rivals,
        against_gravity,
    })
}

/// 3-D RMS that the stated standard deviations leave, m.
fn noise_floor(data: &Measurements) -> f64 {
    let rows = &data.rows;
    let variance: f64 = rows.iter().map(|r| kind(r).noise(r).powi(2)).sum();
    (variance / rows.len() as f64).sqrt()
}

/// The final model as an estimate, with its held-out errors.
fn findings<'a>(
    show: &Show<'a>,
    problem: &'a Problem<'a>,
    best: &Node,
    nominal: State,
    held_out: HeldOut,
) -> Result<Findings<'a>> {
    let q = show.question;
    let blocked = match folds::blocked(problem.data, q.rows) {
        Some(folds) if show.tables.is_empty() => Some(show.held_out(best, &folds)?),
        _ => None,
    };
    Ok(Findings {
        rule: LambdaRule::MaximumLikelihood,
        robot: show.robot,
        problem,
        rigid: show.rigid,
        nominal,
        found: Estimate {
            fit: best.fit.fit.clone(),
            robust: best.fit.clone(),
            lambda: q.flags.lambda,
            choice: None,
            solved: None,
        },
        curves: show.tables.to_vec(),
        held_out,
        blocked,
        cross_validation: format!(
            "{} folds of poses, flags redone in each, terms held",
            q.folds.len()
        ),
    })
}
