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

/// Poses from which a fit of many more begins: the whole then takes two or three
/// passes where it took dozens. With 2,000 a pass over them costs little, and what they
/// leave open of the arm is a few hundredths of what they determine.
const SAMPLE: usize = 2000;
/// Rows of a station, marker or instrument that say where it is beyond doubt.
const LEAST: usize = 30;

/// Rows to fit and rows to judge.
#[derive(Debug, Clone)]
pub struct Fold {
    /// Rows to fit.
    pub fit: Vec<usize>,
    /// Rows to judge by.
    pub held_out: Vec<usize>,
}

/// Rows of some random poses, to begin with; `None` where there are not twice as many
/// poses, or a station, marker or instrument would be told by a few rows only.
#[must_use]
pub fn sample(data: &Measurements, rows: &[usize]) -> Option<Vec<usize>> {
    let mut poses = poses(data, rows);
    if poses.len() <= 2 * SAMPLE {
        return None;
    }
    poses.shuffle(&mut ChaCha8Rng::seed_from_u64(SEED + 2));
    let mut taken = vec![false; data.poses];
    poses[..SAMPLE].iter().for_each(|pose| taken[*pose] = true);
    let some: Vec<usize> = rows.iter().copied().filter(|r| taken[data.rows[*r].pose]).collect();
    let told = |rows: &[usize]| {
        let (stations, markers) = (data.stations.len(), data.markers.len());
        let mut told = vec![0; stations + markers + data.instruments.len()];
        for row in rows.iter().map(|row| &data.rows[*row]) {
            told[row.station] += 1;
            told[stations + row.marker] += 1;
            row.refers.iter().for_each(|i| told[stations + markers + i] += 1);
        }
        told
    };
    let enough = |(all, some): (usize, usize)| all == 0 || some >= LEAST;
    told(rows).into_iter().zip(told(&some)).all(enough).then_some(some)
}

/// The poses of some rows, each once.
fn poses(data: &Measurements, rows: &[usize]) -> Vec<usize> {
    let mut poses: Vec<usize> = rows.iter().map(|r| data.rows[*r].pose).collect();
    poses.sort_unstable();
    poses.dedup();
    poses
}

/// Random folds of poses, or leave-one-out for few poses; only of `rows`.
#[must_use]
pub fn random(data: &Measurements, rows: &[usize], seed: u64) -> Vec<Fold> {
    let mut poses = poses(data, rows);
    let count = if poses.len() < LEAVE_ONE_OUT_BELOW { poses.len() } else { FOLDS };
    poses.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    split(data, rows, &poses, count, |place, _| place % count)
}

/// Folds of poses that were measured one after another, by `time_s` or else `order`; `None`
/// where a row has neither. They show what a drift hides from random folds.
#[must_use]
pub fn blocked(data: &Measurements, rows: &[usize]) -> Option<Vec<Fold>> {
    if !rows.iter().all(|row| data.rows[*row].clock().is_some()) {
        return None;
    }
    let place = data.places();
    let mut at = rows.to_vec();
    at.sort_by(|a, b| place[*a].total_cmp(&place[*b]));
    let mut seen = vec![false; data.poses];
    let poses: Vec<usize> = at
        .into_iter()
        .map(|row| data.rows[row].pose)
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
