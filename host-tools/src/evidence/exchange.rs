//! Sums in which some unknowns of geometry are others, without a pass over the rows for what
//! stays.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::gram::Gram;

/// Unknowns that come into sums in the place of some.
pub struct Exchange<'e> {
    /// Which unknowns go.
    pub gone: Range<usize>,
    /// Columns of candidates that are kept, in this order.
    pub kept: &'e [usize],
    /// Products of what comes with all unknowns, with the kept columns, with itself and with
    /// the residual: a row for each that comes.
    pub products: &'e DMatrix<f64>,
    /// The residual is counted from where the unknowns that go are, and where those that come
    /// are.
    pub held: [&'e DVector<f64>; 2],
}

impl Gram {
    /// The sums with what comes in place of what goes.
    #[must_use]
    pub fn exchanged(&self, by: &Exchange) -> Self {
        let (unknowns, kept, comes) = (self.unknowns(), by.kept.len(), by.products.nrows());
        let (first, y) = (unknowns + kept, unknowns + kept + comes);
        let all = self.all(by);
        // The residual that counts from elsewhere, as a sum of columns.
        let mut residual = DVector::zeros(all.nrows());
        residual[y] = 1.0;
        by.gone.clone().zip(by.held[0].iter()).for_each(|(k, held)| residual[k] -= held);
        (first..).zip(by.held[1].iter()).for_each(|(k, held)| residual[k] += held);
        let right = &all * &residual;
        let stay = [0..by.gone.start, first..y, by.gone.end..unknowns];
        let g: Vec<usize> = stay.into_iter().flatten().collect();
        let z: Vec<usize> = (unknowns..first).collect();
        let of = |a: &[usize], b: &[usize]| all.select_columns(b).select_rows(a);
        Self {
            gg: of(&g, &g),
            gz: of(&g, &z),
            zz: of(&z, &z),
            gy: right.select_rows(&g),
            zy: right.select_rows(&z),
            yy: residual.dot(&right),
            equations: self.equations,
            repeats: self.repeats.clone(),
        }
    }

    /// Products of unknowns, kept columns, what comes and the residual, each with each.
    fn all(&self, by: &Exchange) -> DMatrix<f64> {
        let (unknowns, kept, comes) = (self.unknowns(), by.kept, by.products.nrows());
        let (first, y) = (unknowns + kept.len(), unknowns + kept.len() + comes);
        let mut all = DMatrix::zeros(y + 1, y + 1);
        all.view_mut((0, 0), (unknowns, unknowns)).copy_from(&self.gg);
        for i in 0..kept.len() {
            all.view_mut((unknowns + i, 0), (1, unknowns))
                .copy_from(&self.gz.column(kept[i]).transpose());
            (0..=i)
                .for_each(|j| all[(unknowns + i, unknowns + j)] = self.product(kept[i], kept[j]));
            all[(y, unknowns + i)] = self.zy[kept[i]];
        }
        all.view_mut((y, 0), (1, unknowns)).copy_from(&self.gy.transpose());
        all[(y, y)] = self.yy;
        all.view_mut((first, 0), (comes, y)).copy_from(&by.products.columns(0, y));
        all.view_mut((y, first), (1, comes)).copy_from(&by.products.column(y).transpose());
        all.fill_upper_triangle_with_lower_triangle();
        all
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// As if the rows had been summed with them.
    #[test]
    fn sums_are_those_of_the_rows() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for (p, gone, comes) in
            [(5, 1..3, 2), (5, 1..3, 0), (4, 0..4, 3), (3, 2..3, 4), (3, 1..1, 0)]
        {
            let mut random =
                |n: usize, m: usize| DMatrix::from_fn(n, m, |_, _| rng.random_range(-1.0..1.0));
            let (g, z, other, y) = (random(50, p), random(50, 6), random(50, comes), random(50, 1));
            let held = [random(gone.len(), 1), random(comes, 1)].map(|h| h.column(0).into_owned());
            let kept = [4, 0, 5];
            let own = z.select_columns(&kept);
            let mut all = g.clone().resize_horizontally(p + 4 + comes, 0.0);
            all.columns_mut(p, 3).copy_from(&own);
            all.columns_mut(p + 3, comes).copy_from(&other);
            all.columns_mut(p + 3 + comes, 1).copy_from(&y);
            let y = y.column(0).into_owned();
            let mut sums = Gram::new(p, 6);
            sums.add(&g, &z, &y);
            let products = other.tr_mul(&all);
            let by = Exchange {
                gone: gone.clone(),
                kept: &kept,
                products: &products,
                held: [&held[0], &held[1]],
            };
            let found = sums.exchanged(&by);
            let mut left = g.columns(0, gone.start).into_owned();
            left = left.resize_horizontally(p - gone.len() + comes, 0.0);
            left.columns_mut(gone.start, comes).copy_from(&other);
            left.columns_mut(gone.start + comes, p - gone.end)
                .copy_from(&g.columns(gone.end, p - gone.end));
            let y = y - g.columns(gone.start, gone.len()) * &held[0] + &other * &held[1];
            let mut wanted = Gram::new(left.ncols(), 3);
            wanted.add(&left, &own, &y);
            let precision = DVector::from_element(left.ncols(), 0.1);
            let [found, wanted] = [found, wanted].map(|gram| {
                let geometry = gram.geometry(&precision, 0.7);
                (gram.project(&geometry), geometry.log_det())
            });
            assert!((found.1 - wanted.1).abs() < 1e-9, "{p} {gone:?} {comes}");
            let (found, wanted) = (found.0, wanted.0);
            assert!((found.c - wanted.c).amax() < 1e-9, "{p} {gone:?} {comes}");
            assert!((found.b - wanted.b).amax() < 1e-9, "{p} {gone:?} {comes}");
            assert!((found.s - wanted.s).abs() < 1e-9, "{p} {gone:?} {comes}");
        }
    }
}
