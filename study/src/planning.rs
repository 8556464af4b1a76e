//! How large the worst error of the tool point really is after an
//! identification from given poses: many simulated ones of one arm.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::files::{Gathered, poses_csv};
use truearm_host::identify::fit::{Freedom, fit};
use truearm_host::identify::{Conditions, Predictor, Problem, Scaling};
use truearm_host::model::{KindId, Measurements, Robot, Sight, Workspace};
use truearm_host::plan::{PlanOptions, PosePlan, plan};
use truearm_simulate::{csv, robots};

use crate::simulated::{Truth, parse, robot, vector};

const SIGMA: f64 = 2e-5;
/// Poses at which the tool point is judged.
const JUDGED: usize = 400;

pub const PLANNED: usize = 20;
pub const RANDOM: usize = 30;

/// A robot with a truth, a workspace, and what was planned.
pub struct Trial {
    pub robot: Robot,
    pub plan: PosePlan,
    truth: Truth,
    random: Vec<Vec<f64>>,
    judged: Vec<Vec<f64>>,
}

/// Worst errors over the workspace, m.
pub struct Outcome {
    pub planned: f64,
    pub random: f64,
    pub bound: f64,
}

impl Trial {
    /// One of the six arms with every length changed by up to a fifth; every
    /// other one has a box and a tracker that must see it.
    pub fn draw(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut robot = robot(robots::ALL[seed as usize % robots::ALL.len()]);
        robot.sigma = SIGMA;
        for joint in &mut robot.joints {
            joint.link.parameters.a *= rng.random_range(0.8..1.2);
            joint.link.parameters.d *= rng.random_range(0.8..1.2);
        }
        let truth = Truth::draw(&robot, 1, 1, &mut rng);
        let mut workspace = Workspace::new(&robot, None).unwrap();
        if seed % 2 == 1 {
            workspace.corners = Some([Vector3::new(-1.5, -1.5, 0.0), Vector3::new(1.5, 1.5, 2.0)]);
            workspace.sight = Some(Sight {
                tracker: Vector3::new(3.0, 1.0, 1.0),
                axis: Vector3::z(),
                cone: 90_f64.to_radians(),
            });
        }
        let random = workspace.sample(&robot, RANDOM, &mut rng).unwrap();
        let judged = workspace.sample(&robot, JUDGED, &mut rng).unwrap();
        let options = PlanOptions {
            kind: KindId::default(),
            instruments: Gathered::default(),
            poses: PLANNED,
            workspace,
            candidates: 3000,
            target: None,
            seed,
        };
        let plan = plan(&robot, &options, &|_, _| ()).unwrap();
        Self { robot, plan, truth, random, judged }
    }

    /// Simulates so many identifications from each set of poses.
    pub fn simulate(&self, repeats: usize, rng: &mut ChaCha8Rng) -> Outcome {
        Outcome {
            planned: self.worst(&self.plan.poses, repeats, rng),
            random: self.worst(&self.random, repeats, rng),
            bound: self.plan.bound.unwrap_or(f64::NAN),
        }
    }

    /// RMS over identifications of the error at the worst pose. That pose is
    /// found in one half of the identifications and judged in the other, or
    /// chance would choose it.
    fn worst(&self, poses: &[Vec<f64>], repeats: usize, rng: &mut ChaCha8Rng) -> f64 {
        let exact = self.measured(poses);
        let judged = self.measured(&self.judged);
        let conditions = Conditions::new(&judged, &self.robot);
        let rows: Vec<usize> = (0..poses.len()).collect();
        let mut squares = [vec![0.0; JUDGED], vec![0.0; JUDGED]];
        for k in 0..repeats {
            let mut data = exact.clone();
            for row in &mut data.rows {
                row.measured = (row.measured.point() + vector(rng) * SIGMA).into();
            }
            let problem = Problem::new(&data, &self.robot, Scaling::Prior);
            let found = fit(&problem, &rows, None, &self.truth.state(), Freedom::All(1.0));
            let arm = Predictor::new(&found.unwrap().state);
            for (i, row) in judged.rows.iter().enumerate() {
                let error = arm.point(row, &conditions.rows[i]) - row.measured.point();
                squares[k % 2][i] += error.norm_squared();
            }
        }
        let [choose, judge] = squares;
        let worst = (0..JUDGED).max_by(|a, b| choose[*a].total_cmp(&choose[*b])).unwrap();
        (judge[worst] / (repeats / 2) as f64).sqrt()
    }

    /// Rows of these poses without noise.
    fn measured(&self, poses: &[Vec<f64>]) -> Measurements {
        let lines = poses_csv(&self.robot, "q", poses, &[]);
        let joints = lines.lines().map(|line| line.split(',').take(self.robot.joints.len()));
        let header = ["x_mm", "y_mm", "z_mm"].map(str::to_owned);
        let points = poses.iter().map(|q| {
            let point = self.truth.point(q, 0, 0) * 1e3;
            [point.x, point.y, point.z].map(|x| format!("{x:.9}"))
        });
        let rows = joints
            .zip(std::iter::once(header).chain(points))
            .map(|(joints, point)| joints.map(str::to_owned).chain(point));
        parse(&self.robot, &csv(rows))
    }
}
