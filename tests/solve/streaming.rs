//! Identification one point at a time: against dense SVD, in both precisions,
//! on identifiable and redundant problems.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Scalar;
use truearm::solve::{Memory, SolveError, Spectrum, StreamingTikhonov, Triangle, most_parameters};

const P: usize = 30;

/// Points of three rows with known solution: `A = left * diag * rotation`.
struct Problem {
    a: DMatrix<f64>,
    b: DVector<f64>,
}

/// Random rows whose columns are mixed so that the singular values fall evenly
/// on a log scale to `1 / condition`, `rank` of them. The noise has `sigma` times
/// the length of the right-hand side: 0.02 mm of a correction of 1 mm is 2e-2.
fn problem(seed: u64, points: usize, condition: f64, rank: usize, sigma: f64) -> Problem {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform =
        |r: usize, c: usize| DMatrix::from_fn(r, c, |_, _| rng.random_range(-1.0..1.0));
    let mixing = uniform(P, P).qr().q();
    // Orthogonal columns: the condition is exactly the given one.
    let left = uniform(3 * points, P).qr().q();
    let (x, noise) = (uniform(P, 1), uniform(3 * points, 1));
    let spread = DVector::from_fn(P, |k, _| {
        if k < rank { condition.powf(-(k as f64) / (rank as f64 - 1.0)) } else { 0.0 }
    });
    let a = left * DMatrix::from_diagonal(&spread) * mixing.transpose();
    let b = &a * x.column(0);
    let noise = noise.column(0) * (sigma * b.norm() / noise.norm());
    let b = b + noise;
    Problem { a, b }
}

impl Problem {
    fn points<T: Scalar>(&self) -> impl Iterator<Item = ([[T; 3]; P], [T; 3])> {
        (0..self.a.nrows() / 3).map(|i| {
            let row = |m: usize| 3 * i + m;
            let columns = core::array::from_fn(|k| {
                core::array::from_fn(|m| T::from_f64(self.a[(row(m), k)]))
            });
            (columns, core::array::from_fn(|m| T::from_f64(self.b[row(m)])))
        })
    }

    fn triangle<T: Scalar>(&self) -> Triangle<T, P> {
        let mut stream = StreamingTikhonov::new(0, T::ONE).unwrap();
        for (columns, rhs) in self.points() {
            stream.push(&columns, &rhs).unwrap();
        }
        *stream.fitted().unwrap()
    }

    /// By definition: SVD of the stacked matrix.
    fn reference(&self, lambda: f64) -> DVector<f64> {
        let n = self.a.nrows();
        let mut stacked = DMatrix::zeros(n + P, P);
        stacked.rows_mut(0, n).copy_from(&self.a);
        (0..P).for_each(|k| stacked[(n + k, k)] = lambda.sqrt());
        let mut rhs = DVector::zeros(n + P);
        rhs.rows_mut(0, n).copy_from(&self.b);
        let r = stacked.clone().qr();
        let (q, r) = (r.q(), r.r());
        r.svd(true, true).solve(&(q.transpose() * rhs), 1e-12).unwrap()
    }

    fn largest_square(&self) -> f64 {
        (self.a.transpose() * &self.a).symmetric_eigen().eigenvalues.max()
    }
}

fn difference<T: Scalar>(x: &[T; P], expected: &DVector<f64>) -> f64 {
    let x = DVector::from_fn(P, |k, _| x[k].to_f64());
    (x - expected).norm() / expected.norm()
}

/// Both ways to a solution, for `points` points.
fn compare<T: Scalar>(p: &Problem, lambda: f64, tolerance: f64) {
    let expected = p.reference(lambda);
    let triangle = p.triangle::<T>();
    let scale = [T::ONE; P];
    let solution = triangle.solve(T::from_f64(lambda), &scale).unwrap();
    let points = p.a.nrows() / 3;
    let error = difference(&solution.x, &expected);
    println!("{points} points, lambda {lambda:e}: solve {error:e}");
    assert!(error < tolerance, "{points} points: {error:e}");
    let spectrum = triangle.spectrum(&scale).unwrap();
    let error = difference(&spectrum.solve(T::from_f64(lambda)).unwrap(), &expected);
    println!("    spectrum {error:e}");
    assert!(error < tolerance, "{points} points by the spectrum: {error:e}");
    let rest = (&p.a * &expected - &p.b).norm_squared();
    for square in [solution.residual_square, spectrum.residual_square(T::from_f64(lambda))] {
        let error = (square.to_f64() - rest).abs();
        let share = T::EPSILON.to_f64() * 100.0;
        assert!(error <= tolerance * rest + share * p.b.norm_squared(), "residual {square} {rest}");
    }
    let norm = spectrum.norm_square(T::from_f64(lambda)).to_f64();
    assert!((norm / expected.norm_squared() - 1.0).abs() < 2.0 * tolerance);
}

#[test]
fn equals_the_batch_solution_in_f64() {
    for points in [10, 100, 10_000] {
        compare::<f64>(&problem(1, points, 1e3, P, 2e-2), 0.0, 1e-9);
        let redundant = problem(2, points, 1e3, 22, 2e-2);
        compare::<f64>(&redundant, 1e-6 * redundant.largest_square(), 1e-9);
    }
}

#[test]
fn equals_the_batch_solution_in_f32() {
    for seed in 1..=5 {
        for points in [10, 100, 10_000] {
            compare::<f32>(&problem(seed, points, 1e3, P, 2e-2), 0.0, 1e-4);
            let redundant = problem(seed, points, 1e3, 22, 2e-2);
            compare::<f32>(&redundant, 1e-6 * redundant.largest_square(), 1e-4);
        }
    }
}

/// Columns that repeat earlier ones: the residual is the least there is, but
/// for a row's worth a column of 600.
fn a_dependent_column_costs_little<T: Scalar>(tolerance: f64) {
    let mut p = problem(7, 200, 10.0, P, 1e-3);
    for k in [3, 4, 17] {
        let copy = p.a.column(k - 1) * 0.7 + p.a.column(k - 2) * 0.2;
        p.a.set_column(k, &copy);
    }
    let triangle = p.triangle::<T>();
    assert_eq!(triangle.spectrum(&[T::ONE; P]).unwrap().rank(), P - 3);
    let solution = triangle.solve(T::ZERO, &[T::ONE; P]).unwrap();
    assert_eq!(solution.dropped, 3);
    let x = DVector::from_fn(P, |k, _| solution.x[k].to_f64());
    let least = {
        let x = p.a.clone().svd(true, true).solve(&p.b, 1e-9).unwrap();
        (&p.a * x - &p.b).norm()
    };
    let here = (&p.a * x - &p.b).norm();
    assert!(here / least - 1.0 < tolerance, "{here:e} {least:e}");
}

#[test]
fn dependent_columns_are_dropped_alone() {
    a_dependent_column_costs_little::<f64>(3.0 / 600.0);
    a_dependent_column_costs_little::<f32>(3.0 / 600.0);
}

#[test]
fn every_third_point_judges_and_is_not_fitted() {
    let p = problem(5, 90, 100.0, P, 1e-2);
    let mut stream = StreamingTikhonov::<f64, P>::new(3, 1.0).unwrap();
    let (mut fitted, mut judging) = (Triangle::new(), Triangle::new());
    for (i, (columns, rhs)) in p.points().enumerate() {
        assert_eq!(stream.push(&columns, &rhs), Ok(i % 3 == 2));
        if i % 3 == 2 { &mut judging } else { &mut fitted }.push(&columns, &rhs).unwrap();
    }
    assert_eq!(stream.points(), 90);
    assert_eq!(stream.held_out(), &judging);
    let x = fitted.solve(0.3, &[1.0; P]).unwrap().x;
    let x = DVector::from_row_slice(&x);
    let fitted = *stream.fitted().unwrap();
    assert!(difference(&fitted.solve(0.3, &[1.0; P]).unwrap().x, &x) < 1e-10);
    let scale = [1.0; P];
    let all = stream.all().unwrap().solve(0.3, &scale).unwrap();
    assert!(difference(&all.x, &p.reference(0.3)) < 1e-10);
    let choice = stream.choose(&scale).unwrap();
    let two_step = choice.two_step.unwrap();
    // Nothing on a fine grid judges much better than what the two steps found.
    let spectrum = fitted.spectrum(&scale).unwrap();
    let held_out = |lambda: f64| judging.residual_square(&spectrum.solve(lambda).unwrap());
    assert_eq!(choice.held_out_square, held_out(two_step));
    for k in -90..=40 {
        let lambda = choice.l_curve.unwrap() * 10_f64.powf(f64::from(k) / 10.0);
        assert!(choice.held_out_square < held_out(lambda) * 1.01, "{lambda:e} {two_step:e}");
    }
}

#[test]
fn old_points_fade() {
    let (old, new) = (problem(1, 400, 10.0, P, 0.0), problem(2, 400, 10.0, P, 0.0));
    let mut stream = StreamingTikhonov::<f64, P>::new(0, 0.95).unwrap();
    for (columns, rhs) in old.points().chain(new.points()) {
        stream.push(&columns, &rhs).unwrap();
    }
    let x = stream.fitted().unwrap().solve(0.0, &[1.0; P]).unwrap().x;
    assert!(difference(&x, &new.reference(0.0)) < 1e-5);
    // Weighted by definition: 0.95 to the power of the point's age.
    let (n, count) = (400, 800);
    let weight = |i: usize| 0.95_f64.powi((count - 1 - i) as i32);
    let mut h = DMatrix::zeros(P, P);
    for (p, first) in [(&old, 0), (&new, n)] {
        for i in 0..n {
            let block = p.a.rows(3 * i, 3);
            h += block.transpose() * block * weight(first + i);
        }
    }
    let variance = stream.fitted().unwrap().variances(0.0, &[1.0; P]).unwrap();
    let expected = h.try_inverse().unwrap();
    for k in 0..P {
        assert!((variance[k] / expected[(k, k)] - 1.0).abs() < 1e-6);
    }
    assert_eq!(StreamingTikhonov::<f64, P>::new(0, 0.0), Err(SolveError::BadForgetting));
    for factor in [f64::NAN, 1.1, f64::MIN_POSITIVE / 1e3] {
        assert_eq!(StreamingTikhonov::<f64, P>::new(0, factor), Err(SolveError::BadForgetting));
    }
}

#[test]
fn a_bad_point_changes_nothing() {
    let p = problem(5, 20, 100.0, P, 1e-2);
    let mut stream = StreamingTikhonov::<f32, P>::new(3, 0.9).unwrap();
    p.points::<f32>().for_each(|(columns, rhs)| assert!(stream.push(&columns, &rhs).is_ok()));
    let before = stream;
    for (bad, error) in [
        (f32::NAN, SolveError::NotFinite),
        (f32::INFINITY, SolveError::NotFinite),
        (f32::MAX, SolveError::Overflow),
    ] {
        let mut columns = [[1.0; 3]; P];
        columns[11][1] = bad;
        assert_eq!(stream.push(&columns, &[0.0; 3]), Err(error));
        assert_eq!(stream.push(&[[1.0; 3]; P], &[0.0, 0.0, bad]), Err(error));
    }
    assert_eq!(stream, before);
}

/// The layout of the structs on a controller, whose pointers have 4 bytes.
#[test]
fn memory_is_what_the_structs_take() {
    fn check<T: Scalar, const N: usize>() {
        let (scalar, pointer) = (size_of::<T>(), size_of::<usize>());
        let memory = Memory::of(N, scalar);
        assert_eq!(memory.state.next_multiple_of(scalar), size_of::<StreamingTikhonov<T, N>>());
        let spectrum = size_of::<Spectrum<T, N>>() - 3 * pointer;
        assert!(spectrum <= memory.workspace && size_of::<Triangle<T, N>>() <= memory.workspace);
    }
    check::<f32, 5>();
    check::<f32, 30>();
    check::<f32, 40>();
    check::<f64, 9>();
    check::<f64, 40>();
    // As the documentation says.
    let documented = [(10, 4), (40, 8)].map(|(p, b)| Memory::of(p, b));
    assert_eq!(documented.map(|m| (m.state, m.workspace)), [(1604, 2736), (41352, 46960)]);
    let most = [(64, 4), (64, 8), (32, 4), (32, 8)].map(|(k, b)| most_parameters(k * 1024, b));
    assert_eq!(most, [40, 34, 33, 23]);
    for ram in (0..40_000).step_by(100) {
        for scalar in [4, 8] {
            let most = most_parameters(ram, scalar);
            assert!(most == 0 || Memory::of(most, scalar).total() <= ram);
            assert!(most == 40 || Memory::of(most + 1, scalar).total() > ram);
        }
    }
}

/// Numbers of every size, ordinary ones more often.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -10.0..10.0_f32,
        1 => any::<f32>(),
        1 => Just(0.0_f32),
        1 => (-44.0..38.0_f32).prop_map(|e| 10_f32.powf(e)),
    ]
}

proptest! {
    #[test]
    fn whatever_comes_in_no_nan_comes_out(
        points in prop::collection::vec(prop::array::uniform(number()), 1..12),
        scale in prop::array::uniform4(number()),
        lambda in number(),
        forgetting in 0.1..=1.0_f32,
    ) {
        let mut stream = StreamingTikhonov::<f32, 4>::new(3, forgetting).unwrap();
        for point in points {
            let point: [f32; 15] = point;
            let columns = core::array::from_fn(|k| [point[3 * k], point[3 * k + 1], point[3 * k + 2]]);
            let rhs = [point[12], point[13], point[14]];
            let pushed = stream.push(&columns, &rhs);
            if point.iter().any(|v| !v.is_finite()) {
                prop_assert_eq!(pushed, Err(SolveError::NotFinite));
            }
            let held = format!("{stream:?}");
            prop_assert!(!held.contains("inf") && !held.contains("NaN"), "{}", held);
        }
        let Ok(fitted) = stream.fitted().copied() else { return Ok(()) };
        if let Ok(s) = fitted.solve(lambda, &scale) {
            let all = s.x.iter().chain([&s.residual_square, &s.norm_square]);
            prop_assert!(all.clone().all(|v| v.is_finite()), "{:?}", s);
        }
        if let Ok(v) = fitted.variances(lambda, &scale) {
            prop_assert!(v.iter().all(|v| !v.is_nan()), "{:?}", v);
        }
        if let Ok(choice) = stream.choose(&scale) {
            let all = [choice.l_curve, choice.two_step, Some(choice.held_out_square)];
            prop_assert!(all.iter().flatten().all(|v| v.is_finite()), "{:?}", choice);
        }
        if let Ok(x) = fitted.spectrum(&scale).and_then(|s| s.solve(1.0)) {
            prop_assert!(x.iter().all(|v| v.is_finite()));
        }
    }
}

/// As found: where no lambda could be judged, as here what is held out is beyond all numbers by
/// each, the choice was none at all, and the solve went without a penalty.
#[test]
fn where_no_lambda_can_be_judged_none_is_chosen() {
    let mut stream = StreamingTikhonov::<f32, 1>::new(2, 1.0).unwrap();
    for _ in 0..4 {
        stream.push(&[[1e-14]], &[1.0]).unwrap();
        stream.push(&[[1e8]], &[0.0]).unwrap();
    }
    let choice = stream.choose(&[1.0]).unwrap();
    assert!(choice.two_step.is_none(), "{choice:?}");
}

#[test]
fn a_factor_that_is_none_forgets_nothing() {
    let mut triangle = Triangle::<f64, 2>::new();
    triangle.push(&[[1.0, 0.5], [0.2, 3.0]], &[1.0, -1.0]).unwrap();
    let before = triangle;
    for factor in [-1.0, -1e-300, 1.0 + f64::EPSILON, 2.0, f64::NAN, f64::INFINITY, 1.0] {
        triangle.forget(factor);
        assert_eq!(triangle, before, "{factor}");
    }
    triangle.forget(0.5);
    assert!(triangle.residual_square(&[0.0; 2]) < before.residual_square(&[0.0; 2]));
}
