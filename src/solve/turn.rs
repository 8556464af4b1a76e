use crate::scalar::Scalar;

/// Squares below this are zero: their inverse would overflow an `f32`.
pub(super) const TINY: f32 = 1e-37;

/// The rotations of one pivot with M rows, each by less than 45 degrees. Of the
/// pivot's row and the others `u` and `a`, `a - x u` and then `u + gain a`.
pub(super) struct Turn<T, const M: usize> {
    x: [T; M],
    gain: [T; M],
    /// What becomes of the pivot's square and the rows' weights.
    pub(super) d: T,
    pub(super) weights: [T; M],
    /// All rotations together turn by less than 45 degrees.
    pub(super) gentle: bool,
}

impl<T: Scalar, const M: usize> Turn<T, M> {
    /// Of a pivot of square `d` with the rows' elements `x` in its column.
    #[inline(always)]
    pub(super) fn new(d: T, weights: &[T; M], x: &[T; M]) -> Self {
        let none = [T::ZERO; M];
        let mut turn = Self { x: none, gain: none, d, weights: *weights, gentle: true };
        let least = least(d);
        let rows = turn.x.iter_mut().zip(&mut turn.gain).zip(&mut turn.weights);
        for (((own, gain), weight), x) in rows.zip(x) {
            let weighted = *weight * *x;
            let step = weighted * *x;
            if step > least {
                let before = turn.d;
                turn.d += step;
                let inverse = T::ONE / turn.d;
                (*own, *gain) = (*x, weighted * inverse);
                *weight *= before * inverse;
            }
        }
        turn.gentle = turn.d <= d + d;
        turn
    }

    #[inline(always)]
    pub(super) fn apply(&self, u: &mut T, a: &mut [T; M]) {
        let mut v = *u;
        for ((a, x), gain) in a.iter_mut().zip(&self.x).zip(&self.gain) {
            *a -= *x * v;
            v += *gain * *a;
        }
        *u = v;
    }
}

/// The rotations of one pivot with M rows by any angle, row by row. `pivot` and
/// `rows` are what is behind the pivot's column, with the right-hand sides.
#[cold]
#[inline(never)]
pub(super) fn turn_far<T: Scalar, const M: usize>(
    d: &mut T,
    pivot: (&mut [T], &mut T),
    x: &[T; M],
    rows: (&mut [[T; M]], &mut [T; M]),
    weights: &mut [T; M],
) {
    let least = least(*d);
    for (m, (weight, x)) in weights.iter_mut().zip(x).enumerate() {
        let weighted = *weight * *x;
        let step = weighted * *x;
        if step <= least {
            continue;
        }
        let before = *d;
        *d += step;
        let inverse = T::ONE / *d;
        let (gain, keep) = (weighted * inverse, before * inverse);
        // Beyond 45 degrees what is left of the row is counted in units of its
        // own element: its weight is then the pivot's.
        let far = step > before;
        *weight = if far { step } else { *weight } * keep;
        let (part, x) = if far { (T::ONE / *x, T::ONE) } else { (T::ONE, *x) };
        let behind = pivot.0.iter_mut().zip(rows.0.iter_mut());
        for (u, a) in behind.chain([(&mut *pivot.1, &mut *rows.1)]) {
            if let Some(a) = a.get_mut(m) {
                let u_before = *u;
                *u = keep * u_before + gain * *a;
                *a = part * *a - x * u_before;
            }
        }
    }
}

/// The square from which on a row turns a pivot of square `d`.
#[inline(always)]
fn least<T: Scalar>(d: T) -> T {
    if d > T::ZERO { T::ZERO } else { T::from_f32(TINY) }
}
