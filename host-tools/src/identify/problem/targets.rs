//! How firmly a target is held where its registration has it.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, Matrix3, Vector3};
use truearm::{Link, Pose};

use crate::model::arm::chain;
use crate::model::{Measurements, Row};
use crate::observations::kind;

/// Standard deviation of where a target sits about its registration, m: what rows determine
/// they determine far better, and they may say that the tool of the robot file is elsewhere.
const TARGET: f64 = 0.1;
/// A target that moves by less than this share when it is put elsewhere on the flange, but
/// for what the base takes up, is held in proportion...
const TURNS: f64 = 0.02;
/// ...down to this share: where no row turns the flange about another axis than the first
/// joints do, as of a SCARA, the height of base and tool is one unknown, and what decided
/// between them were errors of the model: tools 0.6 m off.
const FIRMEST: f64 = 0.02;

/// Share of its precision that a target keeps which others alike can take up.
const TAKEN_UP: f64 = 1e-8;

/// Where a target sits.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// In the last frame, m.
    pub place: Vector3<f64>,
    /// Root of the precision of what it is off by, 1/m.
    pub firmness: Matrix3<f64>,
}

/// Of all markers, where registration has them.
pub fn of(data: &Measurements, nominal: &[Link<f64>], places: &[Vector3<f64>]) -> Vec<Target> {
    let target = |(place, spread)| Target { place, firmness: firmness(&spread) };
    places.iter().copied().zip(spreads_of(data, nominal)).map(target).collect()
}

/// The spreads of the markers of some rows.
pub fn spreads_of(data: &Measurements, nominal: &[Link<f64>]) -> Vec<Matrix3<f64>> {
    let flange = chain(nominal, Pose::identity(), Vector3::zeros());
    let markers = data.markers.len();
    // What tells no point, and of what it refers to, by itself.
    let frame = |row: &Row| match kind(row).point(row) {
        Some(_) => (row.station, None, None),
        None => (row.station, Some(row.kind), row.refers.first().copied()),
    };
    let mut frames = BTreeMap::new();
    for row in &data.rows {
        let own = frames.entry(frame(row)).or_insert_with(|| vec![Turns::default(); markers]);
        own[row.marker].add(&flange.pose(&row.q).rotation);
    }
    let turns: Vec<Turns> = frames.into_values().flatten().collect();
    let known = |m: usize| data.known_markers.get(m).copied().flatten().is_some();
    spreads(&turns, markers, &known)
}

/// How points spread when a target is put elsewhere on the flange by a unit, the place of
/// what they are measured in taken up and other targets, too, that are not known: 1 where all
/// of it is seen. `turns` are those of each such frame, one of every marker in turn.
#[must_use]
pub fn spreads(
    turns: &[Turns],
    markers: usize,
    known: &dyn Fn(usize) -> bool,
) -> Vec<Matrix3<f64>> {
    let mut all = DMatrix::zeros(3 * markers, 3 * markers);
    let mut counts = vec![0.0; markers];
    for frame in turns.chunks(markers.max(1)) {
        let total: f64 = frame.iter().map(|turns| turns.count).sum();
        for (m, a) in frame.iter().enumerate().filter(|(_, a)| a.count > 0.0) {
            counts[m] += a.count;
            let mut own = all.fixed_view_mut::<3, 3>(3 * m, 3 * m);
            own += Matrix3::identity() * a.count;
            for (n, b) in frame.iter().enumerate() {
                let mut block = all.fixed_view_mut::<3, 3>(3 * m, 3 * n);
                block -= a.sum.tr_mul(&b.sum) / total;
            }
        }
    }
    let spread = |m: usize| {
        let own = all.fixed_view::<3, 3>(3 * m, 3 * m).into_owned();
        let others: Vec<usize> = (0..markers)
            .filter(|n| *n != m && !known(*n) && counts[*n] > 0.0)
            .flat_map(|n| 3 * n..3 * n + 3)
            .collect();
        let mut between = all.select_columns(&others).select_rows(&others);
        for (i, other) in others.iter().enumerate() {
            between[(i, i)] += TAKEN_UP * counts[other / 3];
        }
        let across = all.select_columns(&others).rows(3 * m, 3).into_owned();
        let taken = between.cholesky().map(|factor| &across * factor.solve(&across.transpose()));
        let taken = taken.map_or_else(Matrix3::zeros, |t| t.fixed_view::<3, 3>(0, 0).into_owned());
        (own - taken) / counts[m].max(1.0)
    };
    (0..markers).map(spread).collect()
}

/// How the last frame was turned in some rows: all that is needed of them is their sum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turns {
    /// Sum of the rotations.
    pub sum: Matrix3<f64>,
    /// How many they are.
    pub count: f64,
}

impl Turns {
    /// One more.
    pub fn add(&mut self, turn: &Matrix3<f64>) {
        self.sum += turn;
        self.count += 1.0;
    }
}

/// How firmly a target of this spread is held, 1/m.
#[must_use]
pub fn firmness(spread: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = spread.symmetric_eigen();
    let root = eigen
        .eigenvalues
        .map(|moved| 1.0 / (TARGET * (moved.max(0.0).sqrt() / TURNS).clamp(FIRMEST, 1.0)));
    eigen.eigenvectors * Matrix3::from_diagonal(&root) * eigen.eigenvectors.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wrist that turns about everything, one that only turns about z, and between them.
    #[test]
    fn held_along_what_no_row_turns() {
        let turn = |axis: Vector3<f64>, angle: f64| {
            Pose::from_rotation_vector(Vector3::zeros(), axis * angle).rotation
        };
        let about = |tilt: f64| {
            let of = |k: usize| {
                turn(Vector3::x(), tilt * (k as f64).sin()) * turn(Vector3::z(), 0.7 * k as f64)
            };
            let mut turns = Turns::default();
            (0..40).for_each(|k| turns.add(&of(k)));
            firmness(&spreads(&[turns], 1, &|_| false)[0])
        };
        let along_z = |tilt: f64| 1.0 / (about(tilt) * Vector3::z()).norm();
        assert!((along_z(0.0) / (TARGET * FIRMEST) - 1.0).abs() < 1e-9);
        assert!((along_z(0.5) / TARGET - 1.0).abs() < 1e-9);
        let between = along_z(0.01);
        assert!(between > 2.0 * TARGET * FIRMEST && between < 0.8 * TARGET, "{between}");
        let across = about(0.0) * Vector3::x();
        assert!((across.norm() * TARGET - 1.0).abs() < 1e-9);
    }

    /// Two markers in frames of their own: what is seen is what neither the frames nor the
    /// other marker can take up.
    #[test]
    fn what_frames_and_other_markers_take_up_is_not_seen() {
        let turned = |k: usize| {
            Pose::from_rotation_vector(
                Vector3::zeros(),
                Vector3::new((k as f64).sin(), (2.0 * k as f64).cos(), 0.7 * k as f64),
            )
            .rotation
        };
        let of = |from: usize, by: usize| {
            let mut turns = Turns::default();
            (0..30).for_each(|k| turns.add(&turned(from + by * k)));
            turns
        };
        let (still, moving, none) = (|k| of(k, 0), of(0, 1), Turns::default());
        let seen = |turns: &[Turns], known: bool| -> [f64; 2] {
            let spreads = spreads(turns, 2, &|m| known && m == 1);
            [0, 1].map(|m| spreads[m].symmetric_eigen().eigenvalues.min().max(0.0).sqrt())
        };
        // One orientation in each station, whatever they are.
        assert!(seen(&[still(1), none, still(5), none], false)[0] < 1e-3);
        assert!(seen(&[moving, none, still(5), none], false)[0] > 0.2);
        // Beside one that tells where the station stands one orientation is enough, ...
        let [a, b] = seen(&[still(1), moving], false);
        assert!(a > 0.3 && b > 0.3, "{a} {b}");
        // ...beside one that does not it is not, unless that one is known.
        let [a, b] = seen(&[still(1), still(4)], false);
        assert!(a < 1e-3 && b < 1e-3, "{a} {b}");
        assert!(seen(&[still(1), still(4)], true)[0] > 0.3);
    }
}
