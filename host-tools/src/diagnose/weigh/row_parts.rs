//! Rows by fold and by half, so that sums over any of them are sums of parts.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::diagnose::question::Question;
use crate::evidence::Gram;
use crate::identify::fit::folds;
use crate::model::Measurements;

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
        let mut half_of_pose = vec![0; data.poses];
        poses[data.poses / 2..].iter().for_each(|pose| half_of_pose[*pose] = 1);
        kept.iter().for_each(|r| random_half[*r] = half_of_pose[data.rows[*r].pose]);
        // Poses in the order of measurement, of each kind: the second half of a session.
        let later = later(data, kept);
        let mut out = Self { rows: Vec::new(), fold: Vec::new(), half: Vec::new() };
        for row in kept {
            let half = [random_half[*row], later[*row]];
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

    /// The parts of one half of a kind.
    pub fn of_half(&self, kind: usize, half: usize) -> impl Iterator<Item = usize> {
        (0..self.half.len()).filter(move |part| self.half[*part][kind] == half)
    }

    /// Their rows.
    #[must_use]
    pub fn rows_of_half(&self, kind: usize, half: usize) -> Vec<usize> {
        self.of_half(kind, half).flat_map(|part| self.rows[part].clone()).collect()
    }
}

/// Of each row 1 if its pose is in the second half of those of its kind, else 0.
fn later(data: &Measurements, kept: &[usize]) -> Vec<usize> {
    let place = data.places();
    let mut out = vec![0; data.rows.len()];
    let mut rows = kept.to_vec();
    rows.sort_by_key(|r| (data.rows[*r].kind.0, data.rows[*r].pose));
    for kind in rows.chunk_by(|a, b| data.rows[*a].kind == data.rows[*b].kind) {
        let first = |pose: &[usize]| pose.iter().map(|r| place[*r]).fold(f64::MAX, f64::min);
        let mut poses: Vec<&[usize]> =
            kind.chunk_by(|a, b| data.rows[*a].pose == data.rows[*b].pose).collect();
        poses.sort_by(|a, b| first(a).total_cmp(&first(b)));
        poses[poses.len() / 2..].concat().into_iter().for_each(|row| out[row] = 1);
    }
    out
}

/// The sum of the sums of some parts, of so many unknowns and columns.
#[must_use]
pub fn joined<'g>(grams: impl Iterator<Item = &'g Gram>, [unknowns, columns]: [usize; 2]) -> Gram {
    let mut sum = Gram::new(unknowns, columns);
    grams.for_each(|gram| sum.join(gram));
    sum
}
