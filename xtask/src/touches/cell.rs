//! Simulated accidents: an arm that has been calibrated, a plate in front of it, what it
//! touches there before and after joints have slipped.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{Chain, Pose};
use truearm_host::Error;
use truearm_host::blob::pack;
use truearm_host::identify::{Options, identify};
use truearm_host::model::Robot;
use truearm_study::simulated::{Truth, UR10_LIKE, normal, parse, robot};

use super::format::{AFTER, BEFORE, JOINTS, RADIUS, SIGMA};

/// Poses of the first calibration.
const POSES: usize = 52;
/// The middle of the plate, whose normal is upright, m, and half of its side.
const MIDDLE: [f64; 3] = [0.6, 0.2, 0.0];
const HALF: f64 = 0.25;

pub type Joints = [f64; JOINTS];

/// One accident: the bytes of its record, the arm after it, where to judge.
pub struct Accident {
    pub bytes: Vec<u8>,
    after: Truth,
    /// From the commanded frame to the tracker of the first calibration.
    commanded: Pose<f64>,
    judged_at: String,
}

/// A plane, as it is.
pub struct Face {
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

impl Face {
    pub fn height(&self, p: &Vector3<f64>) -> f64 {
        self.normal.dot(&(p - self.point))
    }
}

/// Poses at which an arm as drawn touches a plate as drawn: anywhere on it, the tool
/// turned as it comes, but from above.
pub fn poses(robot: &Robot) -> Vec<Joints> {
    let Ok(nominal) = <[_; JOINTS]>::try_from(robot.nominal()) else { return Vec::new() };
    let tool = Pose { translation: robot.tool, ..Pose::identity() };
    let chain = Chain::new(&nominal, Pose::identity(), tool);
    let mut rng = ChaCha8Rng::seed_from_u64(4243);
    let plate = Face { point: Vector3::from(MIDDLE), normal: Vector3::z() };
    let mut poses = Vec::new();
    while poses.len() < BEFORE + AFTER {
        let q = [0; JOINTS].map(|_| rng.random_range(-2.6..2.6));
        let q = come_down(q, |q| plate.height(&chain.forward(q).translation));
        let pose = chain.forward(&q);
        let off = pose.translation - plate.point;
        let on_it = off.x.abs() < HALF && off.y.abs() < HALF && off.z.abs() < 1e-6;
        if on_it && q[1].abs() < 2.6 && pose.rotation[(2, 2)] < -0.3 {
            poses.push(q);
        }
    }
    poses
}

/// Turned by joint 2 until nothing of the height is left, by Newton's method.
fn come_down(mut q: Joints, height: impl Fn(&Joints) -> f64) -> Joints {
    for _ in 0..8 {
        let mut further = q;
        further[1] += 1e-6;
        q[1] -= 1e-6 * height(&q) / (height(&further) - height(&q));
    }
    q
}

pub fn simulate(seed: u64, poses: &[Joints]) -> Result<Accident, Error> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let robot = robot(UR10_LIKE);
    let before = Truth::draw(&robot, 1, 1, &mut rng);
    let sigma = f64::from(SIGMA);
    let data = before.parse(&before.measure(POSES, sigma, &mut rng));
    let model = identify(&robot, &data, &Options::default(), &|_, _| ())?.model;
    let mut bytes = pack(&model, Some(1))?;
    let residual = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let commanded = model.stations[0].1.compose(&residual.inverse());
    // The plate leans by some 10 mrad and lies millimetres off.
    let plate = Face {
        point: Vector3::from(MIDDLE) + Vector3::from_fn(|_, _| normal(&mut rng) * 3e-3),
        normal: Vector3::new(normal(&mut rng) * 0.01, normal(&mut rng) * 0.01, 1.0).normalize(),
    };
    let numbers = MIDDLE.into_iter().chain([0.0, 0.0, 1.0]);
    bytes.extend(numbers.flat_map(|v| (v as f32).to_le_bytes()));
    let mut after = Truth {
        robot: before.robot.clone(),
        links: before.links.clone(),
        bases: before.bases.clone(),
        tools: before.tools.clone(),
    };
    // Any two of joints 2 to 5.
    let first = rng.random_range(1..5_usize);
    let second = 1 + (first + rng.random_range(0..3_usize)) % 4;
    for joint in [first, second] {
        after.links[joint].parameters.theta += normal(&mut rng) * 5e-3;
    }
    for (k, q) in poses.iter().enumerate() {
        let truth = if k < BEFORE { &before } else { &after };
        let trigger = f64::from(RADIUS) + normal(&mut rng) * sigma;
        let q = come_down(*q, |q| {
            let point = commanded.inverse().transform_point(&truth.point(q, 0, 0));
            plate.height(&point) - trigger
        });
        bytes.extend(q.iter().flat_map(|v| (*v as f32).to_le_bytes()));
    }
    let judged_at = after.measure(300, 0.0, &mut rng);
    Ok(Accident { bytes, after, commanded, judged_at })
}

impl Accident {
    /// RMS distance of a model's tool points, in the commanded frame, from where the tool
    /// is, over other poses, m.
    pub fn error_of(&self, point: impl Fn(&[f64]) -> Vector3<f64>) -> f64 {
        let check = parse(&self.after.robot, &self.judged_at);
        let square = |row: &truearm_host::model::Row| {
            let seen = self.commanded.transform_point(&point(&row.q));
            (seen - row.measured.point()).norm_squared()
        };
        (check.rows.iter().map(square).sum::<f64>() / check.rows.len() as f64).sqrt()
    }
}
