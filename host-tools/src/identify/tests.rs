//! Short cuts over many rows end where passes over all of them do.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::cross_validation::Parts;
use super::{LambdaRule, Problem, Scaling, State};
use crate::identify::fit::estimate::{Estimate, decided, estimate};
use crate::identify::fit::folds;
use crate::identify::fit::robust::{Flags, RobustFit, from_all, robust_fit, robust_fit_near};
use crate::model::{Measurements, Robot};
use crate::observations::measuring;
use crate::observations::tests::{cell, read, robot, start};

/// So many points, every thousandth a centimetre off.
fn measured(robot: &Robot, points: usize) -> Measurements {
    let cell = cell(robot, &mut ChaCha8Rng::seed_from_u64(11));
    let mut data = read(robot, &cell, &[("point", points)], 12);
    data.rows.iter_mut().step_by(1000).for_each(|row| row.measured[1] += 0.01);
    data
}

/// Largest distance between what two states predict of the rows, in sigmas.
fn apart(problem: &Problem, a: &State, b: &State) -> f64 {
    let [a, b] = [a, b].map(|state| problem.linearise(state));
    let rows = 0..problem.data.rows.len();
    rows.map(|row| (a.scaled_residual(row) - b.scaled_residual(row)).amax()).fold(0.0, f64::max)
}

fn flagged(fit: &RobustFit) -> Vec<usize> {
    fit.outliers.iter().map(|outlier| outlier.row).collect()
}

/// On both sides of the number of poses from which some are fitted first.
#[test]
fn a_fit_that_begins_with_some_rows_ends_where_one_of_all_does() {
    let robot = robot();
    for (points, sampled) in [(4000, false), (4001, true)] {
        let data = measured(&robot, points);
        let problem = Problem::new(&data, &robot, Scaling::Prior);
        let (rows, start) = (measuring(&data.rows), start(&problem, &robot));
        assert_eq!(folds::sample(&data, &rows).is_some(), sampled);
        let some = robust_fit(&problem, &rows, &start, Flags::default()).unwrap();
        let all = from_all(&problem, &rows, &start, Flags::default()).unwrap();
        let expected: Vec<usize> = (0..points).step_by(1000).collect();
        assert_eq!((flagged(&some), flagged(&all)), (expected.clone(), expected));
        let apart = apart(&problem, &some.fit.state, &all.fit.state);
        println!("{points} points: {apart:.1e} sigma apart");
        assert!(apart < 1e-4);
    }
}

/// A marker of a few rows among thousands: they are not left to chance.
#[test]
fn rows_of_a_marker_that_has_few_are_not_sampled() {
    let robot = robot();
    let mut data = measured(&robot, 4100);
    let rows = measuring(&data.rows);
    assert!(folds::sample(&data, &rows).is_some());
    data.markers.push("second".to_owned());
    data.rows[..20].iter_mut().for_each(|row| row.marker = 1);
    assert!(folds::sample(&data, &rows).is_none());
}

/// Where a fold is near the whole its own passes would change nothing that shows;
/// where it is not they are made.
#[test]
fn folds_near_the_whole_need_no_passes() {
    let robot = robot();
    for (points, near) in [(600, false), (6000, true)] {
        let data = measured(&robot, points);
        let problem = Problem::new(&data, &robot, Scaling::Prior);
        let problem = problem.about(&start(&Problem::new(&data, &robot, Scaling::Prior), &robot));
        let (rows, start) = (measuring(&data.rows), start(&problem, &robot));
        let rule = LambdaRule::MaximumLikelihood;
        let whole = estimate(&problem, rule, &rows, &start, false).unwrap();
        let folds = folds::random(&data, &rows, 5);
        let parts = Parts::new(&problem, &whole.fit, &whole.robust, &folds);
        for (k, fold) in folds.iter().enumerate() {
            let found = parts.estimate(k, rule, whole.lambda);
            assert_eq!(found.is_some(), near, "{points} points");
            let Some(found) = found else { continue };
            let from = parts.start(k, 1.0);
            let own = robust_fit_near(&problem, &fold.fit, &from, Flags::default()).unwrap();
            let own: Estimate = decided(&problem, rule, own).unwrap();
            assert_eq!(flagged(&found.robust), flagged(&own.robust));
            assert!(flagged(&own.robust).len() >= points / 1000 - folds.len());
            assert!((found.lambda / own.lambda).ln().abs() < 1e-2);
            let apart = apart(&problem, &found.fit.state, &own.fit.state);
            println!("{points} points, fold {k}: {apart:.1e} sigma apart");
            assert!(apart < 1e-3);
        }
    }
}

/// What a held-out row says has no share in what judges it: a fold whose part is
/// falsified as one, too little for flags, moves by the second order only.
#[test]
fn a_fold_does_not_know_its_part() {
    let robot = robot();
    let data = measured(&robot, 6000);
    let clean = Problem::new(&data, &robot, Scaling::Prior);
    let (rows, start) = (measuring(&data.rows), start(&clean, &robot));
    let folds = folds::random(&data, &rows, 5);
    let mut falsified = data.clone();
    folds[0].held_out.iter().for_each(|row| falsified.rows[*row].measured[2] += 2e-6);
    let rule = LambdaRule::MaximumAPosteriori;
    let found = [&data, &falsified].map(|data| {
        let problem = Problem::new(data, &robot, Scaling::Prior);
        let whole = estimate(&problem, rule, &rows, &start, false).unwrap();
        let parts = Parts::new(&problem, &whole.fit, &whole.robust, &folds);
        let fold = parts.estimate(0, rule, 1.0).expect("the fold is near");
        (whole.fit.state, fold.fit.state)
    });
    let [(whole, fold), (other_whole, other_fold)] = found;
    let [whole, fold] =
        [(whole, other_whole), (fold, other_fold)].map(|(a, b)| apart(&clean, &a, &b));
    println!("the whole moves by {whole:.1e} sigma, the fold without it by {fold:.1e}");
    assert!(whole > 1e-2 && fold < 1e-3 * whole);
}
