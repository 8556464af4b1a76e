//! Effects named from what is no point: blind sets of every other kind.

use nalgebra::{DMatrix, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::Result;
use truearm_host::diagnose::{DiagnoseOptions, Outcome, Verdict, diagnose};
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Predictor, Problem, Scaling, State, View};
use truearm_host::model::{Measurements, Robot};
use truearm_host::observations::{KINDS, Residual, measuring};
use truearm_simulate::arm::Arm;
use truearm_simulate::body::Body;
use truearm_simulate::effects::{Defect, DefectKind, drawn};
use truearm_simulate::instruments::Cell;
use truearm_simulate::{at_rest, rigid, robots};

use super::bent::Bent;
use super::cases::Wanted;
use crate::apart::{apart, runs};
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

/// The same of what hangs on how the last frame is turned, or on two postures.
pub const TURNING: [(&str, &Wanted); 5] = [
    ("distances between two poses", &[("pair", 240)]),
    ("full poses", &[("pose", 60)]),
    ("inclinations, lengths to three feet", &[("inclination", 120), ("distance", 120)]),
    ("ranges to three planes", &[("range", 240)]),
    ("images of a board", &[("pixel", 30)]),
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

/// A name and its joints.
type Place = (String, Vec<usize>);

/// A hidden effect and what became of it.
pub struct Truth {
    /// Its name and joints.
    pub place: Place,
    /// Standard deviations of its bound, the best rival projected off too.
    pub sure: f64,
    /// It is named.
    pub named: bool,
    /// Suspected, or in an alternative.
    pub mentioned: bool,
}

/// A set and its answer.
pub struct Answered {
    /// What was measured.
    pub file: &'static str,
    /// What was hidden: nothing, one effect or two.
    pub hidden: Vec<Truth>,
    /// What else is named.
    pub wrong: Vec<Place>,
    /// The verdict.
    pub verdict: Verdict,
}

/// Draws a set, has it diagnosed, and opens it. The sigma of each kind is stated
/// wrongly, by up to a factor of `misstated` either way.
///
/// # Errors
/// As of `diagnose`.
pub fn answered(
    seed: u64,
    misstated: f64,
    files: &[(&'static str, &'static Wanted)],
) -> Result<Answered> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (file, wanted) = files[seed as usize % files.len()];
    let text = robots::ALL[ARMS[(seed as usize / files.len()) % ARMS.len()]];
    let robot = robot(&format!("gravity_m_s2 = [0.0, 0.0, -9.81]\n{text}"));
    let mut cell = cell(&robot, &mut rng);
    let arm = heavy(&robot, &cell);
    let mut hidden: Vec<Defect> = Vec::new();
    for _ in 0..[0, 1, 1, 1, 2, 2][rng.random_range(0..6)] {
        let next = defect(&robot, &arm.body, &cell, &mut rng);
        if hidden.iter().all(|d| place(d) != place(&next)) {
            hidden.push(next);
        }
    }
    cell.bent = (!hidden.is_empty()).then(|| Arm { defects: hidden.clone(), ..arm.clone() });
    let data = read(&robot, &cell, &cell.file(wanted, &mut rng));
    let mut stated = data.clone();
    let mut wrong = || misstated.powf(rng.random_range(-1.0..1.0));
    let factors: Vec<f64> = KINDS.iter().map(|_| wrong()).collect();
    for row in &mut stated.rows {
        let factor = factors[usize::from(row.kind.0)];
        row.sigma *= factor;
        row.sigma_angle *= factor;
        row.sigma_px *= factor;
    }
    let found = diagnose(&robot, &stated, None, &DiagnoseOptions::default(), &|_| ())?.outcome;
    let named = of(&found.effects);
    let places: Vec<Place> = hidden.iter().map(place).collect();
    let truth = |k: usize| {
        Ok(Truth {
            place: places[k].clone(),
            sure: sure(&robot, &data, &arm, &hidden, k)?,
            named: named.contains(&places[k]),
            mentioned: mentioned(&found, &places[k]),
        })
    };
    Ok(Answered {
        file,
        hidden: (0..hidden.len()).map(truth).collect::<Result<_>>()?,
        wrong: named.iter().filter(|p| !places.contains(p)).cloned().collect(),
        verdict: found.verdict,
    })
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
/// of what the rows leave open of geometry, instruments, other effects and that rival.
fn sure(
    robot: &Robot,
    data: &Measurements,
    arm: &Arm,
    hidden: &[Defect],
    which: usize,
) -> Result<f64> {
    let problem = Problem::new(data, robot, Scaling::Prior);
    let start = register(data, &problem.nominal, robot.tool)?;
    let problem = problem.about(&start);
    let state = most_probable(&problem, robot)?.fit.state;
    let known = |d: &Defect| hidden.iter().any(|h| place(d) == place(h));
    let rivals: Vec<_> = rivals(arm).into_iter().filter(|group| !group.iter().any(known)).collect();
    let all: Vec<Defect> = hidden.iter().chain(rivals.iter().flatten()).cloned().collect();
    let (geometry, effects) = columns(&problem, &state, arm, &all);
    let first = geometry.ncols();
    let mut both = geometry.resize_horizontally(first + all.len(), 0.0);
    both.view_mut((0, first), effects.shape()).copy_from(&effects);
    let beside: Vec<usize> = (0..first + hidden.len()).filter(|k| *k != first + which).collect();
    let ranges = runs(first + hidden.len(), rivals.iter().map(Vec::len));
    Ok(apart(&both.tr_mul(&both), first + which, &beside, &ranges).least())
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
    let predictor = Predictor::new(state);
    let view = View { model: &predictor, data: problem.data, conditions: &problem.conditions };
    let bent: Vec<Bent> = arms.iter().map(|bent| Bent { view: &view, state, arm, bent }).collect();
    let data = problem.data;
    let (at, rows) = (problem.linearise(state), measuring(&data.rows));
    let (free, unknowns) = (problem.unknowns.free(), problem.unknowns.list().len());
    let count = problem.equations(&rows);
    let mut geometry = DMatrix::zeros(count + unknowns - free, unknowns);
    let mut own = DMatrix::zeros(count, defects.len());
    let mut first = 0;
    for row in rows {
        let e = at.equations(row);
        let height = e.block.nrows();
        geometry.view_mut((first, 0), (height, unknowns)).copy_from(&e.block);
        for (k, bent) in bent.iter().enumerate() {
            let moved = e.scaled(&(e.residual - Residual::of(row, bent)));
            own.view_mut((first, k), (height, 1)).copy_from(&moved.column());
        }
        first += height;
    }
    (free..unknowns).for_each(|k| geometry[(count + k - free, k)] = 1.0);
    (geometry, own)
}

/// What else could be there, each with every phase it may have.
fn rivals(arm: &Arm) -> Vec<Vec<Defect>> {
    let of = |kind: DefectKind| Defect { size: 0.1 * kind.largest(), kind };
    let joints = || 0..arm.kinds.len();
    let mut out = vec![vec![of(DefectKind::BaseCompliance { ratio: 1.0 })]];
    for joint in joints() {
        let phases = [0.0, std::f64::consts::FRAC_PI_2];
        out.push(phases.map(|phase| of(DefectKind::EncoderEccentricity { joint, phase })).to_vec());
        out.push(vec![of(DefectKind::JointGain { joint })]);
        out.push(vec![of(DefectKind::JointCompliance { joint })]);
        let sources = joints().filter(|source| *source != joint);
        out.extend(sources.map(|source| vec![of(DefectKind::JointCoupling { source, joint })]));
    }
    out
}
