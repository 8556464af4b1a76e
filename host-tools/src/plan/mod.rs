//! Which poses to measure.
//!
//! [`Workspace`] says where the arm may go and what the tracker sees, [`kinds`] what there
//! is to measure on; [`plan`] picks the poses there that determine the arm best
//! ([`design`]); [`discriminate()`] those that tell two explanations of one data set apart.

pub mod cell;
mod count;
pub mod design;
mod discriminate;
mod exchange;
mod imagined;
pub mod kinds;
mod leading;
mod observability;
mod undetermined;

pub use discriminate::{Discrimination, Explained, discriminate};
pub use imagined::Imagined;
pub use kinds::{Candidate, plural};
pub use observability::Observability;

use rand::SeedableRng;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::error::{Error, ErrorKind, Result};
use crate::files::Gathered;
use crate::model::{KindId, PlannedRow, Robot, Workspace};
use crate::observations::KINDS;
use cell::Cell;
use design::{Aim, Design, Region};

/// Starts of the exchange; the best design is kept.
const STARTS: u64 = 3;
/// Poses of the region on which the prediction is judged. They are drawn
/// anew: none of them is a candidate.
const JUDGED: usize = 2000;

/// What the user may choose.
#[derive(Debug, Clone)]
pub struct PlanOptions {
    /// What will be measured at each.
    pub kind: KindId,
    /// What is stated of what is measured on and with; points and poses need nothing.
    pub instruments: Gathered,
    /// Measurements to make; with a target, at most. A pair is one of two poses, an image
    /// one of many corners.
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
    /// Joint values, rad or m: as a file can write them where points and poses are
    /// measured, else exactly where something is touched.
    pub poses: Vec<Vec<f64>>,
    /// What is to be measured there: the rows of each measurement.
    pub measurements: Vec<Candidate>,
    /// Name of the kind of measurement.
    pub kind: &'static str,
    /// What the standard deviations are of, in words: the tool point, or the place of what
    /// measures where the kind says nothing of a tool.
    pub what: &'static str,
    /// Parameters that these measurements determine, those of instruments included.
    pub parameters: usize,
    /// Of the scaled Jacobian of the poses.
    pub observability: Observability,
    /// Largest predicted 3-D standard deviation of the tool point over the
    /// region, and its root mean square, m.
    pub worst: f64,
    /// See [`PosePlan::worst`].
    pub rms: f64,
    /// `sigma sqrt(p / n)`: no `n` poses of the region give a smaller worst
    /// case without a prior. Of points only, see [`design`]; none where the prior alone
    /// makes the worst case smaller.
    pub bound: Option<f64>,
    /// Median over some draws of as many random poses: their worst case, m.
    pub random_worst: f64,
    /// The same three of what the kind determines at all, where something stays open that
    /// only the tolerances hold.
    pub determined: Option<Determined>,
    /// What no measurement of this kind tells, in words.
    pub undetermined: Vec<String>,
    /// Whether the target was reached, if there was one.
    pub reached: Option<bool>,
    /// Remarks for the user.
    pub warnings: Vec<String>,
}

/// Standard deviations but for what no measurement of a kind tells, m; as of
/// [`PosePlan`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Determined {
    /// Largest over the region.
    pub worst: f64,
    /// Root mean square.
    pub rms: f64,
    /// Largest of as many random measurements.
    pub random_worst: f64,
}

/// Called with the number of measurements that are tried, and which sweep over them it is; by
/// several threads.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// What stays open counts from this share of the largest standard deviation.
const COUNTS: f64 = 0.01;

/// Plans the poses of an identification by a single marker from one station.
///
/// # Errors
/// A region that the arm cannot reach, fewer poses than parameters need, a kind that needs
/// places which nothing is stated of, or places that no pose leads to.
pub fn plan(robot: &Robot, options: &PlanOptions, progress: Progress) -> Result<PosePlan> {
    enough_candidates(options)?;
    sensible_target(options)?;
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let (candidates, warnings) = candidates(robot, options, &mut rng)?;
    if kinds::poses(&candidates).len() < 2 {
        return Err(Error::data(
            ErrorKind::NoPoses,
            "the joint limits leave a single pose",
            "`truearm identify` needs different ones: widen --limits",
        ));
    }
    let judged = options.workspace.sample(robot, JUDGED, &mut rng)?;
    let imagined = Imagined::new(robot, &candidates, options.kind, &options.instruments)?;
    let problem = imagined.problem(robot);
    let design = Design::new(&imagined, &problem, robot.sigma);
    let motions = imagined.motions(robot, &problem, &judged);
    let region = design.region(&motions.moved);
    let first = count::first(&design, (&imagined, &problem), options, robot.sigma)?;
    let (chosen, reached) = chosen(&design, &region, options, (first, progress));
    let [told, all] = judged_by(&design.sigmas(&chosen, &region));
    let [random_told, random_worst] = random_worst(&design, &region, chosen.len(), options.seed);
    let open = region.open.iter().copied().fold(0.0, f64::max).sqrt();
    let determined = Determined { worst: told.0, rms: told.1, random_worst: random_told };
    let is_open = open > COUNTS * all.0;
    let measurements: Vec<Candidate> = chosen.iter().map(|k| candidates[*k].clone()).collect();
    let undetermined = undetermined::words(robot, options, &measurements, is_open)?;
    let (observability, parameters) = Observability::of(&design.jacobian(&chosen), chosen.len());
    let bound = robot.sigma * (design.parameters() as f64 / chosen.len() as f64).sqrt();
    Ok(PosePlan {
        poses: kinds::poses(&measurements),
        kind: name(options.kind),
        what: motions.what,
        parameters,
        observability,
        worst: all.0,
        rms: all.1,
        // Where tolerances hold the tool better than measurements could, it is none.
        bound: (options.kind == KindId::default() && bound <= all.0).then_some(bound),
        random_worst,
        determined: is_open.then_some(determined),
        undetermined,
        reached,
        warnings,
        measurements,
    })
}

fn name(kind: KindId) -> &'static str {
    KINDS[usize::from(kind.0)].name()
}

/// Measurements to choose from, and what is out of reach.
fn candidates(
    robot: &Robot,
    options: &PlanOptions,
    rng: &mut ChaCha8Rng,
) -> Result<(Vec<Candidate>, Vec<String>)> {
    if ["point", "pose"].contains(&name(options.kind)) {
        let poses = options.workspace.sample(robot, options.candidates, rng)?;
        let alone = |q| vec![PlannedRow { q, labels: Vec::new() }];
        return Ok((poses.into_iter().map(alone).collect(), Vec::new()));
    }
    let cell = Cell::new(robot, &options.workspace, &options.instruments);
    let kind = name(options.kind);
    let (found, closed) = kinds::candidates(kind, &cell, options.candidates, options.seed)?;
    if found.len() < options.poses.saturating_mul(2) {
        return Err(Error::data(
            ErrorKind::NoPoses,
            format!("only {} of {} draws lead to a {kind}", found.len(), options.candidates),
            "widen --limits or --box, or allow more --candidates",
        ));
    }
    let warning =
        (!closed.is_empty()).then(|| format!("out of reach: {}", crate::error::listed(&closed)));
    Ok((found, warning.into_iter().collect()))
}

/// The measurements that are best, as many as are asked for or as the target needs, and
/// whether that is reached.
fn chosen(
    design: &Design,
    region: &Region,
    options: &PlanOptions,
    (first, progress): (usize, Progress),
) -> (Vec<usize>, Option<bool>) {
    let mut count = first;
    let aim = match name(options.kind) {
        "point" | "pose" => Aim::Determinant,
        _ => region.variance(),
    };
    loop {
        let chosen = best_of_starts(design, &aim, (count, options.seed), progress);
        let [_, (worst, _)] = judged_by(&design.sigmas(&chosen, region));
        let reached = options.target.map(|target| worst <= target);
        if reached == Some(false) && count < options.poses {
            // As the root of n, and never past the target in one leap.
            let wanted = (worst / options.target.unwrap_or(worst)).powi(2) * count as f64;
            count = ((count as f64 + 0.8 * (wanted - count as f64)) as usize)
                .clamp(count + 1, options.poses);
            continue;
        }
        return (chosen, reached);
    }
}

/// Largest and root mean square, of what is determined and of all.
fn judged_by(sigmas: &[[f64; 2]]) -> [(f64, f64); 2] {
    [0, 1].map(|k| {
        let squares: f64 = sigmas.iter().map(|s| s[k] * s[k]).sum();
        let largest = sigmas.iter().map(|s| s[k]).fold(0.0, f64::max);
        (largest, (squares / sigmas.len() as f64).sqrt())
    })
}

/// A standard deviation that can be reached?
fn sensible_target(options: &PlanOptions) -> Result<()> {
    match options.target.filter(|target| !(*target > 0.0 && target.is_finite())) {
        None => Ok(()),
        Some(target) => Err(Error::usage(
            format!("a target of {} um", target * 1e6),
            "give a positive standard deviation in micrometres, such as 20",
        )),
    }
}

/// Candidates to choose from?
fn enough_candidates(options: &PlanOptions) -> Result<()> {
    if options.candidates >= options.poses.saturating_mul(2) && options.poses > 0 {
        return Ok(());
    }
    Err(Error::data(
        ErrorKind::NoPoses,
        format!("{} poses out of {} candidates", options.poses, options.candidates),
        "ask for at least one pose, and for some thousand candidates",
    ))
}

fn best_of_starts(
    design: &Design,
    aim: &Aim,
    (count, seed): (usize, u64),
    progress: Progress,
) -> Vec<usize> {
    let starts = (0..STARTS).into_par_iter().map(|start| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ (start + 1) << 32);
        let some = some(design.candidates(), count, &mut rng);
        design.exchange(some, aim, &|sweep| progress(count, sweep))
    });
    let best = starts.max_by(|a, b| a.1.total_cmp(&b.1));
    best.map(|(chosen, _)| chosen).unwrap_or_default()
}

fn some(of: usize, count: usize, rng: &mut ChaCha8Rng) -> Vec<usize> {
    (0..of).collect::<Vec<_>>().sample(rng, count).copied().collect()
}

/// Of what is determined and of all.
fn random_worst(design: &Design, region: &Region, count: usize, seed: u64) -> [f64; 2] {
    let draws = (0..9).map(|k| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ (k + 101) << 32);
        judged_by(&design.sigmas(&some(design.candidates(), count, &mut rng), region))
    });
    let draws: Vec<_> = draws.collect();
    [0, 1].map(|k| {
        let worst: Vec<f64> = draws.iter().map(|both| both[k].0).collect();
        crate::statistics::median(&worst)
    })
}
