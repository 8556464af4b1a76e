//! Linear fleets whose truth is known.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Arm, Fleet, LEVEL};
use crate::tikhonov::Normal;

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random_range(0.0..1.0));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Parameters of two joints.
const SIZE: usize = 10;

/// Measured in noise of 0.05 tolerances; the last two parameters by their sum alone.
fn measured(x: &DVector<f64>, rows: usize, rng: &mut ChaCha8Rng) -> Arm {
    let mut a = DMatrix::from_fn(rows, SIZE, |_, _| normal(rng));
    let same = a.column(SIZE - 2).into_owned();
    a.set_column(SIZE - 1, &same);
    let b = &a * x + DVector::from_fn(rows, |_, _| 0.05 * normal(rng));
    let mut both = a.insert_column(SIZE, 0.0);
    both.set_column(SIZE, &b);
    Arm { links: Normal::new(&(both / 0.05)) }
}

fn arms(count: usize, sizes: &[f64; SIZE], mean: &[f64; SIZE], seed: u64) -> Vec<Arm> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let arm = |_| {
        let x = DVector::from_fn(SIZE, |k, _| mean[k] + sizes[k] * normal(&mut rng));
        measured(&x, 30, &mut rng)
    };
    (0..count).map(arm).collect()
}

const SIZES: [f64; SIZE] = [0.05, 0.2, 1.0, 3.0, 0.3, 0.05, 0.2, 3.0, 1.0, 1.0];

#[test]
fn spreads_are_found_and_what_no_arm_says_stays() {
    let fleet = Fleet::of(&arms(60, &SIZES, &[0.0; SIZE], 1));
    let found = fleet.learned.tolerance();
    for k in 0..SIZE - 2 {
        let ratio = found[k] / SIZES[k];
        assert!((0.7..1.4).contains(&ratio), "{k}: {ratio}");
    }
    println!("{found} {} {}", fleet.learned.determined, fleet.learned.scatter);
    // Of the sum alone: neither is said to be certain, together they are the sum.
    let sum = found[SIZE - 2].hypot(found[SIZE - 1]);
    assert!((0.7..1.4).contains(&(sum / 2_f64.sqrt())), "{sum}");
    assert!(fleet.learned.determined[SIZE - 1] < 40.0);
    assert!(fleet.learned.determined[0] > 30.0);
    assert!((fleet.learned.noise() - 1.0).abs() < 0.15);
}

#[test]
fn one_arm_gives_back_nearly_what_was_assumed() {
    for seed in 0..20 {
        let fleet = Fleet::of(&arms(1, &[1.0; SIZE], &[0.0; SIZE], seed));
        assert!(fleet.common.is_empty());
        for t in fleet.learned.tolerance().iter() {
            assert!((0.4..2.5).contains(t), "{t}");
        }
    }
}

#[test]
fn a_wrong_drawing_is_told_from_wrong_arms() {
    let mut mean = [0.0; SIZE];
    mean[2] = 4.0;
    let fleet = Fleet::of(&arms(10, &SIZES, &mean, 2));
    assert_eq!(fleet.common.iter().map(|(k, _)| *k).collect::<Vec<_>>(), [2]);
    assert!((fleet.learned.mean[2] - 4.0).abs() < 1.2);
    assert!(fleet.learned.tolerance()[2] < 2.0);
    assert!(fleet.arms.iter().all(|arm| !arm.apart));
}

#[test]
fn an_arm_that_differs_is_named_and_does_not_teach() {
    let mut all = arms(12, &SIZES, &[0.0; SIZE], 3);
    let mut rng = ChaCha8Rng::seed_from_u64(99);
    let mut x = DVector::from_fn(SIZE, |k, _| SIZES[k] * normal(&mut rng));
    x[5] += 2.0;
    all.insert(4, measured(&x, 30, &mut rng));
    let fleet = Fleet::of(&all);
    let named: Vec<usize> = (0..all.len()).filter(|k| fleet.arms[*k].apart).collect();
    assert_eq!(named, [4]);
    let worst = &fleet.arms[4];
    assert_eq!((worst.joint, worst.parameter as usize), (1, 0));
    assert!((worst.deviation - 2e-3).abs() < 4e-4, "{}", worst.deviation);
    assert!(fleet.learned.tolerance()[5] < 0.1);
}

#[test]
fn nothing_is_named_more_often_than_said() {
    let count = 120;
    let (mut named, mut common) = (0, 0);
    for seed in 0..count {
        let size = 4 + seed as usize % 9;
        let fleet = Fleet::of(&arms(size, &SIZES, &[0.0; SIZE], 1000 + seed));
        named += usize::from(fleet.arms.iter().any(|arm| arm.apart));
        common += usize::from(!fleet.common.is_empty());
    }
    println!("named {named}, common {common} of {count}");
    // Two standard deviations above what is said.
    let most = LEVEL * count as f64;
    assert!((named as f64) < most + 2.0 * most.sqrt(), "{named}");
    assert!((common as f64) < most + 2.0 * most.sqrt(), "{common}");
}
