//! A batch has the bits of the scalar chain: whatever the arm, the number of
//! joints, the length of the batch and the instructions.

use proptest::prelude::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::nalgebra::Vector3;
use truearm::{Chain, JointKind, Link, MdhParameters, Pose, Scalar};
use truearm_batch::{BatchChain, BatchError, Cpu, Lanes, Poses, Positions};

/// Most numbers that are computed at once: `f32` by AVX-512.
const WIDEST: usize = 16;

/// Bits of every number; all NaN are one.
fn bits<T: Scalar>(values: &[T]) -> Vec<u64> {
    let one = |value: &T| match value.to_f64() {
        value if value.is_nan() => u64::MAX,
        value => value.to_bits(),
    };
    values.iter().map(one).collect()
}

fn pose<T: Scalar>(rng: &mut impl Rng) -> Pose<T> {
    let mut vector = |size: f64| {
        let [x, y, z] = [(); 3].map(|()| T::from_f64(rng.random_range(-size..size)));
        Vector3::new(x, y, z)
    };
    Pose::from_rotation_vector(vector(1.0), vector(3.0))
}

/// A link of an arm, or one on an edge: parallel, without beta, negative zeros.
fn link<T: Scalar>(rng: &mut impl Rng) -> Link<T> {
    let mut values = [3.2, 1.0, 6.3, 1.0, 0.01].map(|size| rng.random_range(-size..size));
    for value in &mut values {
        if rng.random_bool(0.3) {
            *value = [0.0, -0.0, core::f64::consts::FRAC_PI_2][rng.random_range(0..3)];
        }
    }
    let kind = if rng.random_bool(0.2) { JointKind::Prismatic } else { JointKind::Revolute };
    Link { kind, parameters: MdhParameters::from_array(values.map(T::from_f64)) }
}

/// Joint values as they are, whole quarter turns, far away, and no numbers.
fn joint<T: Scalar>(rng: &mut impl Rng) -> T {
    let quarter = core::f64::consts::FRAC_PI_4;
    T::from_f64(match rng.random_range(0..20) {
        0 => quarter * f64::from(rng.random_range(-12..12)),
        1 => quarter * f64::from(rng.random_range(-12..12)) + rng.random_range(-1e-5..1e-5),
        2 => rng.random_range(-6e4..6e4),
        3 => 10_f64.powi(rng.random_range(-300..300)),
        4 => [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0][rng.random_range(0..4)],
        _ => rng.random_range(-6.3..6.3),
    })
}

/// What a batch computes by these instructions, pose after pose: 12 numbers each.
fn batch<T: Lanes>(chain: &BatchChain<T>, q: &[Vec<T>], count: usize) -> [Vec<T>; 12] {
    let mut out = [(); 12].map(|()| vec![T::ZERO; count]);
    let [x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz] = &mut out;
    let q: Vec<&[T]> = q.iter().map(Vec::as_slice).collect();
    let positions = Positions { x, y, z };
    let rotation = [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]].map(|row| row.map(|r| &mut r[..]));
    chain.poses(&q, Poses { positions, rotation }).unwrap();
    out
}

fn check<T: Lanes, const N: usize>(seed: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let links: [Link<T>; N] = [(); N].map(|()| link(&mut rng));
    let chain = Chain::new(&links, pose(&mut rng), pose(&mut rng));
    let count = rng.random_range(0..3 * WIDEST + 2);
    let q: Vec<Vec<T>> = (0..N).map(|_| (0..count).map(|_| joint(&mut rng)).collect()).collect();
    let mut expected = [(); 12].map(|()| Vec::new());
    for index in 0..count {
        let pose = chain.forward(&core::array::from_fn(|joint| q[joint][index]));
        let [x, y, z] = pose.rotation.data.0;
        let rows = [0, 1, 2].map(|row| [x[row], y[row], z[row]]);
        let all = pose.translation.iter().copied().chain(rows.into_iter().flatten());
        expected.iter_mut().zip(all).for_each(|(column, value)| column.push(value));
    }
    for cpu in Cpu::all() {
        let wide = BatchChain::of(&chain).on(cpu);
        let computed = batch(&wide, &q, count);
        for (computed, expected) in computed.iter().zip(&expected) {
            assert_eq!(bits(computed), bits(expected), "{cpu}, {N} joints, {count} poses");
        }
        // Without the rotation it is another loop.
        let [mut x, mut y, mut z] = [(); 3].map(|()| vec![T::ZERO; count]);
        let q: Vec<&[T]> = q.iter().map(Vec::as_slice).collect();
        wide.positions(&q, Positions { x: &mut x, y: &mut y, z: &mut z }).unwrap();
        for (computed, expected) in [x, y, z].iter().zip(&expected) {
            assert_eq!(bits(computed), bits(expected), "{cpu}, {N} joints, {count} positions");
        }
    }
}

fn of_any_number<T: Lanes>(joints: usize, seed: u64) {
    match joints {
        1 => check::<T, 1>(seed),
        2 => check::<T, 2>(seed),
        3 => check::<T, 3>(seed),
        4 => check::<T, 4>(seed),
        5 => check::<T, 5>(seed),
        7 => check::<T, 7>(seed),
        9 => check::<T, 9>(seed),
        16 => check::<T, 16>(seed),
        _ => check::<T, 6>(seed),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn of_arms_in_double_precision(joints in 1_usize..17, seed in any::<u64>()) {
        of_any_number::<f64>(joints, seed);
    }

    #[test]
    fn of_arms_in_single_precision(joints in 1_usize..17, seed in any::<u64>()) {
        of_any_number::<f32>(joints, seed);
    }
}

#[test]
fn every_length_up_to_three_vectors_and_one() {
    let links = [Link::revolute(0.1, 0.2, 0.3, 0.4, 0.01); 2];
    let chain = Chain::new(&links, Pose::identity(), Pose::translation(0.1, 0.2, 0.3));
    for cpu in Cpu::all() {
        let wide = BatchChain::of(&chain).on(cpu);
        for count in 0..=3 * WIDEST + 1 {
            let q: Vec<Vec<f64>> =
                (0..2).map(|j| (0..count).map(|i| (i + 7 * j) as f64 * 0.1).collect()).collect();
            let [x, ..] = batch(&wide, &q, count);
            let expected: Vec<f64> =
                (0..count).map(|i| chain.forward(&[q[0][i], q[1][i]]).translation.x).collect();
            assert_eq!(bits(&x), bits(&expected), "{cpu}, {count} poses");
        }
    }
}

#[test]
fn by_links_as_by_the_chain() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let links: Vec<Link<f64>> = (0..16).map(|_| link(&mut rng)).collect();
    let (base, tool) = (pose(&mut rng), pose(&mut rng));
    let q: Vec<Vec<f64>> = (0..16).map(|_| vec![rng.random_range(-3.0..3.0)]).collect();
    let wide = BatchChain::new(&links, base, tool).unwrap();
    assert_eq!(wide.joints(), 16);
    let chain = Chain::new(&<[_; 16]>::try_from(links).unwrap(), base, tool);
    assert_eq!(batch(&wide, &q, 1), batch(&BatchChain::of(&chain), &q, 1));
}

#[test]
fn shapes_that_do_not_agree_are_refused() {
    let link = Link::revolute(0.0, 0.0, 0.0, 0.1, 0.0);
    let identity = Pose::identity();
    for count in [0, 17] {
        let refused = BatchChain::new(&vec![link; count], identity, identity);
        assert_eq!(refused.unwrap_err(), BatchError::Joints(count));
    }
    let wide = BatchChain::new(&[link; 2], identity, identity).unwrap();
    let run = |q: &[&[f64]], lengths: [usize; 3]| {
        let [mut x, mut y, mut z] = lengths.map(|length| vec![7.0; length]);
        let result = wide.positions(q, Positions { x: &mut x, y: &mut y, z: &mut z });
        assert!(result.is_ok() || [x, y, z].concat().iter().all(|value| *value == 7.0));
        result
    };
    assert_eq!(run(&[&[0.0; 3], &[0.0; 3]], [3, 3, 3]), Ok(()));
    assert_eq!(run(&[&[0.0; 3]], [3; 3]), Err(BatchError::Columns { expected: 2, found: 1 }));
    let error = |found| Err(BatchError::Length { expected: 3, found });
    assert_eq!(run(&[&[0.0; 3], &[0.0; 4]], [3; 3]), error(4));
    assert_eq!(run(&[&[0.0; 3], &[0.0; 3]], [3, 3, 2]), error(2));
}
