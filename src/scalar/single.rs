//! Elementary functions in single precision: smaller than those of `libm`, which
//! serve every case and in part compute in `f64`, and with the same bits wherever
//! they run.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Cody-Waite reduction to a quarter turn and minimax polynomials, in single
/// precision only: `libm::sincosf` computes in `f64`, which a Cortex-M4F does
/// in software (2,267 instructions).
pub fn sin_cos(x: f32) -> (f32, f32) {
    // pi/2 in three parts. The first two have 8 and 11 significant bits, so
    // that quadrant * part is exact up to 8192 rad. The third is negative: an
    // infinite quadrant, see below, meets both signs here and becomes NaN.
    const HALF_PI_1: f32 = 1.570_312_5;
    const HALF_PI_2: f32 = 4.839_897_2e-4;
    const HALF_PI_3: f32 = -1.629_206_8e-7;
    // Adding and subtracting 1.5 * 2^23 rounds to the nearest integer and
    // leaves that integer in the low bits.
    const ROUND: f32 = 12_582_912.0;
    // x * 2^115 overflows from 8192 rad on; below, the scaling is exact: a
    // range check for the price of one multiplication.
    const SCALE: f32 = f32::from_bits((127 + 115) << 23);
    const TURNS: f32 = core::f32::consts::FRAC_2_PI / SCALE;

    let shifted = x * SCALE * TURNS + ROUND;
    let quadrant = shifted.to_bits();
    let turns = shifted - ROUND;
    let r = ((x - turns * HALF_PI_1) - turns * HALF_PI_2) - turns * HALF_PI_3;
    let r2 = r * r;
    // -1 for a turn by a half, the second bit of the quadrant; multiplying by
    // it costs less than negating on a condition.
    let half = f32::from_bits(1_f32.to_bits() | (quadrant & 2) << 30);
    let r = r * half;
    let sin = r + r * r2 * (-1.666_665_5e-1 + r2 * (8.332_161e-3 + r2 * -1.951_529_6e-4));
    let cos = half
        + r2 * half * (-0.5 + r2 * (4.166_664_6e-2 + r2 * (-1.388_731_6e-3 + r2 * 2.443_315_7e-5)));
    // The first bit turns by a quarter.
    if quadrant & 1 == 0 { (sin, cos) } else { (cos, -sin) }
}

/// Square root, correctly rounded, bit by bit: a third of the text of `libm`'s,
/// which has a table, and three times its time.
#[inline(never)]
pub fn sqrt(x: f32) -> f32 {
    const HIDDEN: u32 = 1 << 23;
    let bits = x.to_bits();
    if x == 0.0 || x == f32::INFINITY || x.is_nan() {
        return x;
    }
    if bits >> 31 != 0 {
        return f32::NAN;
    }
    // x = rest * 2^(2 half - 46), 2^24 <= rest < 2^26 once the exponent is even.
    let (mut rest, mut exponent) = (bits & (HIDDEN - 1), (bits >> 23) as i32);
    if exponent == 0 {
        // Subnormal: brought to the usual form.
        let shift = rest.leading_zeros() as i32 - 8;
        rest <<= shift;
        exponent = 1 - shift;
    }
    rest |= HIDDEN;
    exponent -= 127;
    rest <<= 1 + (exponent & 1);
    // The root by the digit, one more than it has places, to round by.
    let (mut root, mut twice, mut digit) = (0, 0, HIDDEN << 1);
    while digit != 0 {
        let trial = twice + digit;
        if trial <= rest {
            twice = trial + digit;
            rest -= trial;
            root += digit;
        }
        rest <<= 1;
        digit >>= 1;
    }
    // No root lies half way between two numbers: the last digit decides.
    let root = (root >> 1) + (root & 1);
    f32::from_bits((((exponent >> 1) + 126) << 23) as u32 + root)
}

/// Angle of the point (x, y), by a minimax polynomial on the eighth of a turn
/// about the x axis, error 5e-9 but for rounding.
#[inline(never)]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (run, rise) = (f32::abs(x), f32::abs(y));
    let steep = rise > run;
    let (small, large) = if steep { (run, rise) } else { (rise, run) };
    // NaN where an input is none or infinite.
    let mut angle = x * 0.0 + y * 0.0;
    if large > 0.0 {
        // tan (a - pi/4) where a is above a sixteenth of a turn.
        let beyond = small > large * 0.414_213_57;
        let t = if beyond { (small - large) / (small + large) } else { small / large };
        let t2 = t * t;
        let series = -0.333_327_56 + t2 * (0.199_718_79 + t2 * (-0.138_244_54 + t2 * 0.079_025_98));
        angle += t + t * t2 * series;
        if beyond {
            angle += FRAC_PI_4;
        }
    }
    if steep {
        angle = FRAC_PI_2 - angle;
    }
    if x.is_sign_negative() {
        angle = PI - angle;
    }
    if y.is_sign_negative() { -angle } else { angle }
}
