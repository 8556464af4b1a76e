//! The methods side by side, as in Tables 9 and 10 of the paper.

use std::time::Instant;

use nalgebra::DVector;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Frames, Method, Task};
use crate::error::Result;
use crate::evaluate::{Reregister, residuals, state_on};
use crate::identify::certainty::redundancy;
use crate::identify::fit::robust::{Flags, robust_fit};
use crate::identify::start::registration::register;
use crate::identify::{
    Condition, Conditions, Options, Problem, Scaling, State, enough, link_corrections,
    nominal_state,
};
use crate::model::{Measurements, Model, Robot};
use crate::observations::Residual;
use crate::statistics::Stats;

/// Methods on one data set.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Comparison {
    /// The robot.
    pub robot: String,
    /// The fitted file.
    pub data: String,
    /// The file they are judged on.
    pub validation: Option<String>,
    /// What was fitted on that file.
    pub reregistered: &'static str,
    /// Rows fitted.
    pub rows: usize,
    /// Unknowns of the classical methods.
    pub parameters: usize,
    /// Independent directions of all unknowns.
    pub rank: usize,
    /// Eq. 24 of the paper.
    pub condition_number_raw: Condition,
    /// `fitted` or `held`: base and tool in the classical methods.
    pub frames: &'static str,
    /// Rows left out for all methods as gross errors, counted from 1.
    pub outlier_rows: Vec<usize>,
    /// One entry a method.
    pub methods: Vec<Outcome>,
    /// Remarks.
    pub warnings: Vec<String>,
}

/// A method's result.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Outcome {
    /// Short name.
    pub name: &'static str,
    /// In a line.
    pub about: &'static str,
    /// Why there is no result.
    pub failure: Option<String>,
    /// Linearisations; of the Kalman filter, points.
    pub iterations: usize,
    /// Whether it came to rest.
    pub settled: bool,
    /// Wall time.
    pub seconds: f64,
    /// Regularisation parameter, where there is one.
    pub lambda: Option<f64>,
    /// Norm of the corrections, in tolerances.
    pub correction_norm: Option<f64>,
    /// The largest of them, in tolerances.
    pub largest_correction: Option<f64>,
    /// Longest correction of a length, mm.
    pub longest_correction_mm: Option<f64>,
    /// Errors of the fitted points.
    pub fitted: Option<Stats>,
    /// Errors of the other file's points.
    pub validation: Option<Stats>,
    /// How much of NC's mean error is gone, percent; on the validation file
    /// where there is one.
    pub mae_reduction_percent: Option<f64>,
    /// The same of the standard deviation.
    pub sd_reduction_percent: Option<f64>,
    /// The arm.
    #[serde(skip)]
    pub state: Option<State>,
    /// Measured minus modelled, m: fitted rows.
    #[serde(skip)]
    pub residuals: Vec<Residual>,
    /// The same of the validation file.
    #[serde(skip)]
    pub validation_residuals: Vec<Residual>,
}

/// Runs methods on measurements and judges them on others.
///
/// # Errors
/// As for [`identify`](crate::identify::identify) and
/// [`evaluate`](crate::evaluate::evaluate); a method that breaks down is an
/// entry, no error.
pub fn compare(
    robot: &Robot,
    data: &Measurements,
    judge: Option<(&Measurements, Reregister)>,
    frames: Frames,
    methods: &[Box<dyn Method>],
) -> Result<Comparison> {
    let problem = Problem::new(data, robot, Scaling::Prior);
    enough(&problem, &Options::default())?;
    let first = register(data, &problem.nominal, robot.tool)?;
    let all: Vec<usize> = (0..data.rows.len()).collect();
    let robust = robust_fit(&problem, &all, &first, Flags::default())?;
    let start = nominal_state(&problem, &robust.kept, &first)?;
    let redundancy = redundancy::analyse(&problem, &start, &robust.kept);
    let task = Task::new(&problem, start, &robust.kept, frames);
    let mut outcomes = Vec::new();
    for method in methods {
        let mut outcome = run(method.as_ref(), &task);
        if let Some(state) = &outcome.state {
            let linearised = problem.linearise(state);
            outcome.residuals = robust.kept.iter().map(|r| linearised.residual(*r)).collect();
            outcome.fitted = Stats::of(&outcome.residuals);
            if let Some((other, reregister)) = judge {
                let on = state_on(&model_of(robot, data, state), other, reregister)?;
                let conditions = Conditions::new(other, robot);
                outcome.validation_residuals = residuals(other, &conditions, &on);
                outcome.validation = Stats::of(&outcome.validation_residuals);
            }
        }
        outcomes.push(outcome);
    }
    reductions(&mut outcomes);
    let mut warnings = [robot.warnings.clone(), data.warnings.clone()].concat();
    warnings.extend(judge.iter().flat_map(|(other, _)| other.warnings.clone()));
    Ok(Comparison {
        robot: robot.name.clone(),
        data: data.path.display().to_string(),
        validation: judge.map(|(other, _)| other.path.display().to_string()),
        reregistered: judge.map_or(Reregister::Nothing, |j| j.1).name(),
        rows: robust.kept.len(),
        parameters: task.unknowns().len(),
        rank: redundancy.rank,
        condition_number_raw: redundancy.condition_raw.into(),
        frames: match frames {
            Frames::Fitted => "fitted",
            Frames::Held => "held",
        },
        outlier_rows: robust.outliers.iter().map(|o| o.row + 1).collect(),
        methods: outcomes,
        warnings,
    })
}

impl Comparison {
    /// The method whose mean error is smallest, and those whose mean is not larger by more
    /// than the standard error of a mean over so many rows: these cannot be told apart. With
    /// that standard error, mm.
    #[must_use]
    pub fn best(&self) -> Option<(Vec<&Outcome>, f64)> {
        let judged = |o: &&Outcome| o.judged().is_some();
        let mean = |o: &&Outcome| o.judged().map_or(f64::INFINITY, |s| s.mean_mm);
        let mut all: Vec<&Outcome> = self.methods.iter().filter(judged).collect();
        all.sort_by(|a, b| mean(a).total_cmp(&mean(b)));
        let first = *all.first()?;
        let rows = first.judged_residuals().len().max(1) as f64;
        let error = first.judged()?.sd_mm / rows.sqrt();
        all.retain(|o| mean(o) - mean(&first) <= error);
        Some((all, error))
    }
}

impl Outcome {
    /// What it is judged by: the other file where there is one.
    #[must_use]
    pub fn judged(&self) -> Option<Stats> {
        self.validation.or(self.fitted)
    }

    /// The residuals of that.
    #[must_use]
    pub fn judged_residuals(&self) -> &[Residual] {
        if self.validation.is_some() { &self.validation_residuals } else { &self.residuals }
    }
}

/// A method on a task: result, time, size of the corrections.
fn run(method: &dyn Method, task: &Task) -> Outcome {
    let clock = Instant::now();
    let solved = method.solve(task);
    let seconds = clock.elapsed().as_secs_f64();
    let found = solved.as_ref().ok();
    let corrections = found.map(|f| task.corrections(&f.state));
    Outcome {
        name: method.name(),
        about: method.about(),
        failure: solved.as_ref().err().map(ToString::to_string),
        iterations: found.map_or(0, |f| f.iterations),
        settled: found.is_some_and(|f| f.settled),
        seconds,
        lambda: found.and_then(|f| f.lambda),
        correction_norm: corrections.as_ref().map(DVector::norm),
        largest_correction: corrections.as_ref().map(DVector::amax),
        longest_correction_mm: corrections.as_ref().map(|x| task.longest(x) * 1e3),
        fitted: None,
        validation: None,
        mae_reduction_percent: None,
        sd_reduction_percent: None,
        state: found.map(|f| f.state.clone()),
        residuals: Vec::new(),
        validation_residuals: Vec::new(),
    }
}

/// Table 10: what is gone of the first method's error.
fn reductions(outcomes: &mut [Outcome]) {
    let judged = Outcome::judged;
    let Some(before) = outcomes.first().and_then(judged) else { return };
    for outcome in outcomes.iter_mut().skip(1) {
        let after = judged(outcome);
        let gone = |f: fn(&Stats) -> f64| after.map(|a| 100.0 * (1.0 - f(&a) / f(&before)));
        outcome.mae_reduction_percent = gone(|s| s.mean_mm);
        outcome.sd_reduction_percent = gone(|s| s.sd_mm);
    }
}

/// As much of a model as scoring needs.
fn model_of(robot: &Robot, data: &Measurements, state: &State) -> Model {
    Model {
        corrections: link_corrections(state, &robot.nominal()),
        covered: data.covered().into_iter().map(Some).collect(),
        terms: state.terms.clone(),
        stations: data.stations.iter().cloned().zip(state.bases.iter().copied()).collect(),
        markers: data.markers.iter().cloned().zip(state.markers.iter().copied()).collect(),
        ..Model::nominal(robot.clone())
    }
}
