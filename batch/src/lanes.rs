//! What `f32` and `f64` each do with a vector.

use pulp::Simd;
use truearm::Scalar;

mod sealed {
    use super::Simd;

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
        /// Sine and cosine.
        fn turn<S: Simd>(simd: S, angle: Self::Vector<S>) -> (Self::Vector<S>, Self::Vector<S>);
    }
}

pub(crate) use sealed::Vectors;

/// A number type that batches are computed in: `f32` or `f64`. Sealed.
pub trait Lanes: Scalar + Vectors {}
