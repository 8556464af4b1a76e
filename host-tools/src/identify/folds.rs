//! Which rows are held out together. Rows of one pose share a fold, whatever
//! their marker or station, or the held-out error would be flattered.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::model::Measurements;

/// Below this many poses every pose is a fold of its own.
pub const LEAVE_ONE_OUT_BELOW: usize = 30;
/// Folds otherwise.
pub const FOLDS: usize = 5;
/// Fixed, so that a report can be made again.
pub const SEED: u64 = 2022;

/// Rows to fit and rows to judge.
#[derive(Debug, Clone)]
pub struct Fold {
    /// Rows to fit.
    pub fit: Vec<usize>,
    /// Rows to judge by.
    pub held_out: Vec<usize>,
}

/// Random folds of poses, or leave-one-out for few poses; only of `rows`.
#[must_use]
pub fn random(data: &Measurements, rows: &[usize], seed: u64) -> Vec<Fold> {
    let mut poses: Vec<usize> = rows.iter().map(|r| data.rows[*r].pose).collect();
    poses.sort_unstable();
    poses.dedup();
    let count = if poses.len() < LEAVE_ONE_OUT_BELOW { poses.len() } else { FOLDS };
    poses.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    split(data, rows, &poses, count, |place, _| place % count)
}

/// Folds of poses that were measured one after another, by `order` or else
/// `time_s`; `None` when neither is complete. They show what a drift hides
/// from random folds.
#[must_use]
pub fn blocked(data: &Measurements, rows: &[usize]) -> Option<Vec<Fold>> {
    let column = |f: fn(&crate::model::Row) -> Option<f64>| {
        rows.iter().map(|r| f(&data.rows[*r])).collect::<Option<Vec<f64>>>()
    };
    let key = column(|r| r.order).or_else(|| column(|r| r.time))?;
    let mut at: Vec<(f64, usize)> =
        key.into_iter().zip(rows).map(|(k, r)| (k, data.rows[*r].pose)).collect();
    at.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut seen = vec![false; data.poses];
    let poses: Vec<usize> = at
        .into_iter()
        .map(|(_, pose)| pose)
        .filter(|pose| !std::mem::replace(&mut seen[*pose], true))
        .collect();
    let count = FOLDS.min(poses.len());
    Some(split(data, rows, &poses, count, |place, total| place * count / total))
}

fn split(
    data: &Measurements,
    rows: &[usize],
    poses: &[usize],
    count: usize,
    fold_of: impl Fn(usize, usize) -> usize,
) -> Vec<Fold> {
    let mut fold = vec![0; data.poses];
    for (place, pose) in poses.iter().enumerate() {
        fold[*pose] = fold_of(place, poses.len());
    }
    let part = |k: usize| {
        let (held_out, fit) = rows.iter().partition(|r| fold[data.rows[**r].pose] == k);
        Fold { fit, held_out }
    };
    (0..count).map(part).collect()
}
