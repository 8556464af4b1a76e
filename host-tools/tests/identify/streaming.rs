//! The controller's streaming identification against the host's batch
//! Tikhonov, on the linearised calibration of a simulated arm: the same
//! solutions, the same corner of the L-curve.

use crate::simulated::{Truth, UR10_LIKE, robot};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm::Scalar;
use truearm::solve::{StreamingTikhonov, Triangle};
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Problem, Scaling};
use truearm_host::tikhonov;

/// 6 of the station, 3 of the marker, 30 of the links: rank 27.
const P: usize = 39;
const FREE: usize = 9;

/// The stacked equations of a calibration, linearised at registration. Lambda
/// weighs tolerances, or metres and radians.
fn equations(seed: u64, poses: usize, scaling: Scaling) -> (DMatrix<f64>, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let robot = robot(UR10_LIKE);
    let truth = Truth::draw(&robot, 1, 1, &mut rng);
    let data = truth.parse(&truth.measure(poses, 2e-5, &mut rng));
    let problem = Problem::new(&data, &robot, scaling);
    let start = register(&data, &problem.nominal, robot.tool).unwrap();
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let metres = problem.scale(0)[0];
    (problem.linearise(&start).rows(&rows, None), metres)
}

fn stream<T: Scalar>(rows: &DMatrix<f64>) -> Triangle<T, P> {
    let mut stream = StreamingTikhonov::<T, P>::new(0, T::ONE).unwrap();
    for i in 0..rows.nrows() / 3 {
        let cell =
            |k: usize| -> [T; 3] { core::array::from_fn(|m| T::from_f64(rows[(3 * i + m, k)])) };
        stream.push(&core::array::from_fn(cell), &cell(P)).unwrap();
    }
    *stream.fitted().unwrap()
}

/// Free unknowns are not penalised, the others by one unit.
fn scale<T: Scalar>() -> [T; P] {
    core::array::from_fn(|k| if k < FREE { T::ONE / T::ZERO } else { T::ONE })
}

fn relative<T: Scalar>(x: &[T; P], expected: &DVector<f64>) -> f64 {
    let x = DVector::from_fn(P, |k, _| x[k].to_f64());
    (x - expected).norm() / expected.norm()
}

/// Largest distance between the tool points that two solutions predict, m.
fn apart<T: Scalar>(rows: &DMatrix<f64>, metres: f64, x: &[T; P], y: &DVector<f64>) -> f64 {
    let difference = DVector::from_fn(P, |k, _| x[k].to_f64() - y[k]);
    let moved = rows.columns(0, P) * difference * metres;
    (0..moved.len() / 3).map(|i| moved.rows(3 * i, 3).norm()).fold(0.0, f64::max)
}

#[test]
fn streaming_equals_batch() {
    for poses in [10, 100, 10_000] {
        let (rows, metres) = equations(1, poses, Scaling::Prior);
        let host = tikhonov::Factorised::new(&tikhonov::Triangle::new(&rows), FREE);
        let largest = host.singular_values()[0].powi(2);
        let (in_f64, in_f32) = (stream::<f64>(&rows), stream::<f32>(&rows));
        for lambda in [1e-6 * largest, 1.0_f64.max(1e-6 * largest), 1e-2 * largest] {
            let expected = host.solve(lambda);
            let x = in_f64.solve(lambda, &scale()).unwrap();
            let error = relative(&x.x, &expected);
            println!("{poses} poses, lambda {lambda:.3e}: f64 {error:.1e}");
            assert!(error < 1e-9);
            let scale64 = scale();
            let spectrum = in_f64.spectrum(&scale64).unwrap();
            assert!(relative(&spectrum.solve(lambda).unwrap(), &expected) < 1e-9);
            let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-8;
            assert!(close(spectrum.residual_square(lambda), host.residual_square(lambda)));
            assert!(close(spectrum.norm_square(lambda), host.norm_square(lambda)));
            let x = in_f32.solve(lambda as f32, &scale()).unwrap();
            let distance = apart(&rows, metres, &x.x, &expected);
            println!("    f32 {:.1e}, {:.3} um", relative(&x.x, &expected), distance * 1e6);
            assert!(distance < 1e-7, "f32 {distance:e}");
        }
    }
}

/// All unknowns penalised, the tracker's and the marker's, too: the redundant
/// set is then as well conditioned as lambda makes it.
#[test]
fn streaming_equals_batch_in_f32() {
    for (seed, poses) in [(1, 10), (2, 100), (3, 10_000), (4, 10), (5, 100), (6, 10_000)] {
        let (rows, _) = equations(seed, poses, Scaling::Prior);
        // The host wants one free unknown: one that does nothing.
        let with_none = rows.clone().insert_column(0, 0.0);
        let host = tikhonov::Factorised::new(&tikhonov::Triangle::new(&with_none), 1);
        let largest = host.singular_values()[0].powi(2);
        let triangle = stream::<f32>(&rows);
        for share in [1e-6, 1e-4, 1e-2] {
            let expected = host.solve(share * largest).remove_row(0);
            let x = triangle.solve((share * largest) as f32, &[1.0; P]).unwrap();
            let error = relative(&x.x, &expected);
            println!("{poses} poses, {share:e} sigma_1^2: {error:.1e}");
            assert!(error < 1e-4, "{error:e}");
        }
    }
}

#[test]
fn both_find_the_same_corner() {
    for seed in 1..=10 {
        for scaling in [Scaling::Prior, Scaling::Printed] {
            let (rows, metres) = equations(seed, 52, scaling);
            let host = tikhonov::Factorised::new(&tikhonov::Triangle::new(&rows), FREE);
            let corner = host.corner().unwrap();
            let expected = host.solve(corner);
            let largest = host.singular_values()[0].powi(2);
            let (triangle, scale) = (stream::<f64>(&rows), scale());
            let spectrum = triangle.spectrum(&scale).unwrap();
            let own = spectrum.corner().unwrap();
            let distance = apart(&rows, metres, &spectrum.solve(own).unwrap(), &expected);
            println!(
                "seed {seed} {scaling:?}: host {:.2e}, own {:.2e} of sigma_1^2, {:.4} um apart",
                corner / largest,
                own / largest,
                distance * 1e6
            );
            assert!(distance < 1e-6, "{distance:e}");
            let (triangle, scale) = (stream::<f32>(&rows), self::scale());
            let spectrum = triangle.spectrum(&scale).unwrap();
            let own = spectrum.corner().unwrap();
            let distance = apart(&rows, metres, &spectrum.solve(own).unwrap(), &expected);
            println!("    f32 {:.2e}, {:.4} um apart", f64::from(own) / largest, distance * 1e6);
            assert!(distance < 1e-6, "f32 {distance:e}");
        }
    }
}
