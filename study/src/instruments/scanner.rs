//! The published simulation of SCALAR (arXiv 1803.00747): a range finder with a fan
//! of rays on the flange of a 6R arm, three planes around it. Of its set-up the
//! abstract says that much, and how far off the sensor is before and after; what it
//! does not say is assumed here ([`Setup`]).

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm::Pose;
use truearm_host::Result;
use truearm_host::identify::{Options, identify, rigid_transform};
use truearm_host::model::arm::chain;
use truearm_host::model::{Measurements, Model, Robot};
use truearm_host::observations::ray_of;
use truearm_simulate::instruments::{Cell, Scanner, Sigmas, apart};
use truearm_simulate::{normal, rigid, robots, vector};

/// What the abstract leaves open.
#[derive(Debug, Clone, Copy)]
pub struct Setup {
    /// Of one range, m.
    pub sigma: f64,
    /// Poses before each plane.
    pub poses: usize,
}

/// Standard deviations of what is wrong before, m and rad: of every length and
/// angle of the arm, and of how the sensor is turned on the flange. Chosen so that
/// the sensor is as far off as it was published to be.
const LENGTH: f64 = 1e-3;
const ANGLE: f64 = 9.42e-3;
const MOUNT: f64 = 0.0376;
/// The rays, from the sensor's z.
const FAN: [f64; 3] = [-0.25, 0.0, 0.25];
const SEES: [f64; 2] = [0.1, 1.2];
const JUDGED: usize = 100;
/// Seeds of their own.
const SEEDS: u64 = 3 << 32;

/// Mean errors of the sensor over poses: m and rad, before and after.
pub type Errors = [[f64; 2]; 2];

/// Where the drawing has the sensor in the last frame.
fn drawn() -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(0.05, 0.0, 0.08), Vector3::zeros())
}

/// The arm with the sensor in the place of the tool: six joints, spherical wrist.
fn robot() -> Robot {
    let text = robots::ALL[1];
    let mut robot = Robot::parse(Path::new("robot.toml"), text).unwrap_or_else(|e| panic!("{e}"));
    robot.tool = drawn().0;
    robot
}

/// One arm.
///
/// # Errors
/// As of `identify`.
pub fn once(setup: Setup, seed: u64) -> Result<Errors> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEEDS + seed);
    let robot = robot();
    let links = robot.nominal().into_iter().map(|link| {
        let nominal = link.parameters.to_array();
        // alpha, a, theta, d, beta
        let sizes = [ANGLE, LENGTH, ANGLE, LENGTH, ANGLE];
        core::array::from_fn(|k| nominal[k] + sizes[k] * normal(&mut rng))
    });
    let links = links.collect();
    let kinds = robot.joints.iter().map(|j| j.link.kind).collect();
    let sigmas = Sigmas { length: setup.sigma, angle: 0.0, pixel: 0.0 };
    let cell = Cell::around((kinds, links), robot.tool, sigmas, &mut rng);
    let (at, turn) = drawn();
    let nominal = rigid(&turn, &at);
    let place = rigid(&(turn + vector(&mut rng) * MOUNT), &(at + vector(&mut rng) * LENGTH));
    let scanner = Scanner { place, rays: FAN.to_vec(), sees: SEES };
    let text = cell.scans(&scanner, setup.poses, &mut rng);
    let stated = scanner.stated(&nominal);
    let data = Measurements::parse_with(Path::new("m.csv"), &text, &robot, &stated)?;
    let found = identify(&robot, &data, &Options::default(), &|_, _| ())?;

    let poses: Vec<Vec<f64>> = (0..JUDGED).map(|_| cell.pose(&mut rng)).collect();
    let real: Vec<_> = poses.iter().map(|q| cell.scanner_at(&scanner, q)).collect();
    let told = Pose { rotation: Matrix3::identity(), translation: at };
    let before = chain(&robot.nominal(), Pose::identity(), Vector3::zeros());
    let before: Vec<_> = poses.iter().map(|q| before.pose(q).compose(&told)).collect();
    let after = chain(&found.model.links(), Pose::identity(), Vector3::zeros());
    let sensor = sensor(&found.model);
    let after: Vec<_> = poses.iter().map(|q| after.pose(q).compose(&sensor)).collect();
    // Ranges to planes of unknown place do not tell where the arm stands.
    let at = |all: &[Pose<f64>]| all.iter().map(|p| p.translation).collect::<Vec<_>>();
    let truly: Vec<_> = real.iter().map(|r| r.0).collect();
    let frame = rigid_transform(&at(&after), &truly, &vec![1.0; JUDGED]);
    let frame = frame.unwrap_or_else(Pose::identity);
    let after: Vec<_> = after.iter().map(|p| frame.compose(p)).collect();
    Ok([errors(&before, &real), errors(&after, &real)])
}

/// Where the sensor was found to be in the last frame: its rays were fitted one by
/// one, each with its own origin.
fn sensor(model: &Model) -> Pose<f64> {
    let origins = model.markers.iter().map(|marker| marker.1);
    let translation = origins.sum::<Vector3<f64>>() / model.markers.len() as f64;
    let way = |k: usize| {
        let label = ray_of(&format!("ray{k}"));
        let ray = model.instruments.iter().find(|ray| ray.label == label);
        ray.map_or_else(Vector3::z, |ray| ray.place.rotation.column(2).into_owned())
    };
    let ways: Vec<_> = (0..FAN.len()).map(way).collect();
    let z = ways.iter().sum::<Vector3<f64>>().normalize();
    let across = ways[FAN.len() - 1] - ways[0];
    let x = (across - z * across.dot(&z)).normalize();
    let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
    Pose { rotation: axes, translation }
}

fn errors(found: &[Pose<f64>], real: &[(Vector3<f64>, Matrix3<f64>)]) -> [f64; 2] {
    let count = real.len() as f64;
    let both = || found.iter().zip(real);
    let place = both().map(|(f, r)| (f.translation - r.0).norm()).sum::<f64>();
    let turn = both().map(|(f, r)| apart(&f.rotation, &r.1)).sum::<f64>();
    [place / count, turn / count]
}

/// Means over arms.
///
/// # Errors
/// As of `identify`.
pub fn means(setup: Setup, arms: u64) -> Result<Errors> {
    let all: Vec<Errors> =
        (0..arms).into_par_iter().map(|seed| once(setup, seed)).collect::<Result<_>>()?;
    let mean = |a: usize, b: usize| all.iter().map(|e| e[a][b]).sum::<f64>() / arms as f64;
    Ok([[mean(0, 0), mean(0, 1)], [mean(1, 0), mean(1, 1)]])
}
