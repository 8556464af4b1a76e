//! Rows by fold and by half, so that sums over any of them are sums of parts.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::diagnose::question::Question;
use crate::evidence::Gram;
use crate::identify::folds;

/// Rows by fold and by half, at random and in time.
pub struct Parts {
    /// Rows of each part.
    pub rows: Vec<Vec<usize>>,
    /// Its fold.
    pub fold: Vec<usize>,
    /// Which half, of each kind of halves.
    pub half: Vec<[usize; 2]>,
}

impl Parts {
    /// Of the rows that are kept.
    #[must_use]
    pub fn new(q: &Question, kept: &[usize]) -> Self {
        let data = q.problem.data;
        let mut fold_of = vec![0; data.rows.len()];
        for (k, fold) in q.folds.iter().enumerate() {
            fold.held_out.iter().for_each(|row| fold_of[*row] = k);
        }
        let mut random_half = vec![0; data.rows.len()];
        let mut poses: Vec<usize> = (0..data.poses).collect();
        poses.shuffle(&mut ChaCha8Rng::seed_from_u64(folds::SEED + 2));
        let second = &poses[data.poses / 2..];
        kept.iter()
            .for_each(|r| random_half[*r] = usize::from(second.contains(&data.rows[*r].pose)));
        // Poses in the order of the rows: the second half of a session.
        let middle = data.poses / 2;
        let mut out = Self { rows: Vec::new(), fold: Vec::new(), half: Vec::new() };
        for row in kept {
            let half = [random_half[*row], usize::from(data.rows[*row].pose >= middle)];
            let fold = fold_of[*row];
            let known = (0..out.rows.len()).find(|k| out.fold[*k] == fold && out.half[*k] == half);
            match known {
                Some(k) => out.rows[k].push(*row),
                None => {
                    out.rows.push(vec![*row]);
                    out.fold.push(fold);
                    out.half.push(half);
                }
            }
        }
        out
    }
}

/// The sum of the sums of some parts, of so many unknowns and columns.
#[must_use]
pub fn joined<'g>(grams: impl Iterator<Item = &'g Gram>, [unknowns, columns]: [usize; 2]) -> Gram {
    let mut sum = Gram::new(unknowns, columns);
    grams.for_each(|gram| sum.join(gram));
    sum
}
