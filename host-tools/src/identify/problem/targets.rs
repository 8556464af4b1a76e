//! How firmly a target is held where its registration has it.

use nalgebra::{Matrix3, Vector3};
use truearm::{Link, Pose};

use crate::model::Measurements;
use crate::model::arm::chain;

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
    let target = |(m, place): (usize, &Vector3<f64>)| {
        let own = data.rows.iter().filter(|row| row.marker == m);
        let turns = Turns::of(nominal, own.map(|row| &row.q[..]));
        Target { place: *place, firmness: turns.firmness() }
    };
    places.iter().enumerate().map(target).collect()
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
    /// At some joint values.
    pub fn of<'q>(links: &[Link<f64>], values: impl Iterator<Item = &'q [f64]>) -> Self {
        let flange = chain(links, Pose::identity(), Vector3::zeros());
        let mut turns = Self::default();
        values.for_each(|q| turns.add(&flange.pose(q).rotation));
        turns
    }

    /// Directions of the last frame along which a target may sit anywhere, as no turn shows it:
    /// one where all turns are about it, all three where there are none.
    #[must_use]
    pub fn blind(&self) -> Vec<Vector3<f64>> {
        let eigen = self.spread().symmetric_eigen();
        let pairs = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
        let blind = pairs.filter(|(moved, _)| moved.max(0.0).sqrt() < TURNS);
        blind.map(|(_, way)| way.into_owned()).collect()
    }

    /// One more.
    pub fn add(&mut self, turn: &Matrix3<f64>) {
        self.sum += turn;
        self.count += 1.0;
    }

    /// How firmly a target is held there, 1/m.
    #[must_use]
    pub fn firmness(&self) -> Matrix3<f64> {
        firmness(&self.spread())
    }

    /// How points spread when the target is put elsewhere by a unit: the mean of
    /// (R - mean)'(R - mean), where R'R is one.
    fn spread(&self) -> Matrix3<f64> {
        let mean = self.sum / self.count.max(1.0);
        Matrix3::identity() - mean.tr_mul(&mean)
    }
}

fn firmness(spread: &Matrix3<f64>) -> Matrix3<f64> {
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
            turns.firmness()
        };
        let along_z = |tilt: f64| 1.0 / (about(tilt) * Vector3::z()).norm();
        assert!((along_z(0.0) / (TARGET * FIRMEST) - 1.0).abs() < 1e-9);
        assert!((along_z(0.5) / TARGET - 1.0).abs() < 1e-9);
        let between = along_z(0.01);
        assert!(between > 2.0 * TARGET * FIRMEST && between < 0.8 * TARGET, "{between}");
        let across = about(0.0) * Vector3::x();
        assert!((across.norm() * TARGET - 1.0).abs() < 1e-9);
    }
}
