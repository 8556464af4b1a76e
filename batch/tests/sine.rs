//! Sine and cosine of the batch are those of `libm`, bit for bit, over all
//! angles; seen through an arm with one joint whose tool lies on its x axis.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{Link, Pose, Scalar};
use truearm_batch::{BatchChain, Cpu, Lanes, Positions};

/// Sines and cosines: the batch's, by these instructions.
fn sin_cos<T: Lanes>(cpu: Cpu, angles: &[T]) -> (Vec<T>, Vec<T>) {
    let (zero, one) = (T::ZERO, T::ONE);
    let link = Link::revolute(zero, zero, zero, zero, zero);
    let tool = Pose::translation(one, zero, zero);
    let wide = BatchChain::new(&[link], Pose::identity(), tool).unwrap().on(cpu);
    let [mut x, mut y, mut z] = [(); 3].map(|()| vec![zero; angles.len()]);
    wide.positions(&[angles], Positions { x: &mut x, y: &mut y, z: &mut z }).unwrap();
    (y, x)
}

fn check<T: Lanes>(angles: &[T]) {
    for cpu in Cpu::all() {
        let (sin, cos) = sin_cos(cpu, angles);
        for ((angle, sin), cos) in angles.iter().zip(sin).zip(cos) {
            let (s, c) = angle.sin_cos();
            // Times 1, plus 0: the number itself, but for the sign of a zero.
            let same = |a: T, b: T| a == b || (a.to_f64().is_nan() && b.to_f64().is_nan());
            assert!(same(s, sin) && same(c, cos), "{cpu}, {angle:e}: {sin:e}, {cos:e}");
        }
    }
}

fn next(value: f64, steps: i64) -> f64 {
    f64::from_bits(value.to_bits().wrapping_add_signed(steps))
}

/// Angles about every place where the way of computing changes.
fn edges() -> Vec<f64> {
    let quarter = core::f64::consts::FRAC_PI_4;
    let mut centres: Vec<f64> = (0..70_000).map(|k| quarter * f64::from(k)).collect();
    centres.extend((0..1024).map(|k| f64::from_bits(k << 53)));
    centres.extend([51_471.0, 51_471.9, 65_536.0, 1_647_099.0, 1e9, 1e22, 1e300, f64::MAX]);
    // The high words by which libm decides.
    let words = [
        0x3e46_a09e,
        0x3fe9_21fb,
        0x3ff9_21fb,
        0x4002_d97c,
        0x4009_21fb,
        0x400f_6a7a,
        0x4012_d97c,
        0x4015_fdbc,
        0x4019_21fb,
        0x401c_463b,
        0x4139_21fb_u64,
    ];
    centres
        .extend(words.iter().flat_map(|word| [word << 32, (word + 1) << 32]).map(f64::from_bits));
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut all = vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for centre in centres {
        all.extend([-1, 0, 1].map(|step| next(centre, step)).iter().flat_map(|x| [*x, -x]));
        // At every distance, on a scale of decades.
        let off = 10_f64.powf(rng.random_range(-17.0..-3.0));
        all.extend([centre + off, centre - off, centre * (1.0 + off), -centre * (1.0 - off)]);
    }
    all
}

#[test]
fn double_precision_at_its_edges() {
    check(&edges());
}

#[test]
fn double_precision_anywhere() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for size in [1e-8, 1e-3, 0.8, 3.2, 6.3, 10.0, 100.0, 1e4, 6e4, 2e6] {
        check::<f64>(&(0..200_000).map(|_| rng.random_range(-size..size)).collect::<Vec<_>>());
    }
    check::<f64>(&(0..200_000).map(|_| f64::from_bits(rng.random())).collect::<Vec<_>>());
}

#[test]
fn single_precision_anywhere() {
    // Every 97th of all numbers, both signs, and some more than are in range.
    check::<f32>(&(0..=u32::MAX / 97).map(|k| f32::from_bits(k * 97)).collect::<Vec<_>>());
}

#[test]
fn error_bounds() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let angles: Vec<f64> = (0..100_000).map(|_| rng.random_range(-50.0..50.0)).collect();
    let single: Vec<f32> = angles.iter().map(|x| x.to_f32()).collect();
    for cpu in Cpu::all() {
        let (sin, cos) = sin_cos(cpu, &single);
        for ((x, sin), cos) in single.iter().zip(sin).zip(cos) {
            let (s, c) = libm::sincos(f64::from(*x));
            assert!((f64::from(sin) - s).abs() < 1e-7 && (f64::from(cos) - c).abs() < 1e-7);
        }
        let (sin, cos) = sin_cos(cpu, &angles);
        for ((x, sin), cos) in angles.iter().zip(sin).zip(cos) {
            // The platform's own, another implementation: both are below 1 ulp.
            assert!((sin - x.sin()).abs() <= 2.3e-16 && (cos - x.cos()).abs() <= 2.3e-16);
        }
    }
}

/// Nearest `f32`.
trait Single {
    fn to_f32(&self) -> f32;
}

impl Single for f64 {
    fn to_f32(&self) -> f32 {
        f32::from_f64(*self)
    }
}
