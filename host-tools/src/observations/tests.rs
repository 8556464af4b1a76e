//! A second kind goes through the same code as the first, and sums over rows
//! are what they should be.

use std::path::Path;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{MdhParameters, Pose};
use truearm_simulate::normal;
use truearm_simulate::robots::UR10_LIKE;

use super::{KINDS, by_name};
use crate::evaluate::residuals;
use crate::identify::fit::{Freedom, fit};
use crate::identify::folds;
use crate::identify::registration::register;
use crate::identify::{Conditions, Options, Problem, Scaling, State, identify};
use crate::model::{Measurements, Robot};

const SIGMA: f64 = 2e-5;
const ANCHORS: [[f64; 3]; 3] = [[2.0, 0.0, 0.2], [-0.5, 2.0, 0.4], [0.3, -1.5, 2.0]];

fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), UR10_LIKE).unwrap()
}

fn truth(robot: &Robot, rng: &mut ChaCha8Rng) -> State {
    let mut wrong = || MdhParameters::from_array(core::array::from_fn(|_| 0.5e-3 * normal(rng)));
    State {
        links: robot.nominal().iter().map(|link| link.corrected(&wrong())).collect(),
        bases: vec![Pose::from_rotation_vector(
            Vector3::new(0.4, -1.2, 0.3),
            Vector3::new(0.02, -0.01, 1.3),
        )],
        markers: vec![robot.tool + Vector3::new(2e-3, -1e-3, 3e-3)],
        terms: Vec::new(),
    }
}

/// A file of so many points and distances.
fn file(truth: &State, points: usize, distances: usize, rng: &mut ChaCha8Rng) -> String {
    let arm = truth.chain(0, 0);
    let mut text = String::new();
    for j in 1..=truth.links.len() {
        text += &format!("q{j}_deg,");
    }
    text += "kind,x_mm,y_mm,z_mm,distance_mm,anchor_x_mm,anchor_y_mm,anchor_z_mm\n";
    for row in 0..points + distances {
        let q: Vec<f64> = (0..truth.links.len()).map(|_| rng.random_range(-2.0..2.0)).collect();
        let at = arm.pose(&q).translation;
        q.iter().for_each(|q| text += &format!("{:.9},", q.to_degrees()));
        if row < points {
            let seen = at.map(|x| (x + SIGMA * normal(rng)) * 1e3);
            text += &format!(",{:.6},{:.6},{:.6},,,,\n", seen.x, seen.y, seen.z);
        } else {
            let anchor = ANCHORS[row % 3];
            let length = ((at - Vector3::from(anchor)).norm() + SIGMA * normal(rng)) * 1e3;
            let [x, y, z] = anchor.map(|x| x * 1e3);
            text += &format!("distance,,,,{length:.6},{x},{y},{z}\n");
        }
    }
    text
}

fn parse(robot: &Robot, text: &str) -> Measurements {
    Measurements::parse(Path::new("m.csv"), text, robot).unwrap()
}

/// RMS error of predicted points of noise-free poses, m.
fn error(robot: &Robot, truth: &State, found: &State) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(99);
    let mut check = parse(robot, &file(truth, 200, 0, &mut rng));
    let arm = truth.chain(0, 0);
    for row in &mut check.rows {
        row.measured = arm.pose(&row.q).translation.into();
    }
    let all = residuals(&check, &Conditions::new(&check, robot), found);
    (all.iter().map(|r| r.norm().powi(2)).sum::<f64>() / all.len() as f64).sqrt()
}

#[test]
fn every_kind_has_its_own_name_and_columns() {
    for (i, kind) in KINDS.iter().enumerate() {
        assert_eq!(by_name(kind.name()).map(|id| usize::from(id.0)), Some(i));
        assert!(!kind.components().is_empty() && !kind.columns().is_empty());
    }
}

/// Twenty points and many distances are fitted together, flags and folds and
/// all; a wrong distance is named.
#[test]
fn distances_are_fitted_by_the_code_that_fits_points() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let truth = truth(&robot, &mut rng);
    let mut data = parse(&robot, &file(&truth, 20, 240, &mut rng));
    data.rows[100].measured[0] += 5e-3;
    let found = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap();
    assert_eq!(found.figures.outlier_rows, [101]);
    assert_eq!(found.figures.outliers[0].coordinates, ["distance"]);
    assert!((found.figures.outliers[0].residual_mm[0] - 5.0).abs() < 0.3);
    assert_eq!(found.rows[100].held_out.unwrap().len(), 1);
    assert_eq!(found.rows[0].held_out.unwrap().len(), 3);
    let state = |found: &crate::identify::Identification| State {
        bases: found.model.stations.iter().map(|s| s.1).collect(),
        markers: found.model.markers.iter().map(|m| m.1).collect(),
        links: found.model.links(),
        terms: Vec::new(),
    };
    let both = error(&robot, &truth, &state(&found));
    let mut points = data.clone();
    points.rows.truncate(20);
    points.poses = 20;
    let points = identify(&robot, &points, &Options::default(), &|_, _| ()).unwrap();
    let points = error(&robot, &truth, &state(&points));
    println!("20 points {points:.2e} m, with 240 distances {both:.2e} m");
    assert!(both < 2.0 * SIGMA && both < 0.5 * points);
}

/// The derivatives of a row against differences of its residual.
#[test]
fn derivatives_of_every_kind() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let truth = truth(&robot, &mut rng);
    let data = parse(&robot, &file(&truth, 5, 5, &mut rng));
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let at = problem.linearise(&truth);
    for row in 0..data.rows.len() {
        let block = at.equations(row).block;
        for k in 0..block.ncols() {
            let moved = |size: f64| {
                let mut step = nalgebra::DVector::zeros(block.ncols());
                step[k] = size;
                let state = truth.stepped(&problem.unknowns, &at.to_si(&step));
                problem.linearise(&state).equations(row).scaled_residual()
            };
            let difference = (moved(-1e-3) - moved(1e-3)) / 2e-3;
            for c in 0..difference.len() {
                let wrong = (difference[c] - block[(c, k)]).abs();
                assert!(wrong < 1e-4, "row {row}, column {k}: {} {}", difference[c], block[(c, k)]);
            }
        }
    }
}

/// Whole minus part against a direct fit of the other rows: predicted points.
#[test]
fn a_fold_is_the_whole_minus_its_part() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let truth = truth(&robot, &mut rng);
    let data = parse(&robot, &file(&truth, 150, 150, &mut rng));
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let start = register(&data, &problem.nominal, robot.tool).unwrap();
    let whole = fit(&problem, &rows, None, &start, Freedom::All(1.0)).unwrap();
    let at = problem.linearise(&whole.state);
    let mut worst = 0.0_f64;
    for fold in folds::random(&data, &rows, 1) {
        let free = problem.unknowns.free();
        let less = whole.normal.minus(&at.normal(&fold.held_out, None)).unwrap();
        let direct = at.normal(&fold.fit, None);
        let state = |normal: &crate::tikhonov::Normal| {
            let step = normal.solve(free, 1.0).unwrap() - at.corrections();
            whole.state.stepped(&problem.unknowns, &at.to_si(&step)).chain(0, 0)
        };
        let (less, direct) = (state(&less), state(&direct));
        for row in &data.rows {
            let (a, b) = (less.pose(&row.q).translation, direct.pose(&row.q).translation);
            worst = worst.max((a - b).norm() / b.norm());
        }
    }
    println!("predicted points apart by {worst:.1e} of their distance");
    assert!(worst < 1e-9);
}

/// To the last bit, whatever the number of threads.
#[test]
fn sums_do_not_depend_on_threads() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let truth = truth(&robot, &mut rng);
    let data = parse(&robot, &file(&truth, 900, 400, &mut rng));
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let at = problem.linearise(&truth);
            (at.normal(&rows, None), at.triangle(&rows, None).matrix())
        })
    };
    let one = with(1);
    assert!(one == with(2) && one == with(3));
    assert_eq!(one.0.equations(), 3 * 900 + 400);
}
