use super::{SolveError, Triangle, check};
use crate::scalar::Scalar;

/// Sweeps of the Jacobi iteration; five to eight are usual at 30 parameters.
const MOST_SWEEPS: usize = 16;
/// Points of the L-curve a decade of lambda, and one to the next: 10^(1/16).
const POINTS: usize = 16;
const STEP: f64 = 1.154_781_984_689_458_3;

/// A triangle factorised for every lambda: singular values, right singular
/// vectors and rotated right-hand side of the scaled, penalised block.
///
/// By one-sided Jacobi rotations of the *rows*: with `R = U S V'` these turn
/// into `s_i v_i'` while the right-hand side, rotated along, turns into `U'c`,
/// so that neither U nor V is accumulated. Memory `P^2 + 2 P` numbers beside
/// the triangle's; about `6 P^3` operations a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum<'a, T, const P: usize> {
    triangle: &'a Triangle<T, P>,
    scale: &'a [T; P],
    /// Leading parameters without penalty.
    free: usize,
    /// `s_i v_i`, longest first, in row `free + i`.
    rows: [[T; P]; P],
    /// `s_i^2`
    square: [T; P],
    /// `u_i' c`
    beta: [T; P],
    largest: T,
    /// Squares below are rounding noise.
    noise: T,
}

impl<T: Scalar, const P: usize> Triangle<T, P> {
    /// Factorises for every lambda, each parameter counted in units of its
    /// `scale`. Parameters with an infinite scale are not penalised; these must
    /// be the first ones, and determined by the rows.
    ///
    /// # Errors
    /// A scale that is not positive, or infinite behind a finite one; rows that
    /// overflow.
    #[inline]
    pub fn spectrum<'a>(&'a self, scale: &'a [T; P]) -> Result<Spectrum<'a, T, P>, SolveError> {
        check(T::ZERO, scale)?;
        let free = scale.iter().take_while(|s| !s.is_finite()).count();
        let late = scale.iter().skip(free).position(|s| !s.is_finite());
        if let Some(late) = late {
            return Err(SolveError::BadScale { parameter: free + late });
        }
        let mut rows = [[T::ZERO; P]; P];
        let mut beta = [T::ZERO; P];
        let source = self.u.iter().zip(&self.d).zip(&self.c);
        let target = rows.iter_mut().zip(&mut beta);
        for (k, (((u, d), c), (row, beta))) in source.zip(target).enumerate().skip(free) {
            let root = d.sqrt();
            *beta = root * *c;
            let right = core::iter::once(T::ONE).chain(u.iter().copied());
            for ((out, scale), u) in row.iter_mut().zip(scale).skip(k).zip(right) {
                *out = root * u * *scale;
            }
        }
        let square = diagonalise(&mut rows, &mut beta, free)?;
        let largest = square.iter().fold(T::ZERO, |most, s| if *s > most { *s } else { most });
        // 1e-10 of the largest singular value in f64, as the host has it; f32
        // has rounding noise at 32 EPSILON.
        let share = if single::<T>() { T::EPSILON * T::from_f32(32.0) } else { T::from_f64(1e-10) };
        let noise = share * share * largest;
        Ok(Spectrum { triangle: self, scale, free, rows, square, beta, largest, noise })
    }
}

impl<T: Scalar, const P: usize> Spectrum<'_, T, P> {
    /// `(s^2, s^2 / (s^2 + lambda), beta)` of the directions above noise.
    fn directions(&self, lambda: T) -> impl Iterator<Item = (T, T, T)> {
        let noise = self.noise;
        let all = self.square.iter().zip(&self.beta).skip(self.free);
        all.filter(move |(s2, _)| **s2 > noise).map(move |(s2, b)| (*s2, *s2 / (*s2 + lambda), *b))
    }

    /// Squared singular values of the penalised block, largest first, zeros
    /// behind.
    pub fn squares(&self) -> impl Iterator<Item = T> {
        self.square.iter().copied().skip(self.free)
    }

    /// Directions above rounding noise: 1e-10 of the largest singular value in
    /// `f64`, 32 `EPSILON` in `f32`; those without penalty not counted.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.squares().filter(|square| *square > self.noise).count()
    }

    /// The solution that minimises `|U x - S|^2 + lambda |x / scale|^2`, in the
    /// units of the columns; `P^2` operations.
    ///
    /// # Errors
    /// [`SolveError::NotFinite`] for an overflow, [`SolveError::BadLambda`].
    pub fn solve(&self, lambda: T) -> Result<[T; P], SolveError> {
        check(lambda, self.scale)?;
        let mut x = [T::ZERO; P];
        for ((row, s2), beta) in self.rows.iter().zip(&self.square).zip(&self.beta).skip(self.free)
        {
            if *s2 > self.noise {
                let share = *beta / (*s2 + lambda);
                for (x, v) in x.iter_mut().zip(row) {
                    *x += share * *v;
                }
            }
        }
        for (x, scale) in x.iter_mut().zip(self.scale).skip(self.free) {
            *x *= *scale;
        }
        // What the free parameters make of it: the rows above.
        for k in (0..self.free).rev() {
            let of = |a: &[T; P]| a.get(k).copied().unwrap_or(T::ZERO);
            let mut value = of(&self.triangle.c);
            let behind = x.get(k + 1..).unwrap_or_default();
            for (u, x) in self.triangle.u.get(k).into_iter().flatten().zip(behind) {
                value -= *u * *x;
            }
            if self.triangle.is_dropped(k) {
                value = T::ZERO;
            }
            if let Some(x) = x.get_mut(k) {
                *x = value;
            }
        }
        if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(SolveError::NotFinite) }
    }

    /// `|U x - S|^2` of the solution for a lambda.
    #[must_use]
    pub fn residual_square(&self, lambda: T) -> T {
        let mut sum = self.triangle.outside;
        for (s2, beta) in self.square.iter().zip(&self.beta).skip(self.free) {
            let left = if *s2 > self.noise { lambda / (*s2 + lambda) } else { T::ONE };
            sum += left * left * *beta * *beta;
        }
        sum
    }

    /// `|x / scale|^2` of the solution for a lambda, penalised parameters only.
    #[must_use]
    pub fn norm_square(&self, lambda: T) -> T {
        self.directions(lambda).fold(T::ZERO, |sum, (s2, f, b)| sum + f * b / s2 * f * b)
    }

    /// The largest squared singular value.
    #[must_use]
    pub fn largest(&self) -> T {
        self.largest
    }

    /// The smallest lambda worth a look: 1e-12 of the largest squared singular
    /// value in `f64`, 1e-6 in `f32`.
    #[must_use]
    pub fn least_lambda(&self) -> T {
        self.largest * T::from_f64(if single::<T>() { 1e-6 } else { 1e-12 })
    }

    /// The corner of the L-curve (paper Eq. 15-16): the lambda of greatest
    /// curvature of log residual norm against log solution norm on a grid from
    /// [`Self::least_lambda`] to a hundred times the largest squared singular
    /// value. Points where neither axis moves by 1e-3 a decade are passed over:
    /// on a rank-deficient problem the curve stalls there. `None` when the
    /// curve has no corner.
    #[must_use]
    pub fn corner(&self) -> Option<T> {
        let decades = if single::<T>() { 6 + 2 } else { 12 + 2 };
        let mut lambda = self.least_lambda();
        let (mut most, mut best) = (T::ZERO, None);
        for _ in 0..=decades * POINTS {
            match self.curvature(lambda) {
                // Of equals the last, as the host takes it.
                Some(curvature) if curvature > T::ZERO && curvature >= most => {
                    (most, best) = (curvature, Some(lambda));
                }
                _ => {}
            }
            lambda *= T::from_f64(STEP);
        }
        best
    }

    /// Curvature of the L-curve at lambda, positive where it bends as an L
    /// does; `None` where the curve stands still.
    #[must_use]
    pub fn curvature(&self, lambda: T) -> Option<T> {
        let (two, half) = (T::from_f32(2.0), T::from_f32(0.5));
        let (rho, eta) = (self.residual_square(lambda), self.norm_square(lambda));
        // Derivatives by ln(lambda), exact: each direction of the norm falls
        // with (1 - f) = lambda / (s^2 + lambda); rho' = -lambda eta'.
        let (mut first, mut second) = (T::ZERO, T::ZERO);
        for (s2, f, b) in self.directions(lambda) {
            let part = f * b / s2 * f * b;
            let fall = lambda / (s2 + lambda);
            first -= two * part * fall;
            second += T::from_f32(6.0) * part * fall * fall;
        }
        let (eta1, eta2) = (first, first + second);
        let (rho1, rho2) = (-(lambda * eta1), -(lambda * (eta1 + eta2)));
        let log = |f: T, f1: T, f2: T| {
            let slope = f1 / f;
            (half * slope, half * (f2 / f - slope * slope))
        };
        let ((u1, u2), (v1, v2)) = (log(rho, rho1, rho2), log(eta, eta1, eta2));
        let still = T::from_f32(1e-3);
        let stalled = u1.abs() < still && v1.abs() < still;
        let speed = u1 * u1 + v1 * v1;
        let curvature = (u1 * v2 - v1 * u2) / (speed * speed.sqrt());
        (!stalled && curvature.is_finite()).then_some(curvature)
    }
}

fn single<T: Scalar>() -> bool {
    T::EPSILON > T::from_f32(1e-10)
}

/// Rotates the rows from `free` on until they are orthogonal, longest first,
/// and `beta` along; returns their squared lengths.
fn diagonalise<T: Scalar, const P: usize>(
    rows: &mut [[T; P]; P],
    beta: &mut [T; P],
    free: usize,
) -> Result<[T; P], SolveError> {
    let small = T::EPSILON * T::EPSILON * T::from_f32(P as f32);
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for j in free + 1..P {
            let Some((front, back)) = rows.split_at_mut_checked(j) else { break };
            let Some((b_front, b_back)) = beta.split_at_mut_checked(j) else { break };
            let (Some(second), Some(b_second)) = (back.first_mut(), b_back.first_mut()) else {
                break;
            };
            for (first, b_first) in front.iter_mut().zip(b_front).skip(free) {
                turned |= orthogonalise(first, second, b_first, b_second, small);
            }
        }
        if !turned {
            break;
        }
    }
    let mut square = [T::ZERO; P];
    let mut sum = T::ZERO;
    for (square, (row, beta)) in square.iter_mut().zip(rows.iter().zip(beta)).skip(free) {
        *square = dot(row, row);
        sum += *square + *beta * *beta;
    }
    if sum.is_finite() { Ok(square) } else { Err(SolveError::NotFinite) }
}

/// One Jacobi rotation; whether there was anything to turn.
fn orthogonalise<T: Scalar, const P: usize>(
    first: &mut [T; P],
    second: &mut [T; P],
    b_first: &mut T,
    b_second: &mut T,
    small: T,
) -> bool {
    let (one, two) = (T::ONE, T::from_f32(2.0));
    let (aa, bb, ab) = (dot(first, first), dot(second, second), dot(first, second));
    let sorted = aa >= bb;
    // Where a row is zero this is no number, and there is nothing to turn.
    let skew = ab.abs() / aa * (ab.abs() / bb) > small;
    if !skew && (sorted || bb <= T::ZERO) {
        return false;
    }
    // Tangent of the smaller angle that makes them orthogonal.
    let mut tangent = T::ZERO;
    if skew {
        let zeta = (bb - aa) / (two * ab);
        tangent = one / (zeta.abs() + (one + zeta * zeta).sqrt());
        if zeta < T::ZERO {
            tangent = -tangent;
        }
    }
    let cos = one / (one + tangent * tangent).sqrt();
    let sin = cos * tangent;
    let turn = |a: &mut T, b: &mut T| {
        let (x, y) = (cos * *a - sin * *b, sin * *a + cos * *b);
        // The longer one first.
        (*a, *b) = if sorted { (x, y) } else { (-y, x) };
    };
    for (a, b) in first.iter_mut().zip(second.iter_mut()) {
        turn(a, b);
    }
    turn(b_first, b_second);
    true
}

fn dot<T: Scalar, const P: usize>(a: &[T; P], b: &[T; P]) -> T {
    a.iter().zip(b).fold(T::ZERO, |sum, (a, b)| sum + *a * *b)
}
