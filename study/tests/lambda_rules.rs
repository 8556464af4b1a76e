//! Rules for lambda, all from one factorisation.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::identify::{LambdaRule, Problem, Scaling};
use truearm_host::tikhonov::{Factorised, Triangle};
use truearm_study::regret::{Class, judge, spread};
use truearm_study::simulated::{Truth, UR10_LIKE, normal, robot};

/// Triangles of parts joined, and normal equations of the whole less those of a
/// part, against a factorisation of the other rows.
#[test]
fn held_out_rows_need_no_factorisation_of_their_own() {
    let robot = robot(UR10_LIKE);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let truth = Truth::draw(&robot, 1, 1, &mut rng);
    let data = truth.parse(&truth.measure(40, 2e-5, &mut rng));
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let at = problem.linearise(&truth.state());
    let free = problem.unknowns.free();
    let all: Vec<usize> = (0..40).collect();
    let whole = at.normal(&all, None);
    for held_out in [vec![0], vec![3, 17, 30], (8..24).collect()] {
        let others: Vec<usize> = all.iter().copied().filter(|r| !held_out.contains(r)).collect();
        let without = Factorised::new(&at.triangle(&others, None), free);
        let rows = at.rows(&held_out, None);
        let columns = rows.ncols() - 1;
        let (first, second) = others.split_at(others.len() / 3);
        let parts = [first, &held_out, second].map(|rows| at.triangle(rows, None));
        let joined = Factorised::new(&Triangle::without_each(&parts)[1], free);
        let less = whole.minus(&at.normal(&held_out, None)).unwrap();
        let less = Factorised::of_normal(&less, free);
        for lambda in [1e-2, 1.0, 1e3] {
            let residual =
                |f: &Factorised| rows.column(columns) - rows.columns(0, columns) * f.solve(lambda);
            let expected = residual(&without);
            for (name, found) in [("joined", &joined), ("less", &less)] {
                let wrong = (residual(found) - &expected).norm() / expected.norm();
                println!("{name}, {} rows, lambda {lambda}: {wrong:.1e}", held_out.len());
                assert!(wrong < 1e-6, "{name}, {} rows, lambda {lambda}", held_out.len());
            }
        }
    }
}

/// A problem made of its own singular directions, so that every rule can be
/// written down without a factorisation.
#[test]
fn rules_are_what_their_names_say() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let (m, n) = (60, 12);
    let mut s: Vec<f64> = (0..n).map(|k| 10_f64.powf(2.0 - 0.35 * k as f64)).collect();
    // Two redundant unknowns: their equations hold noise alone.
    s[n - 2..].fill(0.0);
    let mut rows = DMatrix::zeros(m, n + 1);
    let x = DVector::from_fn(n, |_, _| 3.0 * normal(&mut rng));
    for k in 0..m {
        let clean = if k < n { s[k] * x[k] } else { 0.0 };
        if k < n {
            rows[(k, k)] = s[k];
        }
        rows[(k, n)] = clean + normal(&mut rng);
    }
    let b = rows.column(n).into_owned();
    let problem = Factorised::new(&Triangle::new(&rows), 0);
    let shrunk = |k: usize, l: f64| l / (s[k] * s[k] + l);
    let rest: f64 = (n..m).map(|k| b[k] * b[k]).sum();
    let residual = |l: f64| rest + (0..n).map(|k| (shrunk(k, l) * b[k]).powi(2)).sum::<f64>();
    let gcv = |l: f64| {
        let used: f64 = (0..n).map(|k| 1.0 - shrunk(k, l)).sum();
        residual(l) / (m as f64 - used).powi(2)
    };
    // -2 log of the density of b, the noise's variance at its best.
    let likelihood = |l: f64| {
        let square = rest + (0..n).map(|k| shrunk(k, l) * b[k] * b[k]).sum::<f64>();
        let determinant: f64 = (0..n).map(|k| (1.0 + s[k] * s[k] / l).ln()).sum();
        m as f64 * square.ln() + determinant
    };
    for (name, found, cost) in [
        ("gcv", problem.gcv().unwrap(), &gcv as &dyn Fn(f64) -> f64),
        ("marginal likelihood", problem.maximum_likelihood().unwrap(), &likelihood),
    ] {
        println!("{name}: {found:.3}");
        for k in -60..=40 {
            let other = found * 10_f64.powf(f64::from(k) / 10.0);
            assert!(cost(found) <= cost(other) + 2e-3 * cost(other).abs(), "{name}: {other}");
        }
        assert!(cost(found) < cost(found * 1e4) && cost(found) < cost(found * 1e-5), "{name}");
    }
    let found = problem.discrepancy(1.0).unwrap();
    assert!(residual(found) <= m as f64 && residual(found * 1.2) > m as f64);
    // Even the plain solution leaves more than such a small noise.
    assert_eq!(problem.discrepancy(0.1), None);
}

/// A small part of `cargo xtask study lambda`, other problems.
#[test]
fn the_default_rule_has_little_regret() {
    let default = LambdaRule::ALL.iter().position(|r| *r == LambdaRule::default()).unwrap();
    let judged: Vec<_> =
        (0..80).map(|i| judge(99_000_000 + i, Class::ALL[i as usize % 4])).collect();
    for (k, rule) in LambdaRule::ALL.iter().enumerate() {
        let [median, decile, worst] = spread(judged.iter().map(|r| r.regret[k]).collect());
        println!("{}: median {median:.3}, worst decile {decile:.3}, worst {worst:.3}", rule.name());
    }
    let [median, decile, _] = spread(judged.iter().map(|r| r.regret[default]).collect());
    assert!(median <= 0.05 && decile <= 0.25, "{median} {decile}");
    // The comparison is one: stated noise alone is a bad guide.
    let discrepancy = LambdaRule::ALL.iter().position(|r| *r == LambdaRule::Discrepancy).unwrap();
    assert!(spread(judged.iter().map(|r| r.regret[discrepancy]).collect())[1] > 0.25);
}
