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
mod effect;
mod kind_noise;
pub mod moments;
mod mounting;
mod naming;
mod node;
mod noise_remarks;
mod onset;
mod orders;
mod outcome;
mod pipeline;
pub mod policy;
pub mod question;
mod remarks;
mod rounding;
mod show;
mod shown;
mod tell;
mod torques;
mod verdict;
pub mod weigh;
mod weighing;
mod white;

pub use described::{Described, ErrorCourse};
pub use effect::{Coefficient, Effect};
pub use naming::said;
pub use outcome::{Alternative, GapRow, GapUnit, Outcome, Verdict};
pub use tell::{instead, late, otherwise, place};
pub use weigh::Doubt;

use std::ops::RangeInclusive;

use crate::error::{Error, ErrorKind, Result};
use crate::evaluate::not_fitted;
use crate::identify::fit::folds;
use crate::identify::fit::robust::{Crowd, Flags};
use crate::identify::start::registration::register;
use crate::identify::start::{cameras, zeros};
use crate::identify::typical::as_measured;
use crate::identify::{Conditions, Options, Problem, RowResult, Scaling, State, blamed, enough};
use crate::model::{ErrorCurve, Measurements, Model, ModelTerm, Mounting, Robot};
use candidates::Candidate;
use moments::Moments;
use node::Node;
use pipeline::{answered, with_hand};
use policy::POLICY;
use question::Question;
use show::Show;
use shown::{Found, shown};
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
    /// The same of springs that would have been named.
    pub surely_against: bool,
}

impl Diagnosis {
    /// RMS by which poses held out are missed, in stated deviations of what was measured.
    fn misses(&self) -> f64 {
        let last = self.outcome.gap.last();
        let held = last.and_then(|last| last.cross_validated_rms_sigmas);
        held.map_or(f64::INFINITY, |held| held * self.outcome.noise_scale)
    }
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

/// Orders that a gear or an encoder may have, cycles a turn.
const ORDERS: RangeInclusive<f64> = 3.0..=2000.0;

impl DiagnoseOptions {
    /// Whether there is anything to look for.
    ///
    /// # Errors
    /// An order that no gear or encoder has, or no terms.
    pub fn sensible(&self) -> Result<()> {
        // NaN is in no range.
        if !ORDERS.contains(&self.highest_order) {
            let (low, high) = (ORDERS.start(), ORDERS.end());
            return Err(Error::usage(
                format!("a highest order of {}", self.highest_order),
                format!("give {low} to {high} cycles a turn"),
            ));
        }
        if self.most_terms == 0 {
            return Err(Error::usage(
                "a model of 0 terms",
                "give 1 or more; `identify` finds the geometry alone",
            ));
        }
        Ok(())
    }
}

/// Names what is missing in the geometry of `robot`. `holdout` poses are never
/// fitted; they only show.
///
/// # Errors
/// As for `identify` and [`DiagnoseOptions::sensible`], and a hold-out file of unknown stations
/// or of rows that are fitted; but rows that contradict each other are no error here, they are
/// what is shown.
pub fn diagnose(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    options.sensible()?;
    if let Some(held) = holdout {
        same_torques(robot, data, held)?;
        not_fitted(&data.path.display().to_string(), data.shared(held), held)?;
    }
    // An effect of the arm and a wrong zero of an instrument look like each other.
    let few = Options { allow_few_poses: options.allow_few_poses, ..Options::default() };
    let affordable =
        |freed: &Measurements| enough(&Problem::new(freed, robot, Scaling::Prior), &few).is_ok();
    let freed = zeros::freed(data).filter(affordable);
    let with_zeros = |held| freed.as_ref().map(|freed| zeros::as_found(held, &freed.instruments));
    let held = holdout.and_then(with_zeros);
    let (data, holdout) = (freed.as_ref().unwrap_or(data), held.as_deref().or(holdout));
    let of = |data: &Measurements| whatever_holds(robot, data, holdout, options, progress);
    let found = of(data);
    let Some(other) = cameras::freed(robot, data).filter(affordable) else { return found };
    match of(&other) {
        Ok(other) if found.as_ref().is_ok_and(|found| found.misses() <= other.misses()) => found,
        Ok(mut other) => {
            let cameras = cameras::found(&data.instruments, &other.model.instruments);
            other.outcome.figures.warnings.extend(cameras);
            Ok(other)
        }
        Err(_) => found,
    }
}

fn needs_masses(term: &ModelTerm) -> bool {
    matches!(term, ModelTerm::Arm(own) if own.needs_masses())
}

/// However the arm is mounted, and if more rows are off than can be gross errors.
fn whatever_holds(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    let with = |crowd, mounting| {
        let of =
            |robot: &Robot| diagnosed(robot, data, holdout, options, (crowd, mounting), progress);
        // What torques that were read say of masses counts where something gives way that is no
        // joint; else springs follow what is read.
        let weighed = weighing::weighed(robot, data, mounting).map(|robot| of(&robot));
        let moved = |found: &Diagnosis| found.state.terms.iter().any(needs_masses);
        match weighed {
            Some(Ok(found)) if moved(&found) => Ok(found),
            _ => of(robot),
        }
    };
    let mounted = |mounting| match with(Crowd::Refused, mounting) {
        Err(error) if error.kind() == ErrorKind::Contradiction => with(Crowd::Described, mounting),
        done => done,
    };
    mounting::tried(&mounted).map_err(|error| blamed(robot, data, error))
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
    let best = plausible(&question, added, &weighed.best.fit.fit.state)?;
    let show = Show {
        question: &question,
        rigid: &rigid,
        tables: &tables,
        holdout,
        robot,
        unloaded: &unloaded,
    };
    shown(&show, Found { weighed, best, root, start, not_testable })
}

/// The fit of what is of a sign and size that physics allows in it: beside what has no name
/// and is in no model, an effect takes up what that did.
fn plausible(q: &Question, mut added: Vec<Candidate>, near: &State) -> Result<Node> {
    loop {
        let fit = node::fitted(q, added, near)?;
        let bad = fit.implausible(&q.problem.conditions);
        if bad.is_empty() {
            return Ok(fit);
        }
        added = fit.added.into_iter().filter(|c| !bad.contains(c)).collect();
    }
}

/// Effects of the most probable model; where there are curves, those of the last stage.
fn kept(weighed: &Weighed) -> Vec<Candidate> {
    let mut added = weighed.best.added.clone();
    if let Some(stage) = weighed.stages.last() {
        added.retain(|candidate| stage.names.contains(&candidate.name()));
    }
    added
}
