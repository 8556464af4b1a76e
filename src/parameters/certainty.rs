use crate::scalar::Scalar;
use crate::solve::{SolveError, Triangle};

/// How sure fitted parameters are.
pub(crate) struct Certainty<T, const P: usize> {
    /// Standard deviation of each, in its unit; infinite where neither points nor
    /// prior determine it.
    pub sigma: [T; P],
    /// Whether the points, rather than the prior, determine it: its standard
    /// deviation is less than half of `scale / sqrt(lambda)`.
    pub determined: [bool; P],
    /// Independent directions among the parameters that the points show.
    pub rank: usize,
}

impl<T: Scalar, const P: usize> Certainty<T, P> {
    /// After a solve with this lambda of rows that are divided by their sigma.
    pub fn of(triangle: &Triangle<T, P>, lambda: T, scale: &[T; P]) -> Result<Self, SolveError> {
        // Columns of one size; where there is no prior, of rad and m.
        let units = scale.map(|s| if s.is_finite() { s } else { T::ONE });
        let rank = triangle.spectrum(&units)?.rank();
        let sigma = triangle.variances(lambda, scale)?.map(T::sqrt);
        let (half, root) = (T::from_f32(0.5), lambda.sqrt());
        let mut determined = [false; P];
        for ((determined, sigma), scale) in determined.iter_mut().zip(&sigma).zip(scale) {
            *determined = *sigma < half * (*scale / root);
        }
        Ok(Self { sigma, determined, rank })
    }

    /// How many unknowns the points determine, the shares that the prior holds taken off:
    /// the trace of what takes readings to fitted ones. `scale` and `lambda` of the solve.
    pub fn fitted(&self, lambda: T, scale: &[T; P]) -> T {
        let root = lambda.sqrt();
        let mut fitted = T::ZERO;
        for (sigma, scale) in self.sigma.iter().zip(scale) {
            let held = *sigma * root / *scale;
            let held = held * held;
            // Roundings may take it beyond; of an infinite scale nothing is held.
            fitted += if held < T::ONE { T::ONE - held } else { T::ZERO };
        }
        fitted
    }

    /// The first that nothing determines.
    pub fn undetermined(&self) -> Option<usize> {
        self.sigma.iter().position(|sigma| !sigma.is_finite())
    }
}
