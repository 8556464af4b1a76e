//! Sine and cosine of vectors of `f64`.

// The constants stand as FreeBSD's msun and libm have them.
#![allow(clippy::excessive_precision)]

use core::f64::consts::{FRAC_2_PI, FRAC_PI_4};

use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

use crate::wide::Wide;

/// 1.5 * 2^52: adding and subtracting it rounds to the nearest whole number and
/// leaves that number in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// First 33 bits of pi/2, and the rest.
const HALF_PI_1: f64 = 1.57079632673412561417e+00;
const HALF_PI_1_REST: f64 = 6.07710050650619224932e-11;
/// From here on libm reduces an angle: the first whose high word is above that of pi/4.
const REDUCED: f64 = f64::from_bits(0x3fe9_21fc_0000_0000);
/// Reduced angles nearer to pi/4 are those of angles for which libm, which decides
/// by high words up to 9pi/4, may take the quadrant on the other side.
const NEAR_PI_4: f64 = FRAC_PI_4 - 8e-6;
/// 2^-16: where less than that is left of an angle, libm goes on reducing it.
const LITTLE: f64 = 1.525_878_906_25e-5;

/// Operation by operation what `libm::sincos` does for most angles, and so its bound,
/// below 1 ulp of either, for all of them. The scalar function itself takes
///
/// * what is within 2^-16 of its size of a multiple of pi/2 other than 0 (an exact
///   quarter turn is);
/// * what is within 8e-6 rad of an odd multiple of pi/4 other than the first;
/// * 51,471 rad (8,191 turns) and more, infinities and NaN.
///
/// All lanes of a vector with one of those go there.
#[inline(always)]
pub fn sin_cos<S: Simd>(x: Wide<f64, S>) -> (Wide<f64, S>, Wide<f64, S>) {
    if S::F64_LANES == 1 {
        // It decides by branches, and alone that is quicker.
        return one_by_one(x);
    }
    let simd = x.simd;
    let size = simd.abs_f64s(x.value);
    let small = simd.less_than_f64s(size, simd.splat_f64s(REDUCED));
    let shifted = x * FRAC_2_PI + ROUND;
    let shifted = x.with(simd.select_f64s(small, simd.splat_f64s(ROUND), shifted.value));
    let turns = shifted - ROUND;
    let r = x - turns * HALF_PI_1;
    let w = turns * HALF_PI_1_REST;
    let y = r - w;
    let rest = (r - y) - w;

    // A large angle is unusual too: no reduced angle is above 2^-16 of its size and
    // below pi/4.
    let left = simd.abs_f64s(y.value);
    let enough = simd.greater_than_or_equal_f64s(left, (x.with(size) * LITTLE).value);
    let clear = simd.less_than_f64s(left, simd.splat_f64s(NEAR_PI_4));
    let usual = simd.or_m64s(small, simd.and_m64s(enough, clear));
    if simd.first_true_m64s(simd.not_m64s(usual)) < S::F64_LANES {
        return one_by_one(x);
    }

    let (sin, cos) = near_zero(y, rest, small);
    // The first bit of the quadrant turns by a quarter, the second by a half.
    let quadrant = simd.transmute_u64s_f64s(shifted.value);
    let bit = |bit: u64| {
        let bit = simd.splat_u64s(bit);
        simd.equal_u64s(simd.and_u64s(quadrant, bit), bit)
    };
    let (quarter, half) = (bit(1), bit(2));
    let [minus, plus] = [simd.splat_f64s(-0.0), simd.splat_f64s(0.0)];
    let sign = |negative| simd.select_f64s(negative, minus, plus);
    let [of_sin, of_cos] = [sign(half), sign(simd.xor_m64s(quarter, half))];
    (
        x.with(simd.xor_f64s(simd.select_f64s(quarter, cos.value, sin.value), of_sin)),
        x.with(simd.xor_f64s(simd.select_f64s(quarter, sin.value, cos.value), of_cos)),
    )
}

/// Of `x + rest`, |x| < pi/4; where `small`, without the rest.
#[inline(always)]
fn near_zero<S: Simd>(
    x: Wide<f64, S>,
    rest: Wide<f64, S>,
    small: S::m64s,
) -> (Wide<f64, S>, Wide<f64, S>) {
    const S1: f64 = -1.66666666666666324348e-01;
    const S2: f64 = 8.33333333332248946124e-03;
    const S3: f64 = -1.98412698298579493134e-04;
    const S4: f64 = 2.75573137070700676789e-06;
    const S5: f64 = -2.50507602534068634195e-08;
    const S6: f64 = 1.58969099521155010221e-10;
    const C1: f64 = 4.16666666666666019037e-02;
    const C2: f64 = -1.38888888888741095749e-03;
    const C3: f64 = 2.48015872894767294178e-05;
    const C4: f64 = -2.75573143513906633035e-07;
    const C5: f64 = 2.08757232129817482790e-09;
    const C6: f64 = -1.13596475577881948265e-11;

    let simd = x.simd;
    let one = Wide::splat(simd, 1.0);
    let z = x * x;
    let w = z * z;
    let r = (z * (z * S4 + S3) + S2) + z * w * (z * S6 + S5);
    let v = z * x;
    let alone = x + v * (z * r + S1);
    let reduced = x - ((z * (rest * 0.5 - v * r) - rest) - v * S1);
    let sin = x.with(simd.select_f64s(small, alone.value, reduced.value));

    let r = z * (z * (z * C3 + C2) + C1) + w * w * (z * (z * C6 + C5) + C4);
    let half = z * 0.5;
    let most = one - half;
    let cos = most + (((one - most) - half) + (z * r - x * rest));
    (sin, cos)
}

/// Every lane by the scalar function. Of slices: the vectors would not pass a call
/// in registers.
#[cold]
#[inline(never)]
fn scalar(x: &[f64], sin: &mut [f64], cos: &mut [f64]) {
    for (x, (sin, cos)) in x.iter().zip(sin.iter_mut().zip(cos)) {
        (*sin, *cos) = libm::sincos(*x);
    }
}

#[inline(always)]
fn one_by_one<S: Simd>(x: Wide<f64, S>) -> (Wide<f64, S>, Wide<f64, S>) {
    let (angles, mut sin, mut cos) = ([x.value], [x.value], [x.value]);
    scalar(cast_slice(&angles), cast_slice_mut(&mut sin), cast_slice_mut(&mut cos));
    (x.with(sin[0]), x.with(cos[0]))
}
