//! Whether an arm is as those of its type, of which robot.toml says how far they are
//! off: a crash takes a parameter or two far beyond, and a prior that would hold these
//! bends all others instead.

use std::borrow::Cow;

use nalgebra::DVector;
use truearm::LinkParameter;

use super::problem::{Problem, Scaling};
use super::start;
use super::{LambdaRule, noise_estimate};
use crate::error::Result;
use crate::identify::fit::estimate::estimate;
use crate::identify::problem::Unknown;
use crate::model::{Joint, Measurements, Robot};
use crate::tikhonov::{Factorised, Normal};

/// Tolerance of a parameter that is not as the type has it, in usual ones.
const WIDE: f64 = 10.0;
/// By how much the deviance must fall for a parameter to be given that: one in a
/// thousand is so (twice its logarithm).
const PRICE: f64 = 13.8;
/// Parameters of one arm that may be: one in so many.
const MOST: usize = 4;

/// Tolerances and expected corrections of all link parameters, in usual tolerances.
#[must_use]
pub fn of_type(robot: &Robot) -> [DVector<f64>; 2] {
    let all: Vec<[f64; 2]> = parameters(robot)
        .map(|(unknown, joint, p)| {
            let usual = unknown.tolerance();
            let tolerance = joint.prior.tolerance[p as usize].unwrap_or(usual);
            [tolerance / usual, joint.prior.expected[p as usize] / usual]
        })
        .collect();
    [0, 1].map(|c| DVector::from_fn(all.len(), |k, _| all[k][c]))
}

fn parameters(robot: &Robot) -> impl Iterator<Item = (Unknown, &Joint, LinkParameter)> {
    robot.joints.iter().enumerate().flat_map(|(i, joint)| {
        LinkParameter::ALL.into_iter().map(move |p| (Unknown::Link(i, p), joint, p))
    })
}

/// The robot as it is, or with wide tolerances and a warning where rows say that this
/// arm is not of its type. Nothing is asked where nothing is known of that.
///
/// # Errors
/// As for [`identify`](super::identify).
pub fn as_measured<'r>(robot: &'r Robot, data: &Measurements) -> Result<Cow<'r, Robot>> {
    if robot.joints.iter().all(|joint| joint.prior.tolerance == [None; 5]) {
        return Ok(Cow::Borrowed(robot));
    }
    let mut plain = robot.clone();
    plain.joints.iter_mut().for_each(|joint| joint.prior.tolerance = [None; 5]);
    let links = links(&plain, data)?;
    let [mut units, _] = of_type(robot);
    let off = DVector::zeros(units.len());
    let deviance = |units: &DVector<f64>| {
        let held = Factorised::of_normal(&links.recounted(units, &off), 0);
        held.maximum_likelihood().map_or(f64::INFINITY, |lambda| held.deviance(lambda))
    };
    let mut found = robot.clone();
    let all: Vec<(Unknown, LinkParameter)> = parameters(robot).map(|(u, _, p)| (u, p)).collect();
    let mut now = deviance(&units);
    for _ in 0..units.len() / MOST {
        let widened = |k: usize| {
            let mut trial = units.clone();
            trial[k] = trial[k].max(WIDE);
            (k, deviance(&trial))
        };
        let best = (0..units.len()).map(widened).min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((k, then)) = best.filter(|(_, then)| *then < now - PRICE) else { break };
        (now, units[k]) = (then, WIDE);
        let (unknown, p) = all[k];
        found.joints[k / 5].prior.tolerance[p as usize] = Some(WIDE * unknown.tolerance());
        found.warnings.push(format!(
            "{}: {} is farther off than arms of the type of {} are: for this one it is left free",
            data.path.display(),
            unknown.name(data),
            robot.path.display()
        ));
    }
    Ok(Cow::Owned(found))
}

/// What rows say of the links alone where nothing is known of the type but the mean.
fn links(robot: &Robot, data: &Measurements) -> Result<Normal> {
    let problem = Problem::rigid(data, robot, Scaling::Prior);
    let start = start::first(&problem, robot.tool)?;
    let mut problem = problem.about(&start);
    let rows = problem.counted();
    problem.noise = noise_estimate::noise(&problem, &rows, &start)?;
    let found = estimate(&problem, LambdaRule::default(), &rows, &start, false)?;
    let triangle = problem.linearise(&found.fit.state).triangle(&found.robust.kept, None);
    Ok(Factorised::new(&triangle, problem.unknowns.free()).penalised())
}
