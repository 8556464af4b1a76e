//! Every kind of measurement in `identify`: simulated cells whose truth is known,
//! judged by the bound of Cramer and Rao (van Trees, as the tolerances are a
//! prior), and what mixed kinds, wrong sigmas and labels do.

use std::path::Path;

use nalgebra::{DMatrix, DVector, Matrix6xX, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm_host::Result;
use truearm_host::identify::estimate::estimate;
use truearm_host::identify::registration::register;
use truearm_host::identify::{
    LambdaRule, Options, Problem, Scaling, State, Unknown, components, identify,
};
use truearm_host::model::{Measurements, Robot};
use truearm_host::observations::measuring;
use truearm_host::tikhonov::covariance;
use truearm_simulate::instruments::{Cell, Sigmas};
use truearm_simulate::robots::UR10_LIKE;
use truearm_simulate::{normal, vector};

const SIGMAS: Sigmas = Sigmas { length: 2e-5, angle: 1e-4, pixel: 0.1 };
const SEEDS: u64 = 40;
/// Poses over the workspace at which the tool is judged.
const JUDGED: usize = 100;

fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), UR10_LIKE).unwrap()
}

/// An arm made to the tolerances, in a cell.
fn cell(robot: &Robot, rng: &mut ChaCha8Rng) -> Cell {
    let links = robot.nominal().into_iter().map(|link| {
        let nominal = link.parameters.to_array();
        core::array::from_fn(|k| nominal[k] + 1e-3 * normal(rng))
    });
    let links = links.collect();
    let kinds = robot.joints.iter().map(|j| j.link.kind).collect();
    Cell::around((kinds, links), robot.tool + vector(rng) * 1e-3, SIGMAS, rng)
}

fn read(robot: &Robot, cell: &Cell, text: &str) -> Measurements {
    Measurements::parse_with(Path::new("m.csv"), text, robot, &cell.stated(false)).unwrap()
}

/// The tool in the arm's frame at some poses, with the frame that is in no
/// kind's power to tell: a rigid motion of all of them.
struct Judged {
    poses: Vec<Vec<f64>>,
    real: Vec<Vector3<f64>>,
}

impl Judged {
    fn new(cell: &Cell, rng: &mut ChaCha8Rng) -> Self {
        let poses: Vec<_> = (0..JUDGED).map(|_| cell.pose(rng)).collect();
        let real = poses.iter().map(|q| cell.target(q)).collect();
        Self { poses, real }
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
    fn error(&self, state: &State) -> f64 {
        let arm = truearm_host::model::arm::chain(
            &state.links,
            truearm::Pose::identity(),
            state.markers[0],
        );
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
    fn bound(&self, problem: &Problem, state: &State, covariance: &DMatrix<f64>) -> f64 {
        let arm = truearm_host::model::arm::chain(
            &state.links,
            truearm::Pose::identity(),
            state.markers[0],
        );
        let list = problem.unknowns.list();
        let units = problem.units();
        let mut moved = DMatrix::zeros(3 * JUDGED, list.len());
        for (i, q) in self.poses.iter().enumerate() {
            let (d, _) = arm.derivatives(q, &[], &Default::default());
            for (k, unknown) in list.iter().enumerate() {
                let column = match unknown {
                    Unknown::Link(joint, p) => *d.links[*joint].get(*p),
                    Unknown::Marker(0, c) => d.tool[*c],
                    _ => continue,
                };
                (0..3).for_each(|c| moved[(3 * i + c, k)] = column[c] * units[k]);
            }
        }
        let rest = self.rest(&moved);
        (&rest * covariance).component_mul(&rest).sum() / JUDGED as f64
    }
}

/// Squares of the error and of its bound, of one arm.
fn once(wanted: &[(&'static str, usize)], seed: u64) -> Result<[f64; 2]> {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let cell = cell(&robot, &mut rng);
    let data = read(&robot, &cell, &cell.file(wanted, &mut rng));
    let judged = Judged::new(&cell, &mut rng);
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let rows = measuring(&data.rows);
    let start = register(&data, &problem.nominal, robot.tool)?;
    let found = estimate(&problem, LambdaRule::MaximumAPosteriori, &rows, &start, false)?;
    let state = &found.fit.state;
    let covariance = covariance(&found.fit.normal, problem.unknowns.free(), 1.0);
    Ok([judged.error(state).powi(2), judged.bound(&problem, state, &covariance)])
}

/// Root mean square error over arms, in units of the bound, and two standard
/// errors of that.
fn efficiency(wanted: &[(&'static str, usize)]) -> [f64; 3] {
    let all: Vec<[f64; 2]> =
        (0..SEEDS).into_par_iter().map(|seed| once(wanted, seed).unwrap()).collect();
    let count = SEEDS as f64;
    let mean = |k: usize| all.iter().map(|x| x[k]).sum::<f64>() / count;
    let ratio = mean(0) / mean(1);
    let spread = all.iter().map(|x| (x[0] / mean(1) - ratio * x[1] / mean(1)).powi(2)).sum::<f64>();
    let error = (spread / count).sqrt() / count.sqrt();
    [ratio.sqrt(), error / ratio.sqrt(), mean(1).sqrt()]
}

fn reaches_its_bound(wanted: &[(&'static str, usize)]) {
    let [ratio, two_errors, bound] = efficiency(wanted);
    println!("{wanted:?}: {ratio:.3} +- {two_errors:.3} of {:.4} mm", bound * 1e3);
    assert!(ratio <= 1.03 + two_errors, "{wanted:?}");
}

#[test]
fn points_and_poses_reach_their_bound() {
    reaches_its_bound(&[("point", 50)]);
    reaches_its_bound(&[("pose", 50)]);
}

#[test]
fn lengths_reach_their_bound() {
    reaches_its_bound(&[("distance", 200)]);
    reaches_its_bound(&[("pair", 200)]);
}

#[test]
fn touches_reach_their_bound() {
    reaches_its_bound(&[("touch", 150)]);
    reaches_its_bound(&[("touch", 60), ("sphere", 60)]);
    reaches_its_bound(&[("cylinder", 150)]);
}

#[test]
fn holes_and_closures_reach_their_bound() {
    reaches_its_bound(&[("plate", 100)]);
    reaches_its_bound(&[("closure", 90)]);
}

#[test]
fn what_turns_with_the_flange_reaches_its_bound() {
    reaches_its_bound(&[("range", 150)]);
    reaches_its_bound(&[("inclination", 100), ("distance", 60)]);
    reaches_its_bound(&[("pixel", 20)]);
}

fn found(robot: &Robot, data: &Measurements) -> truearm_host::identify::Identification {
    identify(robot, data, &Options::default(), &|_, _| ()).unwrap()
}

fn state(found: &truearm_host::identify::Identification) -> State {
    State {
        bases: found.model.stations.iter().map(|s| s.1).collect(),
        markers: found.model.markers.iter().map(|m| m.1).collect(),
        instruments: found.model.instruments.clone(),
        links: found.model.links(),
        terms: Vec::new(),
    }
}

/// Fifteen points and a hundred touches beat either alone, and a sigma that is
/// three times too large or too small in one kind does not hurt: what is wrong
/// is found out.
#[test]
fn mixed_kinds_find_their_own_noise() {
    let robot = robot();
    let mut squares = [0.0; 4];
    for seed in 0..6 {
        let mut rng = ChaCha8Rng::seed_from_u64(100 + seed);
        let cell = cell(&robot, &mut rng);
        let judged = Judged::new(&cell, &mut rng);
        let points = cell.file(&[("point", 15)], &mut rng);
        let touches = cell.file(&[("touch", 100)], &mut rng);
        let behind = touches.split_once('\n').unwrap().1;
        let both = points.clone() + behind;
        let error = |text: &str, sigma: f64| {
            let mut data = read(&robot, &cell, text);
            let touches = data.rows.iter_mut().filter(|r| r.kind.0 != 0);
            touches.for_each(|r| r.sigma *= sigma);
            let options = Options { allow_few_poses: true, ..Options::default() };
            let found = identify(&robot, &data, &options, &|_, _| ()).unwrap();
            (judged.error(&state(&found)), found)
        };
        let wrong = error(&both, 3.0);
        let scale = |k: usize| wrong.1.figures.kinds[k].noise_scale;
        assert!((scale(1) * 3.0 - 1.0).abs() < 0.3, "seed {seed}: touch {}", scale(1));
        let errors = [error(&points, 1.0).0, error(&touches, 1.0).0, error(&both, 1.0).0, wrong.0];
        (0..4).for_each(|k| squares[k] += errors[k].powi(2));
    }
    let [points, touches, both, wrong] = squares.map(|s| (s / 6.0).sqrt() * 1e3);
    println!(
        "15 points {points:.4}, 100 touches {touches:.4}, both {both:.4}, sigma x 3 {wrong:.4} mm"
    );
    assert!(both < points && both < touches && wrong < 1.1 * both);
}

/// Poses say how the last frame is turned; points do not.
#[test]
fn poses_identify_the_orientation() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let cell = cell(&robot, &mut rng);
    for (kind, known) in [("pose", true), ("point", false)] {
        let found = found(&robot, &read(&robot, &cell, &cell.file(&[(kind, 50)], &mut rng)));
        assert_eq!(found.model.orientation_identified, known, "{kind}");
        assert_eq!(found.figures.rank, if known { 30 } else { 27 });
    }
}

/// Planes of unknown place leave the scale open, and it is said; a plate closes
/// it.
#[test]
fn planes_leave_the_scale_open() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let cell = cell(&robot, &mut rng);
    let open = |text: &str| {
        let found = found(&robot, &read(&robot, &cell, text));
        let told = found.figures.unidentifiable.iter().any(|line| line.contains("scale"));
        (told, found.figures)
    };
    let (told, figures) = open(&cell.file(&[("touch", 150)], &mut rng));
    assert!(told, "{:?}", figures.unidentifiable);
    assert!(figures.left_open[0].contains("overall scale"));
    let (told, figures) = open(&cell.file(&[("touch", 150), ("plate", 20)], &mut rng));
    assert!(!told, "{:?}", figures.unidentifiable);
}

/// A wrong length is named with its component.
#[test]
fn a_wrong_length_is_flagged() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let cell = cell(&robot, &mut rng);
    let text = cell.file(&[("point", 20), ("distance", 240)], &mut rng);
    let mut data = read(&robot, &cell, &text);
    data.rows[100].measured[0] += 5e-3;
    let found = found(&robot, &data);
    assert_eq!(found.figures.outlier_rows, [101]);
    assert_eq!(found.figures.outliers[0].coordinates, ["distance"]);
    assert!((found.figures.outliers[0].residual_mm[0] - 5.0).abs() < 0.3);
    assert_eq!(found.rows[100].held_out.unwrap().len(), 1);
    let _ = (DVector::<f64>::zeros(1), components::Noise::default());
}
