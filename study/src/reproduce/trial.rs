//! One seed: both cells, all methods, and what can be known of them.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use truearm::MdhParameters;

use super::cell::{COUNTS, Cell, Kind};
use truearm_host::diagnose::{DiagnoseOptions, Verdict, diagnose};
use truearm_host::error::Result;
use truearm_host::evaluate::{Reregister, residuals};
use truearm_host::identify::{Conditions, Problem, Scaling, State};
use truearm_host::methods::{
    Comparison, Frames, GaussNewton, LevenbergMarquardt, Method, NoCalibration, NormalEquations,
    Outcome, PrintedRpim, PseudoInverse, ReducedGaussNewton, Rpim, all, compare,
};
use truearm_host::model::{Measurements, Robot};
use truearm_host::statistics::Stats;
use truearm_simulate::normal;

/// Poses of the sweep: how few are too few?
pub const SWEEP: [usize; 4] = [14, 18, 26, 52];

/// What became of a method in a cell.
#[derive(Debug, Clone, Serialize)]
pub struct Score {
    /// Method.
    pub method: &'static str,
    /// Errors of identification and validation points together, as Table 9.
    pub table: Option<Stats>,
    /// Errors of noise-free points of other poses.
    pub exact: Option<Stats>,
    /// Norm of the corrections, in tolerances.
    pub correction_norm: Option<f64>,
    /// Linearisations.
    pub iterations: usize,
    /// Wall time.
    pub seconds: f64,
    /// Why there is no result.
    pub failure: Option<String>,
}

/// All methods in a cell.
#[derive(Debug, Clone, Serialize)]
pub struct Contest {
    /// Base and tool `fitted` or `held`.
    pub frames: &'static str,
    /// Independent directions of all unknowns.
    pub rank: usize,
    /// Whether MAE falls as the paper has it: NC > LSM > GD > GN > RPIM.
    pub paper_ordering: bool,
    /// One entry a method.
    pub scores: Vec<Score>,
}

/// What `diagnose` says of the cell beyond geometry.
#[derive(Debug, Clone, Serialize)]
pub struct Diagnosis {
    /// Verdict.
    pub verdict: Verdict,
    /// Effects with joints, such as `joint-compliance [2, 3]`.
    pub effects: Vec<String>,
    /// Whether these are the effects that were put in, and no other.
    pub right: bool,
    /// RMS on noise-free poses of the best geometric fit, mm.
    pub geometry_rms_mm: f64,
    /// The same of the model with the effects, mm.
    pub final_rms_mm: f64,
}

/// The sweep over the number of poses: RMS on noise-free poses, mm, from the
/// catalogue's geometry, where redundancy is exact, and from a robot file whose
/// parameters are off by a manufacturing tolerance each, as those of an arm that
/// was calibrated before: there it is only nearly so.
#[derive(Debug, Clone, Serialize)]
pub struct Sweep {
    /// Method.
    pub method: &'static str,
    /// One value an entry of [`SWEEP`]; none where the method broke down.
    pub catalogue_mm: Vec<Option<f64>>,
    /// The same from the other file.
    pub calibrated_before_mm: Vec<Option<f64>>,
    /// From the catalogue, every joint within 20 degrees of one pose, as in the
    /// paper's Table 8; judged on others of that region.
    pub narrow_mm: Vec<Option<f64>>,
}

/// A seed.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// The seed.
    pub seed: u64,
    /// (a): errors that the model represents; base and tool fitted, then held.
    pub geometric: [Contest; 2],
    /// (b): with springs and gears.
    pub beyond: [Contest; 2],
    /// (a): RMS on noise-free poses, mm, and that of the Cramer-Rao bound.
    pub rms_mm: f64,
    /// The bound.
    pub cramer_rao_mm: f64,
    /// (a) with fewer poses.
    pub sweep: Vec<Sweep>,
    /// (b), diagnosed.
    pub diagnosis: Diagnosis,
}

fn contest(cell: &Cell, frames: Frames) -> Result<Contest> {
    let judge = Some((&cell.validation, Reregister::Nothing));
    let found = compare(&cell.arm.robot, &cell.identification, judge, frames, &all())?;
    Ok(contest_of(cell, &found))
}

/// Scores of a comparison on a cell.
#[must_use]
pub fn contest_of(cell: &Cell, found: &Comparison) -> Contest {
    let score = |o: &Outcome| Score {
        method: o.name,
        table: Stats::of([o.residuals.clone(), o.validation_residuals.clone()].concat()),
        exact: o.state.as_ref().and_then(|s| exact(cell, s)),
        correction_norm: o.correction_norm,
        iterations: o.iterations,
        seconds: o.seconds,
        failure: o.failure.clone(),
    };
    let scores: Vec<Score> = found.methods.iter().map(score).collect();
    let mae = |name: &str| {
        let of = scores.iter().find(|s| s.method == name);
        of.and_then(|s| s.table).map_or(f64::NAN, |t| t.mean_mm)
    };
    let claimed = ["NC", "LSM", "GD", "GN", "RPIM"].map(mae);
    let paper_ordering = claimed.windows(2).all(|w| w[0] > w[1]);
    Contest { frames: found.frames, rank: found.rank, paper_ordering, scores }
}

fn exact(cell: &Cell, state: &State) -> Option<Stats> {
    judged(&cell.arm.robot, &cell.exact, state)
}

fn judged(robot: &Robot, data: &Measurements, state: &State) -> Option<Stats> {
    Stats::of(residuals(data, &Conditions::new(data, robot), state))
}

/// RMS on noise-free poses that an efficient unbiased estimate would have, m:
/// Cramer-Rao from the Jacobian at the truth, in the directions that the
/// nominal arm can determine.
#[must_use]
pub fn cramer_rao(cell: &Cell, rank: usize) -> f64 {
    let rows = |data: &Measurements| -> DMatrix<f64> {
        let problem = Problem::new(data, &cell.arm.robot, Scaling::Prior);
        let all: Vec<usize> = (0..data.rows.len()).collect();
        let rows = problem.linearise(&cell.arm.truth).rows(&all, None);
        rows.columns(0, rows.ncols() - 1).into_owned()
    };
    let svd = rows(&cell.identification).svd(false, true);
    let v_t = svd.v_t.unwrap_or_default();
    let check = rows(&cell.exact);
    let term = |k: usize| {
        (&check * v_t.row(k).transpose()).norm_squared() / svd.singular_values[k].powi(2)
    };
    let square: f64 = (0..rank).map(term).sum();
    (square / cell.exact.rows.len() as f64).sqrt() * cell.arm.robot.sigma
}

fn sweep(cell: &Cell, seed: u64) -> Result<Vec<Sweep>> {
    let methods: Vec<Box<dyn Method>> = vec![
        Box::new(NoCalibration),
        Box::new(PseudoInverse),
        Box::new(NormalEquations),
        Box::new(GaussNewton::default()),
        Box::new(ReducedGaussNewton::default()),
        Box::new(LevenbergMarquardt::default()),
        Box::new(PrintedRpim),
        Box::new(Rpim),
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(!seed);
    let mut before = cell.arm.robot.clone();
    for joint in &mut before.joints {
        let off = core::array::from_fn(|_| normal(&mut rng) * 1e-3);
        joint.link = joint.link.corrected(&MdhParameters::from_array(off));
    }
    let run = |robot: &Robot, data: &Measurements, judge: &Measurements| -> Result<_> {
        let mut out = vec![Vec::new(); methods.len()];
        for count in SWEEP {
            let mut data = data.clone();
            data.rows.truncate(count);
            data.poses = count;
            let found = compare(robot, &data, None, Frames::Fitted, &methods)?;
            for (rms, o) in out.iter_mut().zip(&found.methods) {
                let stats = o.state.as_ref().and_then(|s| judged(robot, judge, s));
                rms.push(stats.map(|s| s.rms_mm));
            }
        }
        Ok(out)
    };
    let (wide, exact) = (&cell.identification, &cell.exact);
    let catalogue = run(&cell.arm.robot, wide, exact)?;
    let calibrated_before = run(&before, wide, exact)?;
    let (narrow, exact) = cell.narrow(COUNTS[1], &mut rng)?;
    let narrow = run(&cell.arm.robot, &narrow, &exact)?;
    let sweep = |m: usize| Sweep {
        method: methods[m].name(),
        catalogue_mm: catalogue[m].clone(),
        calibrated_before_mm: calibrated_before[m].clone(),
        narrow_mm: narrow[m].clone(),
    };
    Ok((0..methods.len()).map(sweep).collect())
}

fn diagnosed(cell: &Cell, geometry: &Contest) -> Result<Diagnosis> {
    let robot = &cell.arm.robot;
    let options = DiagnoseOptions::default();
    let found = diagnose(robot, &cell.identification, Some(&cell.validation), &options, &|_| ())?;
    let model = &found.model;
    let state = State {
        bases: model.stations.iter().map(|s| s.1).collect(),
        markers: model.markers.iter().map(|m| m.1).collect(),
        instruments: Vec::new(),
        links: model.links(),
        terms: model.terms.clone(),
    };
    let mut effects: Vec<String> =
        found.outcome.effects.iter().map(|e| format!("{} {:?}", e.name, e.joints)).collect();
    effects.sort();
    effects.dedup();
    let hidden =
        ["gear-transmission-error [1]", "gear-transmission-error [2]", "joint-compliance [2, 3]"];
    let ours = geometry.scores.iter().find(|s| s.method == "RPIM").and_then(|s| s.exact);
    Ok(Diagnosis {
        verdict: found.outcome.verdict,
        right: effects == hidden,
        effects,
        geometry_rms_mm: ours.map_or(f64::NAN, |s| s.rms_mm),
        final_rms_mm: exact(cell, &state).map_or(f64::NAN, |s| s.rms_mm),
    })
}

/// Runs a seed.
///
/// # Errors
/// When a simulated cell cannot be identified at all.
pub fn run(seed: u64) -> Result<Trial> {
    let cell = Cell::draw(seed, Kind::Geometric)?;
    let geometric = [contest(&cell, Frames::Fitted)?, contest(&cell, Frames::Held)?];
    let ours = geometric[0].scores.iter().find(|s| s.method == "RPIM").and_then(|s| s.exact);
    let cramer_rao_mm = cramer_rao(&cell, geometric[0].rank) * 1e3;
    let sweep = sweep(&cell, seed)?;
    let cell = Cell::draw(seed, Kind::Beyond)?;
    let beyond = [contest(&cell, Frames::Fitted)?, contest(&cell, Frames::Held)?];
    let diagnosis = diagnosed(&cell, &beyond[0])?;
    let rms_mm = ours.map_or(f64::NAN, |s| s.rms_mm);
    Ok(Trial { seed, geometric, beyond, rms_mm, cramer_rao_mm, sweep, diagnosis })
}
