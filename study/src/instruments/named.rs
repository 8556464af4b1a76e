//! Effects named from what is no point: blind sets of lengths, touches and holes.

use nalgebra::{DMatrix, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::Result;
use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};
use truearm_host::identify::registration::register;
use truearm_host::identify::{Problem, Scaling, State};
use truearm_host::model::{Measurements, Robot};
use truearm_host::observations::measuring;
use truearm_simulate::arm::Arm;
use truearm_simulate::body::{Body, apply};
use truearm_simulate::effects::{Defect, Kind, drawn};
use truearm_simulate::instruments::Cell;
use truearm_simulate::{at_rest, rigid, robots};

use super::cases::Wanted;
use crate::blind::score::of;
use crate::judged::{cell, most_probable, read};
use crate::simulated::{robot, stated};

/// What is measured.
pub const FILES: [(&str, &Wanted); 4] = [
    ("lengths to three feet", &[("distance", 240)]),
    ("touches of three planes", &[("touch", 240)]),
    ("lengths and touches", &[("distance", 120), ("touch", 120)]),
    ("touches of a ball, holes of a plate", &[("sphere", 120), ("plate", 60)]),
];

/// Six and seven joints; the others hardly reach the planes.
const ARMS: [usize; 2] = [0, 4];

/// What may be hidden.
const NAMES: [&str; 6] = [
    "joint-compliance",
    "base-compliance",
    "encoder-eccentricity",
    "gear-transmission-error",
    "joint-gain",
    "joint-coupling",
];

/// Sizes as a share of the largest that nobody would see without a tool, log-uniform.
const SIZES: [f64; 2] = [0.01, 0.5];

/// A file tells an effect that is so many standard deviations of its own bound away
/// from nothing and from any one other effect: 18 nats, where a name costs 4 or 5.
pub const TOLD: f64 = 6.0;

/// A name and its joints.
type Place = (String, Vec<usize>);

/// A set and its answer.
pub struct Answered {
    /// What was measured.
    pub file: &'static str,
    /// What was hidden.
    pub hidden: Option<Place>,
    /// Standard deviations of its bound, the best rival projected off too.
    pub sure: f64,
    /// It is named and nothing else is.
    pub right: bool,
    /// What else is named.
    pub wrong: Vec<Place>,
    /// Suspected, or in an alternative.
    pub mentioned: bool,
    /// The verdict.
    pub verdict: Verdict,
}

/// Draws a set, has it diagnosed, and opens it. Every sixth hides nothing.
///
/// # Errors
/// As of `diagnose`.
pub fn answered(seed: u64) -> Result<Answered> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (file, wanted) = FILES[seed as usize % FILES.len()];
    let robot = robot(robots::ALL[ARMS[(seed as usize / FILES.len()) % ARMS.len()]]);
    let mut cell = cell(&robot, &mut rng);
    let arm = heavy(&robot, &cell);
    let hidden = (!rng.random_ratio(1, 6)).then(|| defect(&robot, &arm.body, &cell, &mut rng));
    cell.bent = hidden.clone().map(|defect| Arm { defects: vec![defect], ..arm.clone() });
    let data = read(&robot, &cell, &cell.file(wanted, &mut rng));
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ())?.outcome;
    let place = hidden.as_ref().map(place);
    let named = of(&found.effects);
    let wrong: Vec<Place> = named.iter().filter(|p| Some(*p) != place.as_ref()).cloned().collect();
    let right = wrong.is_empty() && place.as_ref().is_none_or(|p| named.contains(p));
    let sure = match &hidden {
        Some(defect) => sure(&robot, &data, &arm, defect)?,
        None => f64::INFINITY,
    };
    let mentioned = place.as_ref().is_some_and(|p| mentioned(&found, p));
    Ok(Answered { file, hidden: place, sure, right, wrong, mentioned, verdict: found.verdict })
}

fn place(defect: &Defect) -> Place {
    (defect.kind.name().to_owned(), defect.kind.joints())
}

fn mentioned(found: &Outcome, place: &Place) -> bool {
    let mut all = found.alternatives.iter().flat_map(|a| &a.effects);
    all.any(|(name, joints)| *name == place.0 && *joints == place.1)
        || of(&found.suspected).contains(place)
}

/// The cell's arm with weight.
fn heavy(robot: &Robot, cell: &Cell) -> Arm {
    let body = Body {
        kinds: cell.kinds.clone(),
        links: cell.links.clone(),
        gear_ratios: robot.joints.iter().map(|j| j.gear_ratio.unwrap_or(100.0)).collect(),
        masses: robot.links.iter().map(|l| (l.mass, l.com)).collect(),
        gravity: robot.gravity.unwrap_or_default(),
        station: rigid(&Vector3::zeros(), &Vector3::zeros()),
        tool: cell.tool,
    };
    Arm { body, defects: Vec::new() }
}

fn defect(robot: &Robot, body: &Body, cell: &Cell, rng: &mut ChaCha8Rng) -> Defect {
    let poses: Vec<_> = (0..50).map(|_| at_rest(&cell.pose(rng))).collect();
    let name = NAMES[rng.random_range(0..NAMES.len())];
    let kind = drawn(name, &stated(robot), body, &poses, rng);
    let share = SIZES[0] * (SIZES[1] / SIZES[0]).powf(rng.random_range(0.0..1.0));
    Defect { size: kind.largest() * share, kind }
}

/// How far an effect is from nothing and from its best rival, in standard deviations
/// of what the rows leave open of geometry, instruments and that rival.
fn sure(robot: &Robot, data: &Measurements, arm: &Arm, hidden: &Defect) -> Result<f64> {
    let problem = Problem::new(data, robot, Scaling::Prior);
    let start = register(data, &problem.nominal, robot.tool)?;
    let problem = problem.about(&start);
    let state = most_probable(&problem, robot)?.fit.state;
    let (geometry, own) = columns(&problem, &state, arm, std::slice::from_ref(hidden));
    let left = rest(&geometry, &own);
    let own_rivals =
        rivals(arm).into_iter().filter(|g| g.iter().all(|d| place(d) != place(hidden)));
    let beside = own_rivals.map(|group| {
        let theirs = rest(&geometry, &columns(&problem, &state, arm, &group).1);
        match theirs.clone().svd(true, true).solve(&left, 1e-9) {
            Ok(fitted) => (&left - theirs * fitted).norm(),
            Err(_) => left.norm(),
        }
    });
    Ok(beside.fold(left.norm(), f64::min))
}

/// What geometry and its tolerances leave of columns.
fn rest(geometry: &DMatrix<f64>, columns: &DMatrix<f64>) -> DMatrix<f64> {
    let mut all = columns.clone().resize_vertically(geometry.nrows(), 0.0);
    let mut h = geometry.tr_mul(geometry);
    (0..h.nrows()).for_each(|k| h[(k, k)] += 1e-9 * h[(k, k)].max(1.0));
    if let Some(factor) = h.cholesky() {
        let fitted = factor.solve(&geometry.tr_mul(&all));
        all -= geometry * fitted;
    }
    all
}

/// Equations of geometry and instruments with rows of the tolerances below, and how
/// each of some effects moves what was measured, all in standard deviations.
fn columns(
    problem: &Problem,
    state: &State,
    arm: &Arm,
    defects: &[Defect],
) -> (DMatrix<f64>, DMatrix<f64>) {
    let with = |defect: &Defect| Arm { defects: vec![defect.clone()], ..arm.clone() };
    let arms: Vec<Arm> = defects.iter().map(with).collect();
    let data = problem.data;
    let moved = |index: usize| {
        let moment = at_rest(&data.rows[index].q);
        let target = |arm: &Arm| apply(&arm.last_frame(&moment), &arm.tool);
        let rigid = target(arm);
        arms.iter().map(|a| target(a) - rigid).collect::<Vec<Vector3<f64>>>()
    };
    let (at, rows) = (problem.linearise(state), measuring(&data.rows));
    let (free, unknowns) = (problem.unknowns.free(), problem.unknowns.list().len());
    let count = problem.equations(&rows);
    let mut geometry = DMatrix::zeros(count + unknowns - free, unknowns);
    let mut own = DMatrix::zeros(count, defects.len());
    let mut first = 0;
    for row in rows {
        let block = at.equations_beside(row, &|i, _| moved(i)).block;
        let height = block.nrows();
        let [links, beside] = [(0, unknowns), (unknowns, defects.len())];
        geometry
            .view_mut((first, 0), (height, unknowns))
            .copy_from(&block.columns(links.0, links.1));
        own.rows_mut(first, height).copy_from(&block.columns(beside.0, beside.1));
        first += height;
    }
    (free..unknowns).for_each(|k| geometry[(count + k - free, k)] = 1.0);
    (geometry, own)
}

/// What else could be there, each with every phase it may have.
fn rivals(arm: &Arm) -> Vec<Vec<Defect>> {
    let of = |kind: Kind| Defect { size: 0.1 * kind.largest(), kind };
    let joints = || 0..arm.kinds.len();
    let mut out = vec![vec![of(Kind::BaseCompliance { ratio: 1.0 })]];
    for joint in joints() {
        let phases = [0.0, std::f64::consts::FRAC_PI_2];
        out.push(phases.map(|phase| of(Kind::EncoderEccentricity { joint, phase })).to_vec());
        out.push(vec![of(Kind::JointGain { joint })]);
        out.push(vec![of(Kind::JointCompliance { joint })]);
        let sources = joints().filter(|source| *source != joint);
        out.extend(sources.map(|source| vec![of(Kind::JointCoupling { source, joint })]));
    }
    out
}
