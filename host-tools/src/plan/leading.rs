//! Which candidates may add the most to the determinant of the information, without asking
//! all of them.
//!
//! With `M0` the information of some set and `M` that of another, `M^-1 <= c M0^-1` for the
//! largest eigenvalue `c` of `L' M^-1 L`, `M0 = L L'`. A block `B` then adds
//! `ln det(1 + B' M^-1 B) <= ln det(1 + c B' M0^-1 B) <= c ln det(1 + B' M0^-1 B)` where
//! `c >= 1`, as `ln(1 + c s) / c` falls with `c`. So what every candidate added to one set
//! bounds what it adds to the next ones of an exchange, which differ by a few poses.

use nalgebra::DMatrix;

/// Candidates that are asked first: the best of them shows which others cannot be better.
const FIRST: usize = 32;
/// Where more than this share may be best all are asked, and the bounds begin anew.
const MANY: f64 = 0.25;
/// More than rounding takes from a bound.
const ROUNDING: f64 = 1e-6;

/// What each candidate added to some set.
pub struct Leading {
    /// `L` of the set's information.
    root: DMatrix<f64>,
    /// Logarithms of what the determinant grew by.
    added: Vec<f64>,
}

impl Leading {
    /// Of the lower triangle of the set's information, and by what the determinant grows with
    /// each candidate.
    pub fn new(root: DMatrix<f64>, gains: &[f64]) -> Self {
        Self { root, added: gains.iter().map(|gain| gain.ln()).collect() }
    }

    /// Bounds of the same for a set whose information has this inverse.
    fn bounds(&self, inverse: &DMatrix<f64>) -> Vec<f64> {
        let ratio = self.root.tr_mul(&(inverse * &self.root)).symmetric_eigenvalues().max();
        let factor = f64::max(ratio, 1.0) * (1.0 + ROUNDING);
        self.added.iter().map(|added| factor * added + ROUNDING).collect()
    }

    /// Those of the candidates in `open` that may be the best addition to a set with this
    /// inverse, and `now`; in their order. None where they are too many.
    pub fn candidates(
        &self,
        inverse: &DMatrix<f64>,
        (open, now): (&[bool], usize),
        gains: impl Fn(&[usize]) -> Vec<f64>,
    ) -> Option<Vec<usize>> {
        let bounds = self.bounds(inverse);
        let mut all: Vec<usize> = (0..bounds.len()).filter(|k| open[*k]).collect();
        if all.len() <= FIRST {
            return None;
        }
        all.select_nth_unstable_by(FIRST, |a, b| bounds[*b].total_cmp(&bounds[*a]));
        let mut first = all[..FIRST].to_vec();
        first.push(now);
        let known = gains(&first).into_iter().fold(0.0, f64::max).ln();
        all.retain(|k| bounds[*k] >= known || *k == now);
        all.sort_unstable();
        (all.len() as f64 <= MANY * bounds.len() as f64).then_some(all)
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    const SIZE: usize = 12;
    const WIDTH: usize = 3;
    const COUNT: usize = 400;

    fn gains(inverse: &DMatrix<f64>, blocks: &[DMatrix<f64>]) -> Vec<f64> {
        let one = DMatrix::identity(WIDTH, WIDTH);
        blocks.iter().map(|b| (&one + b.tr_mul(&(inverse * b))).determinant()).collect()
    }

    /// Whatever sets are compared, the best is among those that are asked; of sets that differ
    /// by an exchange few are.
    #[test]
    fn the_best_is_asked() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for size in [5, 20, 100] {
            let mut block = || DMatrix::from_fn(SIZE, WIDTH, |_, _| rng.random_range(-1.0..1.0));
            let blocks: Vec<DMatrix<f64>> = (0..COUNT).map(|_| block()).collect();
            let information = |set: &[usize]| {
                let prior = DMatrix::identity(SIZE, SIZE) * 1e-3;
                set.iter().fold(prior, |sum, k| sum + &blocks[*k] * blocks[*k].transpose())
            };
            let first: Vec<usize> = (0..size).collect();
            let root = information(&first).cholesky().unwrap();
            let leading = Leading::new(root.l(), &gains(&root.inverse(), &blocks));
            let mut some = 0;
            for changed in [1, size / 2, size] {
                let set: Vec<usize> = (changed..size + changed).collect();
                let inverse = information(&set).cholesky().unwrap().inverse();
                let all = gains(&inverse, &blocks);
                let now = changed + size - 1;
                let open: Vec<bool> = (0..COUNT).map(|k| k == now || !set.contains(&k)).collect();
                let of = |asked: &[usize]| asked.iter().map(|k| all[*k]).collect();
                let best =
                    (0..COUNT).filter(|k| open[*k]).max_by(|a, b| all[*a].total_cmp(&all[*b]));
                if let Some(asked) = leading.candidates(&inverse, (&open, now), of) {
                    some += 1;
                    assert!(asked.contains(&best.unwrap()) && asked.contains(&now));
                    assert!(asked.is_sorted() && asked.iter().all(|k| open[*k]));
                }
            }
            assert!(size < 100 || some > 0, "{size}: {some}");
        }
    }
}
