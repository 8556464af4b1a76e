//! One identification of a simulated arm, and which of its 95 % intervals hold
//! the truth.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use truearm_host::identify::certainty::error_bars::FACTOR;
use truearm_host::identify::certainty::unknowns::{Covariances, spread};
use truearm_host::identify::fit::estimate::estimate;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{LambdaRule, Problem, Scaling};
use truearm_host::model::Measurements;

use crate::simulated::{Truth, UR10_LIKE, parse, robot};

/// Poses at which the prediction is judged, none of them fitted.
const JUDGED: usize = 10;
/// A parameter known better than this share of its tolerance is determined by
/// the data.
pub const DETERMINED: f64 = 0.3;

/// How readings are noisy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Noise {
    /// Each by itself, as stated.
    Normal,
    /// So many of each pose, which have this share of the variance in common: that of where the
    /// arm stood.
    Common(usize, f64),
    /// Student's t of three degrees of freedom, which is as wide as stated and has tails.
    Tails,
}

/// What stays the same over the simulations of a case.
pub struct Cell {
    noise: Noise,
    poses: usize,
    sigma: f64,
    rule: LambdaRule,
    tolerances: f64,
    arm: Truth,
}

impl Cell {
    /// So many poses, measured with this sigma, m; arms made to the tolerances, and the
    /// rule that takes their word.
    pub fn new(poses: usize, sigma: f64, seed: u64) -> Self {
        Self::made(1.0, LambdaRule::MaximumAPosteriori, (poses, sigma), seed)
    }

    /// The same of arms made to so many tolerances, identified by a rule.
    pub fn made(
        tolerances: f64,
        rule: LambdaRule,
        (poses, sigma): (usize, f64),
        seed: u64,
    ) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut robot = robot(UR10_LIKE);
        robot.sigma = sigma;
        let arm = Truth::draw_sized(&robot, 1, 1, tolerances, &mut rng);
        Self { noise: Noise::Normal, poses, sigma, rule, tolerances, arm }
    }
}

impl Cell {
    /// The same with such noise.
    #[must_use]
    pub fn noisy(self, noise: Noise) -> Self {
        Self { noise, ..self }
    }

    /// What is measured of an arm.
    fn measured(&self, truth: &Truth, rng: &mut ChaCha8Rng) -> Measurements {
        let robot = &self.arm.robot;
        let (readings, share) = match self.noise {
            Noise::Normal => return parse(robot, &truth.measure(self.poses, self.sigma, rng)),
            Noise::Common(readings, share) => (readings, share),
            Noise::Tails => (1, 0.0),
        };
        let mut data = parse(robot, &truth.measure(self.poses, 0.0, rng));
        let mut normal = || StandardNormal.sample(rng);
        let mut deviate = || -> f64 {
            let one: f64 = normal();
            let square: f64 = (0..3).map(|_| normal()).map(|z: f64| z * z).sum();
            if self.noise == Noise::Tails { one / (square / 3.0).sqrt() } else { one }
        };
        let mut rows = Vec::new();
        for row in &data.rows {
            let together: [f64; 3] = std::array::from_fn(|_| share.sqrt() * deviate());
            for _ in 0..readings {
                let mut row = row.clone();
                for (value, together) in row.measured.iter_mut().zip(together) {
                    *value += self.sigma * (together + (1.0 - share).sqrt() * deviate());
                }
                rows.push(row);
            }
        }
        data.rows = rows;
        data
    }
}

/// Intervals that hold the truth and all intervals, bias included and without.
#[derive(Default, Clone, Copy)]
pub struct Held {
    total: usize,
    noise: usize,
    all: usize,
}

impl Held {
    /// Counts an error against one standard deviation from noise alone and with
    /// the bias.
    pub fn count(&mut self, error: f64, [noise, total]: [f64; 2]) {
        self.all += 1;
        self.total += usize::from(error.abs() <= FACTOR * total);
        self.noise += usize::from(error.abs() <= FACTOR * noise);
    }

    /// Shares of many: bias included, and noise alone.
    pub fn share<'h>(all: impl Iterator<Item = &'h Self>) -> [f64; 2] {
        let mut sum = Self::default();
        for held in all {
            sum.total += held.total;
            sum.noise += held.noise;
            sum.all += held.all;
        }
        [sum.total, sum.noise].map(|count| count as f64 / sum.all as f64)
    }
}

/// Tool point, parameters that the data determine, combinations that they
/// determine (principal directions).
pub type Simulated = [Held; 3];

pub struct Tally;

impl Tally {
    /// Shares over all simulations.
    pub fn of(each: &[Simulated]) -> Vec<(&'static str, [f64; 2])> {
        let names = ["tool point, a coordinate", "parameters", "combinations of parameters"];
        let share = |k: usize| Held::share(each.iter().map(|simulated| &simulated[k]));
        names.into_iter().enumerate().map(|(k, name)| (name, share(k))).collect()
    }
}

/// Identifies an arm of the cell: a fresh one from the prior, or always the
/// same one.
pub fn identified_once(cell: &Cell, fresh: bool, rng: &mut ChaCha8Rng) -> Simulated {
    let robot = &cell.arm.robot;
    let drawn = Truth::draw_sized(robot, 1, 1, cell.tolerances, rng);
    let truth = if fresh { &drawn } else { &cell.arm };
    let data = cell.measured(truth, rng);
    let check = parse(robot, &truth.measure(JUDGED, 0.0, rng));
    let start = register(&data, &robot.nominal(), robot.tool).unwrap();
    let problem = Problem::new(&data, robot, Scaling::Prior).about(&start);
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let found = estimate(&problem, cell.rule, &rows, &start, false).unwrap();
    let covariances = Covariances::of(&problem, &found, spread(cell.rule, found.lambda));

    let mut out = [Held::default(); 3];
    let judged = Problem::new(&check, robot, Scaling::Prior);
    let at = judged.linearise(&found.fit.state);
    for row in 0..JUDGED {
        let (residual, (_, moved)) = (at.residual(row), at.target(row));
        let sigmas = covariances.of_predicted(&moved);
        for c in 0..3 {
            out[0].count(residual[c], [sigmas[0][c], sigmas[1][c]]);
        }
    }

    // Errors of the link parameters, in tolerances.
    let free = problem.unknowns.free();
    let count = problem.unknowns.list().len() - free;
    let real = problem.corrections(&truth.state()) - problem.corrections(&found.fit.state);
    let error = DVector::from_fn(count, |k, _| real[free + k]);
    let links = |m: &DMatrix<f64>| m.view((free, free), (count, count)).into_owned();
    let (noise, total) =
        (links(&covariances.noise), links(&(&covariances.noise + &covariances.bias)));
    for k in 0..count {
        if total[(k, k)].sqrt() < DETERMINED {
            out[1].count(error[k], [noise[(k, k)].sqrt(), total[(k, k)].sqrt()]);
        }
    }
    let axes = total.clone().symmetric_eigen();
    for (k, axis) in axes.eigenvectors.column_iter().enumerate() {
        let sigma = axes.eigenvalues[k].max(0.0).sqrt();
        if sigma < DETERMINED {
            out[2].count(axis.dot(&error), [axis.dot(&(&noise * axis)).sqrt(), sigma]);
        }
    }
    out
}
