//! Derivatives of every kind against differences of its residual, and sums over
//! rows of several kinds.

mod effects;

use std::path::Path;

use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm::{Link, MdhParameters};
use truearm_simulate::instruments::{Cell, Sigmas};
use truearm_simulate::robots::UR10_LIKE;
use truearm_simulate::vector;

use super::{KINDS, by_name, measuring};
use crate::identify::fit::{Freedom, fit, folds};
use crate::identify::start::registration::register;
use crate::identify::{Problem, Scaling, State};
use crate::model::{Measurements, Robot};

const SIGMAS: Sigmas = Sigmas { length: 2e-5, angle: 1e-4, pixel: 0.1 };

pub(crate) fn robot() -> Robot {
    Robot::parse(Path::new("robot.toml"), UR10_LIKE).unwrap()
}

/// An arm of half a tolerance in a cell.
pub(crate) fn cell(robot: &Robot, rng: &mut ChaCha8Rng) -> Cell {
    let mut wrong = || {
        MdhParameters::from_array(core::array::from_fn(|_| 0.5e-3 * truearm_simulate::normal(rng)))
    };
    let links: Vec<Link<f64>> = robot.nominal().iter().map(|l| l.corrected(&wrong())).collect();
    let kinds = links.iter().map(|l| l.kind).collect();
    let links = links.iter().map(|l| l.parameters.to_array()).collect();
    Cell::around((kinds, links), robot.tool + vector(rng) * 2e-3, SIGMAS, rng)
}

pub(crate) fn read(
    robot: &Robot,
    cell: &Cell,
    wanted: &[(&'static str, usize)],
    seed: u64,
) -> Measurements {
    let text = cell.file(wanted, &mut ChaCha8Rng::seed_from_u64(seed));
    Measurements::parse_with(Path::new("m.csv"), &text, robot, &cell.stated(false)).unwrap()
}

pub(crate) fn start(problem: &Problem, robot: &Robot) -> State {
    register(problem.data, &problem.nominal, robot.tool).unwrap()
}

#[test]
fn every_kind_has_its_own_name_and_says_what_it_leaves_open() {
    for (i, kind) in KINDS.iter().enumerate() {
        assert_eq!(by_name(kind.name()).map(|id| usize::from(id.0)), Some(i));
        assert!(!kind.components().is_empty() && !kind.leaves().is_empty());
    }
}

/// Central differences of tenth order: over steps this long, in the unknowns' own units, what
/// is left of the function's bend and of the rounding is 1e-13 of the slope, as good as dual
/// numbers.
const STENCIL: [f64; 5] = [5.0 / 6.0, -5.0 / 21.0, 5.0 / 84.0, -5.0 / 504.0, 1.0 / 1260.0];
const STEP: f64 = 2.0;
/// Of pixels, which bend more.
const STEP_OF_PIXELS: f64 = 0.7;

/// At first guesses, where residuals are large: nothing is left out of them.
#[test]
fn derivatives_of_every_kind() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let cell = cell(&robot, &mut rng);
    let mut covered = vec![false; KINDS.len()];
    let all = ["point", "pose", "distance", "pair", "plate", "touch", "sphere", "cylinder"];
    for kind in all.into_iter().chain(["range", "inclination", "closure", "pixel"]) {
        let count = if kind == "pixel" { 2 } else { 12 };
        let data = read(&robot, &cell, &[(kind, count)], 7);
        let problem = Problem::new(&data, &robot, Scaling::Prior);
        let state = start(&problem, &robot);
        let at = problem.linearise(&state);
        let units = problem.units();
        let mut worst = 0.0_f64;
        for row in measuring(&data.rows) {
            covered[usize::from(data.rows[row].kind.0)] = true;
            let block = at.equations(row).block;
            let largest = block.amax();
            for k in 0..block.ncols() {
                let moved = |size: f64| {
                    let mut step = DVector::zeros(block.ncols());
                    step[k] = size * units[k];
                    let moved = state.stepped(&problem.unknowns, &step);
                    problem.linearise(&moved).scaled_residual(row)
                };
                let step = if kind == "pixel" { STEP_OF_PIXELS } else { STEP };
                let pair = |(i, weight): (usize, &f64)| {
                    let size = step * (i + 1) as f64;
                    (moved(-size) - moved(size)) * (weight / step)
                };
                let pairs: Vec<_> = STENCIL.iter().enumerate().map(pair).collect();
                for c in 0..block.nrows() {
                    let slope: f64 = pairs.iter().map(|pair| pair[c]).sum();
                    worst = worst.max((slope - block[(c, k)]).abs() / largest);
                }
            }
        }
        println!("{kind}: {worst:.1e} of the largest entry");
        assert!(worst < 1e-12, "{kind}");
    }
    assert_eq!(covered, vec![true; KINDS.len()]);
}

/// Whole minus part against a direct fit of the other rows: predicted points.
#[test]
fn a_fold_is_the_whole_minus_its_part() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let cell = cell(&robot, &mut rng);
    let data = read(&robot, &cell, &[("point", 150), ("distance", 150)], 3);
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let rows = measuring(&data.rows);
    let start = start(&problem, &robot);
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
    let cell = cell(&robot, &mut rng);
    let data = read(&robot, &cell, &[("point", 900), ("distance", 400)], 4);
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let rows = measuring(&data.rows);
    let state = start(&problem, &robot);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let at = problem.linearise(&state);
            (at.normal(&rows, None), at.triangle(&rows, None).matrix())
        })
    };
    let one = with(1);
    assert!(one == with(2) && one == with(3));
    assert_eq!(one.0.equations(), 3 * 900 + 400);
}

/// Ends of a pair are one measurement, and a label alone is none.
#[test]
fn pairs_join_two_rows() {
    let robot = robot();
    let cell = cell(&robot, &mut ChaCha8Rng::seed_from_u64(9));
    let data = read(&robot, &cell, &[("pair", 20)], 5);
    assert_eq!((data.rows.len(), measuring(&data.rows).len()), (40, 20));
    let text = cell.file(&[("pair", 2)], &mut ChaCha8Rng::seed_from_u64(1));
    let lines: Vec<&str> = text.lines().collect();
    let error =
        Measurements::parse(Path::new("m.csv"), &lines[..4].join("\n"), &robot).unwrap_err();
    assert!(error.to_string().contains("1 rows with the pair \"1\""), "{error}");
}
