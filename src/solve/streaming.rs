use super::{SolveError, Triangle};
use crate::scalar::Scalar;

/// Decades tried, from the ninth below the corner on, and tenths of a decade.
const DECADES: usize = 14;
const TENTHS: usize = 11;
/// 10^(1/10)
const TENTH: f64 = 1.258_925_411_794_167_3;

/// Identification of P parameters from one measurement at a time, in memory
/// that does not grow: most points are folded into a triangle that is solved,
/// every k-th into one that only judges, so that lambda is never chosen by
/// points that were fitted. The last 512 fitted points are kept in a triangle
/// of their own and then folded in as one: `f32` would otherwise lose a factor
/// of `sqrt(points)` (10,000 points of condition 1e3: see tests/solve/streaming.rs).
///
/// Memory and cost: see [`super::Memory`] and [`Triangle::push`].
///
/// ```
/// use truearm::solve::StreamingTikhonov;
///
/// # fn main() -> Result<(), truearm::solve::SolveError> {
/// // Every third row judges; nothing is forgotten.
/// let mut stream = StreamingTikhonov::<f64, 2>::new(3, 1.0)?;
/// for x in 0..30 {
///     let x = f64::from(x) * 0.1;
///     stream.push(&[[1.0], [x]], &[1.0 + 2.0 * x])?;
/// }
/// let lambda = stream.choose(&[1.0; 2])?.two_step.unwrap_or(0.0);
/// let line = stream.all()?.solve(lambda, &[1.0; 2])?;
/// assert!((line.x[0] - 1.0).abs() < 1e-3 && (line.x[1] - 2.0).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamingTikhonov<T, const P: usize> {
    settled: Triangle<T, P>,
    recent: Triangle<T, P>,
    held_out: Triangle<T, P>,
    forgetting: T,
    every: u32,
    points: u32,
    /// Points since the last one that judges.
    since: u32,
    recent_points: u32,
}

/// Points of `recent`.
const BLOCK: u32 = 512;

/// What the rules say of lambda, see [`StreamingTikhonov::choose`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LambdaChoice<T> {
    /// The corner of the L-curve of the fitted points; `None` if it has none.
    pub l_curve: Option<T>,
    /// After the two steps, above 0; `None` without held-out points, and where no lambda could be
    /// tried or judged, as rows are beyond the number type.
    pub two_step: Option<T>,
    /// `|U x - S|^2` of the held-out points at `two_step`.
    pub held_out_square: T,
}

impl<T: Scalar, const P: usize> StreamingTikhonov<T, P> {
    /// No points yet. Every `every`-th point is held out, none if 0. Before
    /// each point all earlier ones are weighed by `forgetting`, 1 for never:
    /// they fade with a time constant of `1 / (1 - forgetting)` points.
    ///
    /// # Errors
    /// [`SolveError::BadForgetting`] unless `forgetting` lies in (0, 1] and has a
    /// finite inverse.
    pub fn new(every: u32, forgetting: T) -> Result<Self, SolveError> {
        if !((T::ONE / forgetting).is_finite() && forgetting > T::ZERO && forgetting <= T::ONE) {
            return Err(SolveError::BadForgetting);
        }
        let none = Triangle::new();
        Ok(Self {
            settled: none,
            recent: none,
            held_out: none,
            forgetting,
            every,
            points: 0,
            since: 0,
            recent_points: 0,
        })
    }

    /// Folds one point of M equations in, see [`Triangle::push`]; returns
    /// whether it was held out. Once in 512 points about `P^3` operations more.
    ///
    /// # Errors
    /// As for [`Triangle::push_weighted`]; no point has been added then.
    pub fn push<const M: usize>(
        &mut self,
        columns: &[[T; M]; P],
        rhs: &[T; M],
    ) -> Result<bool, SolveError> {
        let since = self.since.saturating_add(1);
        let judges = since == self.every;
        if !judges && self.recent_points >= BLOCK {
            self.settle()?;
        }
        let to = if judges { &mut self.held_out } else { &mut self.recent };
        // The new row heavier and then all lighter: a refused row changes
        // nothing.
        to.push_weighted(columns, rhs, T::ONE / self.forgetting)?;
        if self.forgetting < T::ONE {
            for triangle in [&mut self.settled, &mut self.recent, &mut self.held_out] {
                triangle.forget(self.forgetting);
            }
        }
        self.recent_points += u32::from(!judges);
        self.points = self.points.saturating_add(1);
        self.since = if judges { 0 } else { since };
        Ok(judges)
    }

    /// Folds the recent points into the settled ones. Not inlined: its stack
    /// is not every point's.
    #[inline(never)]
    fn settle(&mut self) -> Result<(), SolveError> {
        self.settled.absorb(&self.recent)?;
        self.recent.clear();
        self.recent_points = 0;
        Ok(())
    }

    /// Points seen, at most `u32::MAX`.
    #[must_use]
    pub fn points(&self) -> u32 {
        self.points
    }

    /// Triangle of the points that are fitted. Settles the recent ones, which
    /// is why it is for now and then, not for every point.
    ///
    /// # Errors
    /// [`SolveError::Overflow`]; all is then as before.
    pub fn fitted(&mut self) -> Result<&Triangle<T, P>, SolveError> {
        self.settle()?;
        Ok(&self.settled)
    }

    /// Triangle of the points that only judge.
    #[must_use]
    pub fn held_out(&self) -> &Triangle<T, P> {
        &self.held_out
    }

    /// Triangle of all points, for the last solve once lambda is chosen.
    ///
    /// # Errors
    /// [`SolveError::Overflow`]; all is then as before.
    pub fn all(&mut self) -> Result<Triangle<T, P>, SolveError> {
        self.settle()?;
        let mut all = self.settled;
        all.absorb(&self.held_out)?;
        Ok(all)
    }

    /// The corner of the L-curve and the paper's two-step refinement: decades
    /// about the corner, then ten steps inside the best decade, judged on the
    /// held-out points. (The paper judges on the fitted ones, whose residual is
    /// least at lambda = 0.) Where the error is flat the largest lambda wins.
    /// Lambdas below [`super::Spectrum::least_lambda`] are not tried.
    ///
    /// # Errors
    /// As for [`Triangle::spectrum`].
    pub fn choose(&mut self, scale: &[T; P]) -> Result<LambdaChoice<T>, SolveError> {
        self.settle()?;
        let spectrum = self.settled.spectrum(scale)?;
        let l_curve = spectrum.corner();
        let least = spectrum.least_lambda();
        let none = LambdaChoice { l_curve, two_step: None, held_out_square: T::ZERO };
        if self.every == 0 || self.points < self.every || least <= T::ZERO {
            return Ok(none);
        }
        let start = l_curve.unwrap_or(spectrum.largest() * T::from_f64(1e-6));
        let judged = |lambda: T| match spectrum.solve(lambda) {
            Ok(x) => (lambda, self.held_out.residual_square(&x)),
            Err(_) => (T::ZERO, T::ZERO),
        };
        let mut tried = [(T::ZERO, T::ZERO); DECADES + TENTHS];
        for (slot, k) in tried.iter_mut().zip(-9..).take(DECADES) {
            *slot = judged(start * power(10.0, k));
        }
        let (decade, _) = best(&tried, least);
        for (slot, k) in tried.iter_mut().skip(DECADES).zip(-5..) {
            *slot = judged(decade * power(TENTH, k));
        }
        let (two_step, held_out_square) = best(&tried, least);
        let two_step = (two_step > T::ZERO).then_some(two_step);
        Ok(LambdaChoice { two_step, held_out_square, ..none })
    }
}

/// The largest lambda whose error is within 1e-4 (of its root) of the least.
fn best<T: Scalar>(tried: &[(T, T)], from: T) -> (T, T) {
    let usable = || tried.iter().filter(|(lambda, error)| *lambda >= from && error.is_finite());
    let mut errors = usable().map(|(_, error)| *error);
    let first = errors.next().unwrap_or(T::ZERO);
    let least = errors.fold(first, |least, error| if error < least { error } else { least });
    let limit = least * T::from_f64(1.0001 * 1.0001);
    let flat = usable().filter(|(_, error)| *error <= limit);
    flat.fold((T::ZERO, T::ZERO), |best, this| if this.0 > best.0 { *this } else { best })
}

fn power<T: Scalar>(base: f64, exponent: i32) -> T {
    let factor = if exponent < 0 { 1.0 / base } else { base };
    T::from_f64((0..exponent.unsigned_abs()).fold(1.0, |power, _| power * factor))
}
