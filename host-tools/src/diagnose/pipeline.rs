//! From rows and the arm of a robot file to a model and what shows how good it is: loads,
//! registration, what the data hold beyond geometry, the final fit.

use super::bending;
use super::candidates::{self, Candidate};
use super::kind_noise;
use super::moments::Moments;
use super::node::{self, Node};
use super::options::DiagnoseOptions;
use super::policy::POLICY;
use super::question::Question;
use super::show::Show;
use super::shown::{Diagnosis, Found, shown};
use super::weigh::{Weighed, start_sides, weigh, with_curves};

use crate::error::Result;
use crate::identify::certainty::scale;
use crate::identify::fit::folds;
use crate::identify::fit::robust::{Crowd, Flags};
use crate::identify::start::first;
use crate::identify::typical::as_measured;
use crate::identify::{Conditions, Noise, Options, Problem, Scaling, State, enough};
use crate::model::{ErrorCurve, Measurements, Mounting, Robot};

/// Names what is missing of an arm that is mounted so, where so many rows may be off.
///
/// # Errors
/// As for `identify`.
pub fn diagnosed(
    stated: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    (crowd, mounting): (Crowd, Mounting),
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    let numbered = data.numbered();
    let data = numbered.as_ref().unwrap_or(data);
    let assumed = (!data.has_torques()).then(|| stated.with_assumed_loads(mounting)).flatten();
    let robot = assumed.as_ref().unwrap_or(stated);
    let few = Options { allow_few_poses: options.allow_few_poses, ..Options::default() };
    enough(&Problem::new(data, robot, Scaling::Prior), &few)?;
    let robot = &*as_measured(robot, data)?;
    let unloaded = Robot { gravity: stated.gravity, links: stated.links.clone(), ..robot.clone() };
    // Masses that were stated are as they are, however gravity pulls.
    let weightless = assumed.is_some() && stated.links.is_empty();
    let arm = Arm { robot, unloaded: &unloaded, weightless };
    of_arm(&arm, data, holdout, options, crowd, progress)
}

/// An arm with the loads that it is diagnosed with.
struct Arm<'a> {
    robot: &'a Robot,
    /// With none but those that were stated.
    unloaded: &'a Robot,
    /// Nobody stated what its links weigh.
    weightless: bool,
}

fn of_arm(
    arm: &Arm,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    crowd: Crowd,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    let robot = arm.robot;
    let problem = Problem::new(data, robot, Scaling::Prior);
    let rows = problem.counted();
    let start = first(&problem, robot.tool)?;
    let mut problem = problem.about(&start);
    problem.noise = kind_noise::noise(&problem, &rows, &start, crowd)?;
    let flags = Flags { lambda: 1.0, gross: POLICY.gross, crowd };
    let sided = start_sides::found(&problem, &rows, &start, flags)?;
    let noise = problem.noise;
    let begun = Begun { arm, told: data, holdout, options, start, flags, noise };
    begun.with_sides(sided, SIDES_AGAIN, progress)
}

/// How often sides are told again beside what was found with those before: twice is seldom.
const SIDES_AGAIN: usize = 2;

/// What is known before anything is weighed.
struct Begun<'a> {
    arm: &'a Arm<'a>,
    /// Sides are those that the file or the order of its rows tells.
    told: &'a Measurements,
    holdout: Option<&'a Measurements>,
    options: &'a DiagnoseOptions,
    start: State,
    flags: Flags,
    noise: Noise,
}

impl Begun<'_> {
    /// Weighs everything with the sides that were found; where these are others beside what
    /// that finds, once more with those.
    fn with_sides(
        &self,
        sided: Option<Measurements>,
        again: usize,
        progress: &dyn Fn(&'static str),
    ) -> Result<Diagnosis> {
        let Self { arm, holdout, options, start, .. } = self;
        let Arm { robot, weightless, .. } = **arm;
        let data = sided.as_ref().unwrap_or(self.told);
        let problem = Problem::new(data, robot, Scaling::Prior).about(start);
        let problem = Problem { noise: self.noise, ..problem };
        let rows = problem.counted();
        let (offered, not_testable) = candidates::all(&problem, robot, weightless, *holdout);
        let folds = folds::random(data, &rows, folds::SEED);
        // Torques that were read need no masses.
        let moments = (!data.has_torques()).then(|| Moments::of(robot, weightless)).flatten();
        let mut question = Question {
            problem: &problem,
            offered: &offered,
            highest_order: options.highest_order,
            flags: self.flags,
            rows: &rows,
            folds: &folds,
            moments: moments.as_ref(),
            most_terms: options.most_terms,
        };
        let mut answer = answered(&mut question, start, progress)?;
        let anew = kind_noise::heard_anew(&question, &answer.1.best)?;
        let problem = Problem { noise: anew.unwrap_or(problem.noise), ..problem.clone() };
        question = Question { problem: &problem, ..question };
        if anew.is_some() {
            answer = answered(&mut question, start, progress)?;
        }
        // Where that does not converge the first answer stands.
        if again > 0
            && let Some(next) = start_sides::found_beside(&question, &answer.1, self.told)
            && start_sides::differ(&next, data, &answer.1.best)
            && let Ok(other) = self.with_sides(Some(next), again - 1, progress)
        {
            return Ok(other);
        }
        let answer = with_hand(&question, start, answer, progress);
        progress("held-out poses");
        modelled(&question, arm, *holdout, answer, (start.clone(), not_testable))
    }
}

/// Geometry alone, at a lambda that it bears out, and what is weighed beyond it.
///
/// # Errors
/// When a fit does not converge.
fn answered(
    question: &mut Question,
    start: &State,
    progress: &dyn Fn(&'static str),
) -> Result<(Node, Weighed)> {
    progress("geometry");
    question.flags.lambda = 1.0;
    let first = node::geometry(question, start)?;
    question.flags.lambda = believable_lambda(question.problem, &first);
    let root = node::geometry(question, &first.fit.fit.state)?;
    progress("weighing effects");
    let weighed = weigh(question, &root, &|| progress("weighing effects"))?;
    Ok((root, weighed))
}

/// An answer, or the one with a hand where the masses stated of the wrist are refuted and
/// poses whose fold took no part in anything are missed by less then.
fn with_hand(
    question: &Question,
    start: &State,
    answer: (Node, Weighed),
    progress: &dyn Fn(&'static str),
) -> (Node, Weighed) {
    let Some(moments) = answer.1.moments.as_ref().and_then(Moments::with_hand) else {
        return answer;
    };
    let mut question = Question { moments: Some(&moments), ..*question };
    // Where that does not converge the first answer stands.
    let Ok(other) = answered(&mut question, start, progress) else { return answer };
    // Of rows that both keep: whoever flags more has less to miss.
    let kept = &answer.1.best.fit.kept;
    let others = &other.1.best.fit.kept;
    let both: Vec<usize> =
        kept.iter().copied().filter(|row| others.binary_search(row).is_ok()).collect();
    match other.1.nested_rms_mm(&both).zip(answer.1.nested_rms_mm(&both)) {
        Some((with, without)) if with < without => other,
        _ => answer,
    }
}

/// The tolerances of the prior are a guess; corrections that are larger all
/// over say that the arm was made to wider ones (one step towards the maximum of
/// the marginal likelihood).
fn believable_lambda(problem: &Problem, node: &Node) -> f64 {
    // Where nothing but the tolerances holds the scale they keep their weight.
    if scale::is_open(problem, &node.fit.fit.state) {
        return 1.0;
    }
    let norm = problem.corrections(&node.fit.fit.state).norm_squared();
    let count = 5.0 * problem.nominal.len() as f64;
    (count / norm.max(1e-9)).clamp(POLICY.least_lambda, 1.0)
}

/// The model of an answer, fitted under the noise that was found, and what shows how good it is.
fn modelled(
    question: &Question,
    arm: &Arm,
    holdout: Option<&Measurements>,
    (root, weighed): (Node, Weighed),
    (start, not_testable): (State, Vec<String>),
) -> Result<Diagnosis> {
    let added = kept(&weighed);
    // Masses are found by what they bend: of a model without springs they stay.
    let bends = added.iter().any(|candidate| bending::bends(candidate.name()));
    let found = weighed.moments.as_ref().filter(|_| bends).and_then(Moments::robot);
    let robot = found.as_ref().unwrap_or(arm.robot);
    // What is fitted and judged from here on has the noise that was found.
    let heard = question.problem.data.with_noise(weighed.scale);
    let loaded = Conditions::at(&heard, robot, &weighed.best.fit.fit.state.links);
    let rigid = Problem::under(&heard, robot, Scaling::Prior, loaded).about(&start);
    let rigid = Problem { noise: question.problem.noise, ..rigid };
    let root = node::geometry(&Question { problem: &rigid, ..*question }, &root.fit.fit.state)?;
    let tables: Vec<ErrorCurve> = weighed.curves.iter().map(|c| c.table.clone()).collect();
    let mut problem = with_curves(&rigid, &tables);
    problem.scattering.clone_from(&weighed.scattering);
    let question = Question { problem: &problem, ..*question };
    let best = plausible(&question, added, &weighed.best.fit.fit.state)?;
    let show = Show {
        question: &question,
        rigid: &rigid,
        tables: &tables,
        holdout,
        robot,
        unloaded: arm.unloaded,
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
