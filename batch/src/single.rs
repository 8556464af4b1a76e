//! Sine and cosine of vectors of `f32`.

use pulp::Simd;

use crate::wide::Wide;

/// Operation by operation what [`truearm::Scalar::sin_cos`] does in `f32`, and so its
/// bound: absolute error of either below 1e-7 for |x| < 8192 rad, NaN beyond.
#[inline(always)]
pub fn sin_cos<S: Simd>(x: Wide<f32, S>) -> (Wide<f32, S>, Wide<f32, S>) {
    const HALF_PI_1: f32 = 1.570_312_5;
    const HALF_PI_2: f32 = 4.839_897_2e-4;
    const HALF_PI_3: f32 = -1.629_206_8e-7;
    const ROUND: f32 = 12_582_912.0;
    // Overflows where an angle is too large: a range check for one product.
    const SCALE: f32 = f32::from_bits((127 + 115) << 23);
    const TURNS: f32 = core::f32::consts::FRAC_2_PI / SCALE;

    let simd = x.simd;
    let shifted = x * SCALE * TURNS + ROUND;
    let turns = shifted - ROUND;
    let r = ((x - turns * HALF_PI_1) - turns * HALF_PI_2) - turns * HALF_PI_3;
    let r2 = r * r;
    // -1 for a turn by a half, the second bit of the quadrant.
    let quadrant = simd.transmute_u32s_f32s(shifted.value);
    let second = simd.and_u32s(quadrant, simd.splat_u32s(2));
    let sign = simd.wrapping_dyn_shl_u32s(second, simd.splat_u32s(30));
    let one = simd.splat_u32s(1_f32.to_bits());
    let half = x.with(simd.transmute_f32s_u32s(simd.or_u32s(one, sign)));
    let r = r * half;
    let sin = r + r * r2 * ((r2 * ((r2 * -1.951_529_6e-4) + 8.332_161e-3)) + -1.666_665_5e-1);
    let inner = (r2 * 2.443_315_7e-5) + -1.388_731_6e-3;
    let inner = (r2 * inner) + 4.166_664_6e-2;
    let cos = half + r2 * half * ((r2 * inner) + -0.5);
    // The first bit turns by a quarter.
    let first = simd.and_u32s(quadrant, simd.splat_u32s(1));
    let even = simd.equal_u32s(first, simd.splat_u32s(0));
    let minus_sin = simd.xor_f32s(sin.value, simd.splat_f32s(-0.0));
    (
        x.with(simd.select_f32s(even, sin.value, cos.value)),
        x.with(simd.select_f32s(even, cos.value, minus_sin)),
    )
}
