//! The vectors of `f32` and `f64`.

use pulp::Simd;

use crate::lanes::{Lanes, Vectors};
use crate::wide::Wide;
use crate::{double, single};

impl Lanes for f32 {}
impl Lanes for f64 {}

macro_rules! vectors {
    ($number:ty, $vector:ident, $splat:ident, $add:ident, $sub:ident, $mul:ident, $split:ident,
     $split_mut:ident, $load:ident, $store:ident, $sin_cos:path) => {
        impl Vectors for $number {
            type Vector<S: Simd> = S::$vector;
            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$vector {
                simd.$splat(value)
            }
            #[inline(always)]
            fn sum<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$add(a, b)
            }
            #[inline(always)]
            fn difference<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$sub(a, b)
            }
            #[inline(always)]
            fn product<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$mul(a, b)
            }
            #[inline(always)]
            fn split<S: Simd>(slice: &[Self]) -> (&[S::$vector], &[Self]) {
                S::$split(slice)
            }
            #[inline(always)]
            fn split_mut<S: Simd>(slice: &mut [Self]) -> (&mut [S::$vector], &mut [Self]) {
                S::$split_mut(slice)
            }
            #[inline(always)]
            fn load<S: Simd>(simd: S, slice: &[Self]) -> S::$vector {
                simd.$load(slice)
            }
            #[inline(always)]
            fn store<S: Simd>(simd: S, slice: &mut [Self], value: S::$vector) {
                simd.$store(slice, value);
            }
            #[inline(always)]
            fn turn<S: Simd>(simd: S, angle: S::$vector) -> (S::$vector, S::$vector) {
                let (sin, cos) = $sin_cos(Wide { simd, value: angle });
                (sin.value, cos.value)
            }
        }
    };
}

vectors!(
    f64,
    f64s,
    splat_f64s,
    add_f64s,
    sub_f64s,
    mul_f64s,
    as_simd_f64s,
    as_mut_simd_f64s,
    partial_load_f64s,
    partial_store_f64s,
    double::sin_cos
);
vectors!(
    f32,
    f32s,
    splat_f32s,
    add_f32s,
    sub_f32s,
    mul_f32s,
    as_simd_f32s,
    as_mut_simd_f32s,
    partial_load_f32s,
    partial_store_f32s,
    single::sin_cos
);
