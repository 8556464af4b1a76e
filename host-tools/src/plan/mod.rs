//! Which poses to measure.
//!
//! [`Workspace`] says where the arm may go and what the tracker sees; [`plan`]
//! picks the poses there that determine the arm best ([`design`]);
//! [`discriminate`] those that tell two explanations of one data set apart.

pub mod design;
mod discriminate;
mod imagined;
mod observability;

pub use discriminate::{Discrimination, Explained, discriminate};
pub use observability::Observability;

use rand::SeedableRng;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::error::{Error, ErrorKind, Result};
use crate::model::{KindId, Robot, Workspace};
use crate::observations::KINDS;
use design::Design;

/// Starts of the exchange; the best design is kept.
const STARTS: u64 = 3;
/// Poses of the region on which the prediction is judged. They are drawn
/// anew: none of them is a candidate.
const JUDGED: usize = 2000;

/// What the user may choose.
#[derive(Debug, Clone)]
pub struct PlanOptions {
    /// What will be measured at each: points, or poses as well.
    pub kind: KindId,
    /// Poses to measure; with a target, at most.
    pub poses: usize,
    /// Where.
    pub workspace: Workspace,
    /// Candidates drawn from the region.
    pub candidates: usize,
    /// Stop at the fewest poses whose predicted worst tool point is as good as
    /// this: root of the trace of its covariance, 1 sigma, m.
    pub target: Option<f64>,
    /// Other candidates.
    pub seed: u64,
}

/// Poses to measure and what they will tell.
#[derive(Debug, Clone)]
pub struct PosePlan {
    /// Joint values, rad or m, as a file can write them.
    pub poses: Vec<Vec<f64>>,
    /// Name of the kind of measurement.
    pub kind: &'static str,
    /// Parameters that it can determine.
    pub parameters: usize,
    /// Of the scaled Jacobian of the poses.
    pub observability: Observability,
    /// Largest predicted 3-D standard deviation of the tool point over the
    /// region, and its root mean square, m.
    pub worst: f64,
    /// See [`PosePlan::worst`].
    pub rms: f64,
    /// `sigma sqrt(p / n)`: no `n` poses of the region give a smaller worst
    /// case without a prior. Of points only, see [`design`].
    pub bound: Option<f64>,
    /// Median over some draws of as many random poses: their worst case, m.
    pub random_worst: f64,
    /// Whether the target was reached, if there was one.
    pub reached: Option<bool>,
}

/// Plans the poses of an identification by a single marker from one station.
///
/// # Errors
/// A region that the arm cannot reach, or fewer poses than parameters need.
pub fn plan(
    robot: &Robot,
    options: &PlanOptions,
    progress: &dyn Fn(usize, usize),
) -> Result<PosePlan> {
    planned_for(options.kind)?;
    enough_candidates(options)?;
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let candidates = options.workspace.sample(robot, options.candidates, &mut rng)?;
    let judged = options.workspace.sample(robot, JUDGED, &mut rng)?;
    let design = Design::new(robot, &candidates, options.kind);
    let judged = design.tool_points(robot, &judged);
    let mut count = first_count(&design, options, robot.sigma)?;
    let bound = |n: usize| robot.sigma * (design.parameters() as f64 / n as f64).sqrt();
    let of_points = options.kind == KindId::default();
    loop {
        progress(count, options.poses);
        let chosen = best_of_starts(&design, count, options.seed);
        let sigmas = design.sigmas(&chosen, &judged);
        let worst = sigmas.iter().copied().fold(0.0, f64::max);
        let reached = options.target.map(|target| worst <= target);
        if reached == Some(false) && count < options.poses {
            // As the root of n, and never past the target in one leap.
            let wanted = (worst / options.target.unwrap_or(worst)).powi(2) * count as f64;
            count = ((count as f64 + 0.8 * (wanted - count as f64)) as usize)
                .clamp(count + 1, options.poses);
            continue;
        }
        let squares: f64 = sigmas.iter().map(|s| s * s).sum();
        return Ok(PosePlan {
            poses: chosen.iter().map(|k| candidates[*k].clone()).collect(),
            kind: KINDS[usize::from(options.kind.0)].name(),
            parameters: design.parameters(),
            observability: Observability::of(&design.jacobian(&chosen), count),
            worst,
            rms: (squares / sigmas.len() as f64).sqrt(),
            bound: of_points.then(|| bound(count)),
            random_worst: random_worst(&design, &judged, count, options.seed),
            reached,
        });
    }
}

/// Kinds of which a pose alone says what will be measured there: the others need a
/// place that is touched, seen or measured from.
fn planned_for(kind: KindId) -> Result<()> {
    let kind = KINDS[usize::from(kind.0)];
    if ["point", "pose"].contains(&kind.name()) {
        return Ok(());
    }
    Err(Error::usage(
        format!("--kind {}: poses are planned for points and for poses", kind.name()),
        "poses planned for points do for it as well, though they are not the best",
    ))
}

/// Candidates to choose from?
fn enough_candidates(options: &PlanOptions) -> Result<()> {
    if options.candidates >= 2 * options.poses && options.poses > 0 {
        return Ok(());
    }
    Err(Error::data(
        ErrorKind::NoPoses,
        format!("{} poses out of {} candidates", options.poses, options.candidates),
        "ask for at least one pose, and for some thousand candidates",
    ))
}

/// How many poses are tried first: all, or the fewest that may reach the target.
fn first_count(design: &Design, options: &PlanOptions, sigma: f64) -> Result<usize> {
    let least = design.parameters().div_ceil(design.width());
    if options.poses < least {
        return Err(Error::data(
            ErrorKind::TooFewPoses,
            format!(
                "{} poses give {} equations for {} parameters that {}s can determine",
                options.poses,
                design.width() * options.poses,
                design.parameters(),
                KINDS[usize::from(options.kind.0)].name()
            ),
            format!("plan at least {least} poses, better {}", 2 * least),
        ));
    }
    Ok(match options.target {
        // The prior may beat the bound by a little.
        Some(target) => {
            // More than points may need far fewer.
            let of_points = 0.9 * design.parameters() as f64 * (sigma / target).powi(2);
            let fewest = if design.width() == 3 { of_points } else { 0.0 };
            (fewest as usize).clamp(least, options.poses)
        }
        None => options.poses,
    })
}

fn best_of_starts(design: &Design, count: usize, seed: u64) -> Vec<usize> {
    let starts = (0..STARTS).into_par_iter().map(|start| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ (start + 1) << 32);
        design.exchange(some(design.candidates(), count, &mut rng))
    });
    let best = starts.max_by(|a, b| a.1.total_cmp(&b.1));
    best.map(|(chosen, _)| chosen).unwrap_or_default()
}

fn some(of: usize, count: usize, rng: &mut ChaCha8Rng) -> Vec<usize> {
    (0..of).collect::<Vec<_>>().sample(rng, count).copied().collect()
}

fn random_worst(design: &Design, judged: &nalgebra::DMatrix<f64>, count: usize, seed: u64) -> f64 {
    let draws = (0..9).map(|k| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ (k + 101) << 32);
        let sigmas = design.sigmas(&some(design.candidates(), count, &mut rng), judged);
        sigmas.into_iter().fold(0.0, f64::max)
    });
    crate::statistics::median(&draws.collect::<Vec<_>>())
}
