//! What `f32` and `f64` each do with a vector.

use pulp::Simd;
use truearm::Scalar;

use crate::wide::Wide;
use crate::{double, single};

mod sealed {
    use super::{Simd, Wide};

    /// Vectors of a number type. Of this crate only: the same bits are proven for
    /// two types.
    pub trait Vectors: Sized + Copy {
        type Vector<S: Simd>: Copy;
        fn splat<S: Simd>(simd: S, value: Self) -> Self::Vector<S>;
        fn sum<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
        fn difference<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
        fn product<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
        /// Whole vectors, and what is left over.
        fn split<S: Simd>(slice: &[Self]) -> (&[Self::Vector<S>], &[Self]);
        fn split_mut<S: Simd>(slice: &mut [Self]) -> (&mut [Self::Vector<S>], &mut [Self]);
        /// Less than a vector, zeros behind it.
        fn load<S: Simd>(simd: S, slice: &[Self]) -> Self::Vector<S>;
        fn store<S: Simd>(simd: S, slice: &mut [Self], value: Self::Vector<S>);
        fn wide_sin_cos<S: Simd>(angle: Wide<Self, S>) -> (Wide<Self, S>, Wide<Self, S>)
        where
            Self: super::Lanes;
    }
}

pub(crate) use sealed::Vectors;

/// A number type that batches are computed in: `f32` or `f64`. Sealed.
pub trait Lanes: Scalar + Vectors {}

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
            fn wide_sin_cos<S: Simd>(angle: Wide<Self, S>) -> (Wide<Self, S>, Wide<Self, S>) {
                $sin_cos(angle)
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
