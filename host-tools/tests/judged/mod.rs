//! Simulated cells whose truth is known, and what any estimate of an arm in them
//! can reach: the bound of Cramer and Rao (van Trees, as the tolerances are a
//! prior). For the tests of the host and for the studies.

#![allow(dead_code, missing_docs, reason = "each takes what it needs")]

use std::path::Path;

use nalgebra::{DMatrix, Matrix6xX, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm::Pose;
use truearm_host::Result;
use truearm_host::identify::fit::estimate::{Estimate, estimate};
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{LambdaRule, Problem, Scaling, State, Unknown};
use truearm_host::model::arm::{Kinematics, RowInputs, chain};
use truearm_host::model::{Form, Instrument, Measurements, Robot};
use truearm_host::observations::measuring;
use truearm_host::tikhonov::covariance;
use truearm_simulate::body::apply;
use truearm_simulate::instruments::{Cell, Sigmas};
use truearm_simulate::robots::UR10_LIKE;
use truearm_simulate::{normal, vector};

pub const SIGMAS: Sigmas = Sigmas { length: 2e-5, angle: 1e-4, pixel: 0.1 };
/// Poses over the workspace at which the tool is judged.
const JUDGED: usize = 100;

pub fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), UR10_LIKE).unwrap()
}

/// An arm made to the tolerances, in a cell.
pub fn cell(robot: &Robot, rng: &mut ChaCha8Rng) -> Cell {
    let links = robot.nominal().into_iter().map(|link| {
        let nominal = link.parameters.to_array();
        core::array::from_fn(|k| nominal[k] + 1e-3 * normal(rng))
    });
    let links = links.collect();
    let kinds = robot.joints.iter().map(|j| j.link.kind).collect();
    Cell::around((kinds, links), robot.tool + vector(rng) * 1e-3, SIGMAS, rng)
}

pub fn read(robot: &Robot, cell: &Cell, text: &str) -> Measurements {
    Measurements::parse_with(Path::new("m.csv"), text, robot, &cell.stated(false)).unwrap()
}

/// The tool in the arm's frame at some poses, with the frame that is in no
/// kind's power to tell: a rigid motion of all of them.
pub struct Judged {
    poses: Vec<Vec<f64>>,
    real: Vec<Vector3<f64>>,
    /// The camera among the instruments, where that is the tool.
    camera: Option<usize>,
}

impl Judged {
    pub fn new(cell: &Cell, rng: &mut ChaCha8Rng) -> Self {
        let poses: Vec<_> = (0..JUDGED).map(|_| cell.pose(rng)).collect();
        let real = poses.iter().map(|q| cell.target(q)).collect();
        Self { poses, real, camera: None }
    }

    /// What a problem is about: the tool, or the camera in hand where no row
    /// depends on the tool. Images of a board say nothing of another point.
    pub fn of(problem: &Problem, cell: &Cell, rng: &mut ChaCha8Rng) -> Self {
        let is_camera = |i: &Instrument| i.form == Form::Camera && i.on_flange;
        let camera = problem.data.instruments.iter().position(is_camera);
        let camera = camera.filter(|_| problem.unknowns.marker(0).is_none());
        let tool = Self::new(cell, rng);
        if camera.is_none() {
            return tool;
        }
        let seen = Vector3::from_fn(|i, _| cell.camera.place[i][3]);
        let real = tool.poses.iter().map(|q| apply(&cell.flange(q), &seen)).collect();
        Self { real, camera, ..tool }
    }

    fn arm(&self, state: &State) -> Box<dyn Kinematics> {
        let camera = self.camera.map(|i| state.instruments[i].place.translation);
        chain(&state.links, Pose::identity(), camera.unwrap_or(state.markers[0]))
    }

    /// What no rigid motion explains of small errors, a column each: 3 n x any.
    fn rest(&self, errors: &DMatrix<f64>) -> DMatrix<f64> {
        let mut rigid = Matrix6xX::zeros(3 * self.real.len());
        for (k, point) in self.real.iter().enumerate() {
            for c in 0..3 {
                let axis = Vector3::ith(c, 1.0);
                rigid[(c, 3 * k + c)] = 1.0;
                let moved = axis.cross(point);
                (0..3).for_each(|r| rigid[(3 + c, 3 * k + r)] = moved[r]);
            }
        }
        let rigid = DMatrix::from_fn(3 * self.real.len(), 6, |r, c| rigid[(c, r)]);
        let fitted = rigid.clone().svd(true, true).solve(errors, 1e-12).unwrap();
        errors - rigid * fitted
    }

    /// Root mean square error of the tool, m.
    pub fn error(&self, state: &State) -> f64 {
        let arm = self.arm(state);
        let errors = self.poses.iter().zip(&self.real);
        let errors: Vec<f64> = errors
            .flat_map(|(q, real)| {
                (arm.pose(q).translation - real).iter().copied().collect::<Vec<_>>()
            })
            .collect();
        let rest = self.rest(&DMatrix::from_vec(errors.len(), 1, errors));
        (rest.norm_squared() / JUDGED as f64).sqrt()
    }

    /// What the bound says of its square: the posterior at the truth.
    pub fn bound(&self, problem: &Problem, state: &State, covariance: &DMatrix<f64>) -> f64 {
        let arm = self.arm(state);
        let list = problem.unknowns.list();
        let units = problem.units();
        let mut moved = DMatrix::zeros(3 * JUDGED, list.len());
        for (i, q) in self.poses.iter().enumerate() {
            let d = arm.derivatives(q, &[], &RowInputs::default());
            for (k, unknown) in list.iter().enumerate() {
                let column = match unknown {
                    Unknown::Link(joint, p) => *d.links[*joint].get(*p),
                    Unknown::Marker(0, c) => d.tool[*c],
                    // Along its own axes.
                    Unknown::Instrument(c, k @ 3.., _) if Some(*c) == self.camera => {
                        let axis = state.instruments[*c].place.rotation.column(*k - 3);
                        (0..3).map(|c| d.tool[c] * axis[c]).sum()
                    }
                    _ => continue,
                };
                (0..3).for_each(|c| moved[(3 * i + c, k)] = column[c] * units[k]);
            }
        }
        let rest = self.rest(&moved);
        (&rest * covariance).component_mul(&rest).sum() / JUDGED as f64
    }
}

/// An arm in its cell, what was measured of it and what was found.
pub struct Solved<'a> {
    pub cell: &'a Cell,
    pub problem: &'a Problem<'a>,
    pub found: &'a Estimate,
}

/// Looks at the maximum a posteriori estimate of an arm made to the tolerances.
pub fn solved<T>(
    robot: &Robot,
    wanted: &[(&'static str, usize)],
    seed: u64,
    look: impl FnOnce(&Solved, &mut ChaCha8Rng) -> T,
) -> Result<T> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let cell = cell(robot, &mut rng);
    let data = read(robot, &cell, &cell.file(wanted, &mut rng));
    let problem = Problem::new(&data, robot, Scaling::Prior);
    let found = most_probable(&problem, robot)?;
    Ok(look(&Solved { cell: &cell, problem: &problem, found: &found }, &mut rng))
}

/// The maximum a posteriori estimate of all rows.
pub fn most_probable(problem: &Problem, robot: &Robot) -> Result<Estimate> {
    let rows = measuring(&problem.data.rows);
    let start = register(problem.data, &problem.nominal, robot.tool)?;
    estimate(problem, LambdaRule::MaximumAPosteriori, &rows, &start, false)
}

/// Squares of the error and of its bound, of one arm, m^2.
pub fn once(robot: &Robot, wanted: &[(&'static str, usize)], seed: u64) -> Result<[f64; 2]> {
    solved(robot, wanted, seed, |solved, rng| {
        let (problem, fit) = (solved.problem, &solved.found.fit);
        let judged = Judged::of(problem, solved.cell, rng);
        let covariance = covariance(&fit.normal, problem.unknowns.free(), 1.0);
        let bound = judged.bound(problem, &fit.state, &covariance);
        [judged.error(&fit.state).powi(2), bound]
    })
}

/// Root mean square error over arms, in units of the bound, and two standard
/// errors of that; the bound, m.
pub fn efficiency(robot: &Robot, wanted: &[(&'static str, usize)], seeds: u64) -> [f64; 3] {
    let all: Vec<[f64; 2]> = (0..seeds)
        .into_par_iter()
        .map(|seed| once(robot, wanted, seed).unwrap_or_else(|e| panic!("{wanted:?} {seed}: {e}")))
        .collect();
    let count = seeds as f64;
    let mean = |k: usize| all.iter().map(|x| x[k]).sum::<f64>() / count;
    let ratio = mean(0) / mean(1);
    let off = |x: &[f64; 2]| (x[0] / mean(1) - ratio * x[1] / mean(1)).powi(2);
    let error = (all.iter().map(off).sum::<f64>() / count / count).sqrt();
    [ratio.sqrt(), error / ratio.sqrt(), mean(1).sqrt()]
}
