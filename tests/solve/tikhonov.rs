//! Fixed-size Tikhonov solves against nalgebra's SVD.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::solve::{NormalEquations, Solution, SolveError, StreamingTikhonov, Triangle};

const P: usize = 7;

struct Problem {
    u: DMatrix<f64>,
    s: DVector<f64>,
    scale: [f64; P],
}

/// `rank` independent columns, the others combinations of them.
fn problem(seed: u64, rows: usize, rank: usize) -> Problem {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let left = DMatrix::from_fn(rows, rank, |_, _| rng.random_range(-1.0..1.0));
    let right = DMatrix::from_fn(rank, P, |_, _| rng.random_range(-1.0..1.0));
    let u = left * right;
    let s = DVector::from_fn(rows, |_, _| rng.random_range(-1.0..1.0));
    Problem { u, s, scale: core::array::from_fn(|k| 10_f64.powi(k as i32 - 3)) }
}

/// The definition: stack sqrt(lambda)/scale under U and solve by SVD.
fn reference(p: &Problem, lambda: f64) -> DVector<f64> {
    let rows = p.u.nrows();
    let mut stacked = DMatrix::zeros(rows + P, P);
    stacked.view_mut((0, 0), (rows, P)).copy_from(&p.u);
    let mut rhs = DVector::zeros(rows + P);
    rhs.rows_mut(0, rows).copy_from(&p.s);
    for k in 0..P {
        stacked[(rows + k, k)] = lambda.sqrt() / p.scale[k];
    }
    // Scale the columns, so that the SVD sees a well-scaled matrix.
    for k in 0..P {
        stacked.column_mut(k).scale_mut(p.scale[k]);
    }
    let y = stacked.svd(true, true).solve(&rhs, 1e-14).unwrap();
    DVector::from_fn(P, |k, _| y[k] * p.scale[k])
}

fn solve(p: &Problem, lambda: f64) -> [Solution<f64, P>; 2] {
    let mut normal = NormalEquations::<f64, P>::new();
    let mut triangle = Triangle::<f64, P>::new();
    for i in 0..p.u.nrows() {
        let row = core::array::from_fn(|k| p.u[(i, k)]);
        normal.push(&row, p.s[i]).unwrap();
        triangle.push(&row.map(|a| [a]), &[p.s[i]]).unwrap();
    }
    [normal.solve(lambda, &p.scale).unwrap(), triangle.solve(lambda, &p.scale).unwrap()]
}

#[test]
fn both_solvers_agree_with_the_definition() {
    for seed in 0..20 {
        for lambda in [1e-2, 1.0, 100.0] {
            let p = problem(seed, 30, P);
            let expected = reference(&p, lambda);
            for solution in solve(&p, lambda) {
                for k in 0..P {
                    let error = (solution.x[k] - expected[k]).abs() / p.scale[k];
                    assert!(error < 1e-9, "seed {seed} lambda {lambda} x{k}: {error:e}");
                }
                let rest = (&p.u * &expected - &p.s).norm_squared();
                assert!((solution.residual_square - rest).abs() < 1e-9 * p.s.norm_squared());
                assert_eq!(solution.dropped, 0);
            }
        }
    }
}

#[test]
fn a_rank_deficient_set_is_reported_not_divided_by_noise() {
    let p = problem(5, 30, 4);
    for solution in solve(&p, 0.0) {
        assert_eq!(solution.dropped, 3, "{solution:?}");
        // Still a least-squares solution: the residual is the smallest there is.
        let best = p.u.clone().svd(true, true).solve(&p.s, 1e-10).unwrap();
        let best = (&p.u * best - &p.s).norm_squared();
        let x = DVector::from_row_slice(&solution.x);
        assert!(((&p.u * x - &p.s).norm_squared() - best).abs() < 1e-6 * p.s.norm_squared());
    }
    for solution in solve(&p, 1e-6) {
        assert_eq!(solution.dropped, 0);
    }
}

/// Columns that differ by 1e-7: the normal equations lose them, QR does not.
#[test]
fn the_triangle_solves_what_the_normal_equations_cannot() {
    let mut normal = NormalEquations::<f64, 2>::new();
    let mut triangle = Triangle::<f64, 2>::new();
    for i in 0..10 {
        let t = f64::from(i);
        let row = [1.0, 1.0 + 1e-7 * t];
        let rhs = row[0] * 2.0 + row[1] * 3.0;
        normal.push(&row, rhs).unwrap();
        triangle.push(&row.map(|a| [a]), &[rhs]).unwrap();
    }
    let by_qr = triangle.solve(0.0, &[1.0; 2]).unwrap();
    assert!((by_qr.x[1] - 3.0).abs() < 1e-6, "{by_qr:?}");
    let by_normal = normal.solve(0.0, &[1.0; 2]).unwrap();
    assert!((by_normal.x[1] - 3.0).abs() > 10.0 * (by_qr.x[1] - 3.0).abs());
}

#[test]
fn three_rows_at_once_equal_one_by_one() {
    let p = problem(9, 30, P);
    let mut blocks = Triangle::<f64, P>::new();
    for i in (0..30).step_by(3) {
        let columns = core::array::from_fn(|k| [p.u[(i, k)], p.u[(i + 1, k)], p.u[(i + 2, k)]]);
        blocks.push(&columns, &[p.s[i], p.s[i + 1], p.s[i + 2]]).unwrap();
    }
    let [_, single] = solve(&p, 0.5);
    let block = blocks.solve(0.5, &p.scale).unwrap();
    for k in 0..P {
        assert!((single.x[k] - block.x[k]).abs() < 1e-11 * p.scale[k]);
    }
}

#[test]
fn bad_input_is_an_error_value() {
    let mut n = NormalEquations::<f64, 2>::new();
    let mut t = Triangle::<f64, 2>::new();
    n.push(&[1.0, 2.0], 1.0).unwrap();
    t.push(&[[1.0], [2.0]], &[1.0]).unwrap();
    assert_eq!(n.solve(-1.0, &[1.0; 2]), Err(SolveError::BadLambda));
    assert_eq!(t.solve(f64::NAN, &[1.0; 2]), Err(SolveError::BadLambda));
    assert_eq!(n.solve(1.0, &[1.0, 0.0]), Err(SolveError::BadScale { parameter: 1 }));
    let before = (n, t);
    assert_eq!(n.push(&[f64::NAN, 2.0], 1.0), Err(SolveError::NotFinite));
    assert_eq!(n.push(&[1.0, 2.0], f64::NEG_INFINITY), Err(SolveError::NotFinite));
    assert_eq!(n.push(&[1e160, 2.0], 1.0), Err(SolveError::Overflow));
    assert_eq!(t.push(&[[1.0], [1e160]], &[1.0]), Err(SolveError::Overflow));
    assert_eq!(t.push(&[[f64::NAN], [2.0]], &[1.0]), Err(SolveError::NotFinite));
    assert_eq!(t.push(&[[1.0], [2.0]], &[f64::INFINITY]), Err(SolveError::NotFinite));
    assert_eq!(t.push_weighted(&[[1.0], [2.0]], &[1.0], -1.0), Err(SolveError::NotFinite));
    assert_eq!((n, t), before);
}

/// Nothing that is no number is inside.
fn sound(state: impl core::fmt::Debug) -> bool {
    let text = format!("{state:?}");
    !text.contains("inf") && !text.contains("NaN")
}

/// What a triangle takes it holds: it says so before a sum overflows.
#[test]
fn many_large_rows_are_refused_before_they_overflow() {
    let mut triangle = Triangle::<f32, 3>::new();
    let mut normal = NormalEquations::<f32, 3>::new();
    let mut stream = StreamingTikhonov::<f32, 3>::new(4, 1.0).unwrap();
    let mut refused = [0; 3];
    for k in 0..100 {
        let row = [1e14, -2e14, k as f32 * 1e13];
        let (columns, rhs) = (row.map(|a| [a]), 3e14);
        let before = (triangle, normal, stream);
        let pushed = [
            triangle.push(&columns, &[rhs]),
            normal.push(&row, rhs),
            stream.push(&columns, &[rhs]).map(|_| ()),
        ];
        assert!(sound((triangle, normal, stream)), "row {k}");
        for (refused, pushed) in refused.iter_mut().zip(pushed) {
            *refused += usize::from(pushed == Err(SolveError::Overflow));
        }
        if pushed[0].is_err() {
            assert_eq!((triangle, normal), (before.0, before.1));
        }
        if pushed[2].is_err() {
            assert_eq!(stream, before.2);
        }
    }
    assert!(refused.iter().all(|r| (1..100).contains(r)), "{refused:?}");
    // Two that hold as much as there is room for.
    let before = triangle;
    assert_eq!(triangle.absorb(&before), Err(SolveError::Overflow));
    assert_eq!(triangle, before);
}

/// A parameter without penalty, by both solvers and by the definition.
#[test]
fn an_infinite_scale_is_no_penalty() {
    for seed in 0..20 {
        let mut p = problem(seed, 30, P);
        for free in [vec![0], vec![3], vec![1, 6], (0..P).collect()] {
            for k in &free {
                p.scale[*k] = f64::INFINITY;
            }
            let [normal, triangle] = solve(&p, 0.3);
            let h = p.u.transpose() * &p.u
                + DMatrix::from_fn(
                    P,
                    P,
                    |i, j| if i == j { 0.3 / p.scale[i].powi(2) } else { 0.0 },
                );
            let expected = h.lu().solve(&(p.u.transpose() * &p.s)).unwrap();
            for solution in [normal, triangle] {
                for k in 0..P {
                    let error = (solution.x[k] - expected[k]).abs();
                    assert!(error < 1e-9 * expected[k].abs().max(1e-3), "{free:?} {k}: {error:e}");
                }
            }
            assert_eq!((normal.dropped, triangle.dropped), (0, 0));
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * p.s.norm_squared().max(a);
            assert!(close(normal.norm_square, triangle.norm_square), "{normal:?} {triangle:?}");
            assert!(close(normal.residual_square, triangle.residual_square));
        }
    }
}

/// Finite numbers of every size, zeros among them.
fn any_size() -> impl Strategy<Value = f32> {
    let sized = (-44.0..38.0_f32, prop::bool::ANY).prop_map(|(exponent, negative)| {
        if negative { -10_f32.powf(exponent) } else { 10_f32.powf(exponent) }
    });
    prop_oneof![4 => sized, 1 => Just(0.0_f32), 2 => -10.0..10.0_f32]
}

proptest! {
    /// Rows of any size, given in any order and weight.
    #[test]
    fn what_was_taken_is_finite(
        rows in prop::collection::vec((prop::array::uniform5(any_size()), any_size()), 1..20),
        together in prop::bool::ANY,
    ) {
        let mut triangle = Triangle::<f32, 4>::new();
        let mut normal = NormalEquations::<f32, 4>::new();
        for ([a, b, c, d, rhs], weight) in rows {
            let before = (triangle, normal);
            let columns = [a, b, c, d].map(|v| [v, v * 0.3, d]);
            let pushed = if together {
                triangle.push_weighted(&columns, &[rhs, a, b], weight.abs())
            } else {
                triangle.push(&columns, &[rhs, a, b])
            };
            let added = normal.push(&[a, b, c, d], rhs);
            prop_assert!(sound((triangle, normal)), "{:?} {:?}", triangle, normal);
            prop_assert!(pushed.is_ok() || triangle == before.0);
            prop_assert!(added.is_ok() || normal == before.1);
        }
        let before = triangle;
        let absorbed = triangle.absorb(&before);
        prop_assert!(sound(triangle), "{:?}", triangle);
        prop_assert!(absorbed.is_ok() || triangle == before);
    }

    #[test]
    fn any_lambda_gives_the_minimum(seed in 0_u64..1000, exponent in -6.0..6.0_f64, rank in 1..=P) {
        let lambda = 10_f64.powf(exponent);
        let p = problem(seed, 24, rank);
        let cost = |x: &[f64]| {
            let rest = (&p.u * DVector::from_row_slice(x) - &p.s).norm_squared();
            rest + lambda * x.iter().zip(&p.scale).map(|(x, s)| (x / s).powi(2)).sum::<f64>()
        };
        for solution in solve(&p, lambda) {
            let here = cost(&solution.x);
            for k in 0..P {
                for step in [-1e-3, 1e-3] {
                    let mut x = solution.x;
                    x[k] += step * p.scale[k];
                    prop_assert!(cost(&x) >= here - 1e-9 * here);
                }
            }
        }
    }
}
