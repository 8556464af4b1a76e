//! How far an effect is from nothing and from whatever else could stand in its place,
//! in standard deviations of its own Cramer-Rao bound: what anyone could tell who is
//! told everything else.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

/// So far from nothing and from any one rival an effect can be told: 18 nats are
/// expected. Odds of nine to one, a name's 0.08 shared by up to thirty places, five sizes
/// and a coefficient or two cost 11 to 16, and the rest is for the noise of one session.
pub const TOLD: f64 = 6.0;

/// Share of its square by which a column is held that others imitate.
const HELD: f64 = 1e-9;

/// Standard deviations.
#[derive(Debug, Clone)]
pub struct Apart {
    pub from_nothing: f64,
    pub from_rivals: Vec<f64>,
}

impl Apart {
    /// From nothing or the nearest rival.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.from_rivals.iter().copied().fold(self.from_nothing, f64::min)
    }
}

/// Of the column `own` of a Gram matrix, the columns `beside` being free: equations count
/// standard deviations, and what is known beforehand is in the diagonal.
#[must_use]
pub fn apart(gram: &DMatrix<f64>, own: usize, beside: &[usize], rivals: &[Range<usize>]) -> Apart {
    let rest = Rest::of(gram, beside);
    let own = rest.column(own);
    let alone = rest.product(&own, &own).max(0.0);
    let with = |rival: &Range<usize>| {
        let theirs: Vec<_> = rival.clone().map(|k| rest.column(k)).collect();
        let mut h = DMatrix::from_fn(theirs.len(), theirs.len(), |i, j| {
            rest.product(&theirs[i], &theirs[j])
        });
        rival.clone().enumerate().for_each(|(k, at)| h[(k, k)] += HELD * gram[(at, at)]);
        let shared = DVector::from_fn(theirs.len(), |k, _| rest.product(&theirs[k], &own));
        let taken = h.cholesky().map_or(0.0, |factor| shared.dot(&factor.solve(&shared)));
        (alone - taken).max(0.0).sqrt()
    };
    Apart { from_nothing: alone.sqrt(), from_rivals: rivals.iter().map(with).collect() }
}

/// Columns of groups that stand one after another from `first` on.
#[must_use]
pub fn runs(first: usize, lengths: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let run = |next: &mut usize, length: usize| {
        let start = *next;
        *next += length;
        Some(start..*next)
    };
    lengths.scan(first, run).collect()
}

/// What free columns leave of the others.
struct Rest<'g> {
    gram: &'g DMatrix<f64>,
    beside: &'g [usize],
    /// Lengths of the free columns, and the triangle of their Gram matrix at length one.
    lengths: Vec<f64>,
    triangle: DMatrix<f64>,
}

impl<'g> Rest<'g> {
    fn of(gram: &'g DMatrix<f64>, beside: &'g [usize]) -> Self {
        let lengths: Vec<f64> =
            beside.iter().map(|k| gram[(*k, *k)].sqrt().max(f64::MIN_POSITIVE)).collect();
        let mut h = DMatrix::from_fn(beside.len(), beside.len(), |i, j| {
            gram[(beside[i], beside[j])] / lengths[i] / lengths[j]
        });
        (0..beside.len()).for_each(|k| h[(k, k)] = 1.0 + HELD);
        let triangle = h.cholesky().map_or_else(|| DMatrix::identity(0, 0), |f| f.unpack());
        Self { gram, beside, lengths, triangle }
    }

    /// A column's number, and its part along the free ones.
    fn column(&self, k: usize) -> (usize, DVector<f64>) {
        let along = self.beside.iter().zip(&self.lengths);
        let along = DVector::from_iterator(
            self.beside.len(),
            along.map(|(b, length)| self.gram[(*b, k)] / length),
        );
        (k, self.triangle.solve_lower_triangular(&along).unwrap_or(along))
    }

    fn product(&self, a: &(usize, DVector<f64>), b: &(usize, DVector<f64>)) -> f64 {
        self.gram[(a.0, b.0)] - a.1.dot(&b.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_can_do_is_not_told() {
        let columns = DMatrix::from_columns(&[
            DVector::from_vec(vec![3.0, 4.0, 12.0]),
            DVector::from_vec(vec![0.0, 0.0, 2.0]),
            DVector::from_vec(vec![0.0, 0.1, 0.0]),
            DVector::from_vec(vec![9.0, 12.0, 1.0]),
        ]);
        let gram = columns.tr_mul(&columns);
        let Apart { from_nothing, from_rivals } = apart(&gram, 0, &[1], &[2..3, 3..4]);
        assert!((from_nothing - 5.0).abs() < 1e-6);
        assert!((from_rivals[0] - 3.0).abs() < 1e-6 && from_rivals[1] < 1e-3, "{from_rivals:?}");
        assert!((apart(&gram, 0, &[], &[]).least() - 13.0).abs() < 1e-9);
    }
}
