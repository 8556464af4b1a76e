//! Simulated arms: how good the identification is where the truth is known.

use crate::simulated::{ON_RAIL, Truth, UR10_LIKE, rms, robot, state_of};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{LambdaRule, Options, Problem, Scaling, State, identify};
use truearm_host::model::{Measurements, Robot};
use truearm_host::statistics::median;

const SIGMA: f64 = 2e-5;

/// RMS that an efficient unbiased estimate would have on the validation poses:
/// Cramer-Rao, from the oracle-free Jacobian at the truth, identifiable
/// directions only.
fn cramer_rao(
    rank: usize,
    robot: &Robot,
    data: &Measurements,
    check: &Measurements,
    truth: &Truth,
) -> f64 {
    let state = truth.state();
    let rows = |data: &Measurements| {
        let problem = Problem::new(data, robot, Scaling::Prior);
        let at = problem.linearise(&state);
        let mut m = DMatrix::zeros(3 * data.rows.len(), problem.unknowns.list().len());
        for i in 0..data.rows.len() {
            m.rows_mut(3 * i, 3).copy_from(&at.equations(i).block);
        }
        m
    };
    let svd = rows(data).svd(false, true);
    let v_t = svd.v_t.unwrap();
    let j = rows(check);
    // The true arm is not exactly redundant: its axes are not quite parallel.
    // The nominal rank counts.
    let mut square = 0.0;
    for k in 0..rank {
        square += (&j * v_t.row(k).transpose()).norm_squared() / svd.singular_values[k].powi(2);
    }
    (square / check.rows.len() as f64).sqrt() * SIGMA
}

/// Plain least squares on all redundant parameters, as a paper would: one step
/// with the pseudo-inverse, nothing cut off. Its state and the norm of its
/// corrections in tolerances.
fn plain_least_squares(robot: &Robot, data: &Measurements) -> (State, f64) {
    let problem = Problem::new(data, robot, Scaling::Prior);
    let state = register(data, &robot.nominal(), robot.tool).unwrap();
    let at = problem.linearise(&state);
    let (n, rows) = (problem.unknowns.list().len(), data.rows.len());
    let (mut a, mut b) = (DMatrix::zeros(3 * rows, n), DVector::zeros(3 * rows));
    for i in 0..rows {
        let e = at.equations(i);
        a.rows_mut(3 * i, 3).copy_from(&e.block);
        b.rows_mut(3 * i, 3).copy_from(&e.scaled_residual().column());
    }
    let step = at.to_si(&a.svd(true, true).solve(&b, 0.0).unwrap());
    let moved = state.stepped(&problem.unknowns, &step);
    let norm = problem.corrections(&moved).norm();
    (moved, norm)
}

#[test]
fn identification_reaches_the_cramer_rao_bound() {
    let robot = robot(UR10_LIKE);
    let rules = [
        LambdaRule::default(),
        LambdaRule::MaximumAPosteriori,
        LambdaRule::TwoStep,
        LambdaRule::LCurve,
    ];
    let mut ratios = vec![Vec::new(); rules.len()];
    let (mut plain, mut plain_norm, mut norm) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..100 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = Truth::draw(&robot, 1, 1, &mut rng);
        let data = truth.parse(&truth.measure(52, SIGMA, &mut rng));
        let check = truth.parse(&truth.measure(250, 0.0, &mut rng));
        let bound = cramer_rao(27, &robot, &data, &check, &truth);
        for (rule, ratios) in rules.iter().zip(&mut ratios) {
            let options = Options { rule: *rule, ..Options::default() };
            let found = identify(&robot, &data, &options, &|_, _| ()).unwrap();
            assert_eq!(found.figures.rank, 27);
            assert!(found.figures.outlier_rows.is_empty(), "seed {seed}");
            ratios.push(rms(&robot, &state_of(&found, &check), &check) / bound);
            if *rule == LambdaRule::default() {
                norm.push(found.figures.correction_norm);
            }
        }
        let (state, corrections) = plain_least_squares(&robot, &data);
        plain.push(rms(&robot, &state, &check) / bound);
        plain_norm.push(corrections);
    }
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let worst = |v: &[f64]| v.iter().copied().fold(0.0, f64::max);
    println!("RMS on 250 noise-free poses over that seed's Cramer-Rao prediction, 100 seeds:");
    for (rule, r) in rules.iter().zip(&ratios) {
        println!("  {}: mean {:.3}, worst {:.3}", rule.name(), mean(r), worst(r));
    }
    println!("  its corrections: {:.1} tolerances in norm (median)", median(&norm));
    println!(
        "  plain least squares, 39 parameters: median {:.2e}, corrections {:.2e} tolerances",
        median(&plain),
        median(&plain_norm)
    );
    assert!(mean(&ratios[0]) <= 1.05);
    // The comparison is one: without regularisation the redundant set explodes.
    assert!(median(&plain_norm) > 100.0 * median(&norm));
}

#[test]
fn stations_and_markers_have_their_own_frames() {
    let robot = robot(UR10_LIKE);
    for seed in 0..10 {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
        let truth = Truth::draw(&robot, 3, 2, &mut rng);
        let data = truth.parse(&truth.measure(90, SIGMA, &mut rng));
        let check = truth.parse(&truth.measure(250, 0.0, &mut rng));
        let found = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap();
        assert_eq!(found.figures.parameters, 30 + 3 * 6 + 2 * 3);
        assert_eq!(found.figures.rows_not_cross_validated, 0);
        let bound = cramer_rao(found.figures.rank, &robot, &data, &check, &truth);
        let ratio = rms(&robot, &state_of(&found, &check), &check) / bound;
        println!("seed {seed}: rank {}, ratio {ratio:.3}", found.figures.rank);
        assert!(ratio < 1.6, "{ratio}");
    }
}

#[test]
fn a_prismatic_joint_is_identified() {
    let robot = robot(ON_RAIL);
    for seed in 0..10 {
        let mut rng = ChaCha8Rng::seed_from_u64(2000 + seed);
        let truth = Truth::draw(&robot, 1, 1, &mut rng);
        let data = truth.parse(&truth.measure(80, SIGMA, &mut rng));
        let check = truth.parse(&truth.measure(250, 0.0, &mut rng));
        let found = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap();
        let bound = cramer_rao(found.figures.rank, &robot, &data, &check, &truth);
        let ratio = rms(&robot, &state_of(&found, &check), &check) / bound;
        println!("seed {seed}: rank {}, ratio {ratio:.3}", found.figures.rank);
        assert!(ratio < 1.6, "{ratio}");
    }
}

/// Rows with gross errors in single coordinates, up to a tenth of all.
#[test]
fn gross_errors_are_flagged_and_no_other_row() {
    let robot = robot(UR10_LIKE);
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(3000 + seed);
        let truth = Truth::draw(&robot, 1, 1, &mut rng);
        let text = truth.measure(60, SIGMA, &mut rng);
        let mut data = truth.parse(&text);
        let wrong = [3, 17, 18, 40, 41, 59];
        for (k, row) in wrong.iter().enumerate() {
            data.rows[*row].measured[k % 3] += [0.4e-3, -1e-3, 10e-3, -0.1, 3.0, 0.5e-3][k];
        }
        let found = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap();
        let flagged: Vec<usize> = found.figures.outliers.iter().map(|o| o.row - 1).collect();
        assert_eq!(flagged, wrong, "seed {seed}");
        for (k, o) in found.figures.outliers.iter().enumerate() {
            assert_eq!(o.coordinates, [["x", "y", "z"][k % 3]]);
        }
    }
}
