//! Rules for lambda against the lambda that would have been best, on arms whose
//! truth is known. How large the geometric errors are is drawn too, so that no
//! rule is told.

use nalgebra::Vector3;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;
use truearm_host::identify::fit::folds;
use truearm_host::identify::fit::{Freedom, fit};
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{LambdaRule, Problem, Scaling, choose, nominal_state};
use truearm_host::model::{Joint, Measurements, Robot};
use truearm_host::tikhonov::Factorised;
use truearm_simulate::robots;

use crate::simulated::{Truth, csv_of, normal, parse, rms, robot};

/// What is hard about a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// Hardly more equations than unknowns.
    Few,
    /// 100 to 200 poses.
    Many,
    /// Poses of a small region, judged on the whole range.
    IllPlaced,
    /// The stated sigma is a fifth to a half of the true one, or two to five times.
    WrongSigma,
}

impl Class {
    pub const ALL: [Self; 4] = [Self::Few, Self::Many, Self::IllPlaced, Self::WrongSigma];

    pub fn name(self) -> &'static str {
        match self {
            Self::Few => "few poses",
            Self::Many => "many poses",
            Self::IllPlaced => "ill-placed poses",
            Self::WrongSigma => "wrong sigma",
        }
    }
}

/// A problem and how much worse than the best lambda each rule did on it.
#[derive(Debug, Clone)]
pub struct Regrets {
    pub class: Class,
    /// RMS on noise-free poses over that of the oracle lambda, minus 1; in the
    /// order of [`LambdaRule::ALL`].
    pub regret: Vec<f64>,
    /// The same of plain least squares, shortest answer.
    pub plain: f64,
}

fn between(low: f64, high: f64, rng: &mut ChaCha8Rng) -> f64 {
    (low.ln() + rng.random_range(0.0..1.0) * (high / low).ln()).exp()
}

/// Joint values within `share` of the range about a centre.
fn poses(robot: &Robot, count: usize, share: f64, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let ranges: Vec<[f64; 2]> = robot
        .joints
        .iter()
        .map(|joint: &Joint| {
            let [low, high] = joint.limits.unwrap_or([-2.5, 2.5]);
            let width = (high - low) * share;
            let from = low + rng.random_range(0.0..=1.0) * (high - low - width);
            [from, from + width]
        })
        .collect();
    let pose = |rng: &mut ChaCha8Rng| {
        let value = |(joint, [low, high]): (&Joint, &[f64; 2]), rng: &mut ChaCha8Rng| {
            let q = rng.random_range(*low..=*high);
            match joint.link.kind {
                JointKind::Revolute => ((q.to_degrees() * 1e4).round() / 1e4).to_radians(),
                JointKind::Prismatic => (q * 1e7).round() / 1e7,
            }
        };
        robot.joints.iter().zip(&ranges).map(|p| value(p, rng)).collect()
    };
    (0..count).map(|_| pose(rng)).collect()
}

fn seen(truth: &Truth, poses: &[Vec<f64>], sigma: f64, rng: &mut impl Rng) -> Measurements {
    let points: Vec<Vector3<f64>> = poses
        .iter()
        .map(|q| truth.point(q, 0, 0) + Vector3::from_fn(|_, _| normal(rng)) * sigma)
        .collect();
    parse(&truth.robot, &csv_of(&truth.robot, poses, &points))
}

/// Draws a problem and judges all rules on it. The lambdas are compared within
/// one linearisation, that of the converged maximum a posteriori estimate.
pub fn judge(seed: u64, class: Class) -> Regrets {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut robot = robot(robots::ALL[rng.random_range(0..robots::ALL.len())]);
    let sigma = between(1e-5, 1e-4, &mut rng);
    let wrong = match class {
        Class::WrongSigma if rng.random_bool(0.5) => between(2.0, 5.0, &mut rng),
        Class::WrongSigma => between(0.2, 0.5, &mut rng),
        _ => 1.0,
    };
    robot.sigma = sigma * wrong;
    let tolerances = between(1.0 / 3.0, 3.0, &mut rng);
    let unknowns = 9 + 5 * robot.joints.len();
    let (count, share) = match class {
        Class::Few => (unknowns.div_ceil(3) + rng.random_range(1..=6), 1.0),
        Class::Many => (rng.random_range(100..=200), 1.0),
        Class::IllPlaced => (rng.random_range(30..=60), rng.random_range(0.05..0.2)),
        Class::WrongSigma => (rng.random_range(30..=60), 1.0),
    };
    let truth = Truth::draw_sized(&robot, 1, 1, tolerances, &mut rng);
    let fitted = poses(&robot, count, share, &mut rng);
    let judged = poses(&robot, 250, 1.0, &mut rng);
    let data = seen(&truth, &fitted, sigma, &mut rng);
    let check = seen(&truth, &judged, 0.0, &mut rng);

    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let first = register(&data, &problem.nominal, robot.tool).unwrap();
    let start = nominal_state(&problem, &rows, &first).unwrap();
    let state = fit(&problem, &rows, None, &start, Freedom::All(1.0)).unwrap().state;
    let at = problem.linearise(&state);
    let factorised = Factorised::new(&at.triangle(&rows, None), problem.unknowns.free());
    let error = |lambda: f64| {
        let step = at.to_si(&(factorised.solve(lambda) - at.corrections()));
        rms(&robot, &state.stepped(&problem.unknowns, &step), &check)
    };
    let grid = (-32..=32).map(|k| 10_f64.powf(f64::from(k) / 8.0));
    let oracle = grid.map(error).fold(f64::INFINITY, f64::min);
    let choice = choose(&problem, &state, &rows, &folds::random(&data, &rows, folds::SEED));
    let regret = |lambda: f64| error(lambda) / oracle - 1.0;
    Regrets {
        class,
        regret: LambdaRule::ALL.iter().map(|rule| regret(choice.by(*rule))).collect(),
        plain: regret(0.0),
    }
}

/// Median, worst decile and worst of some values.
pub fn spread(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
    [at(0.5), at(0.9), at(1.0)]
}
