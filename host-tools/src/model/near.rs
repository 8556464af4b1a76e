//! When two poses are one, or near each other.

use std::collections::HashMap;

use truearm::JointKind;

use super::Robot;
use crate::units::joint_from_file;

/// Edge of a cell, in reaches: wide, so that few points lie within reach of a
/// second cell, and narrow, so that few are in one.
const EDGE: f64 = 16.0;
/// Where the cells begin, in edges: joints rest at round angles, and round
/// angles must not all lie on a face.
const ORIGIN: f64 = 0.381_966;

/// Rows whose joints agree within this are one pose, degrees or mm.
pub const ONE_POSE: f64 = 0.01;

/// The same of a joint, rad or m.
#[must_use]
pub fn one_pose(kind: JointKind) -> f64 {
    joint_from_file(kind, ONE_POSE)
}

/// How far apart points may be to count as near, a coordinate at a time.
#[derive(Debug, Clone)]
pub struct Reach(Vec<f64>);

impl Reach {
    /// In joint space: within `angle` (rad) of every revolute joint and
    /// `length` (m) of every prismatic one.
    #[must_use]
    pub fn of_joints(robot: &Robot, angle: f64, length: f64) -> Self {
        let of = |kind| match kind {
            JointKind::Revolute => angle,
            JointKind::Prismatic => length,
        };
        Self(robot.joints.iter().map(|joint| of(joint.link.kind)).collect())
    }

    /// Within which the joint values of a robot are of one pose.
    #[must_use]
    pub fn of_pose(robot: &Robot) -> Self {
        Self(robot.joints.iter().map(|joint| one_pose(joint.link.kind)).collect())
    }

    /// The same in every coordinate.
    #[must_use]
    pub fn uniform(coordinates: usize, reach: f64) -> Self {
        Self(vec![reach; coordinates])
    }

    /// Whether two points are near each other.
    #[must_use]
    pub fn near(&self, a: &[f64], b: &[f64]) -> bool {
        a.iter().zip(b).zip(&self.0).all(|((a, b), reach)| (a - b).abs() <= *reach)
    }

    /// Numbers points in order of appearance, near ones alike: a point has the
    /// number of the earliest first point of a number that is near it. Also how
    /// many numbers there are.
    #[must_use]
    pub fn number<'a>(&self, points: impl IntoIterator<Item = &'a [f64]>) -> (Vec<usize>, usize) {
        // Of each cell the last number that began in it, and of each number the one before
        // it in its cell: nothing small is allocated, of however many points.
        let (mut last, mut before) = (HashMap::new(), Vec::new());
        let (mut firsts, mut around): (Vec<&[f64]>, Vec<u64>) = (Vec::new(), Vec::new());
        let numbers = points.into_iter().map(|point| {
            self.cells(point, &mut around);
            let mut found: Option<usize> = None;
            for cell in &around {
                let mut next: Option<usize> = last.get(cell).copied();
                while let Some(k) = next {
                    if self.near(firsts[k], point) {
                        found = Some(found.map_or(k, |found| found.min(k)));
                    }
                    next = before[k];
                }
            }
            found.unwrap_or_else(|| {
                firsts.push(point);
                before.push(last.insert(around[0], firsts.len() - 1));
                firsts.len() - 1
            })
        });
        let numbers = numbers.collect();
        (numbers, firsts.len())
    }

    /// Hashes of the cell of a point, then of every other one in which a near point may
    /// be. Two cells of one hash cost a comparison more.
    fn cells(&self, point: &[f64], hashes: &mut Vec<u64>) {
        hashes.clear();
        hashes.push(0);
        // A little more than a reach: divisions round.
        let margin = 1.001 / EDGE;
        for (axis, (x, reach)) in point.iter().zip(&self.0).enumerate() {
            let place = x / (reach * EDGE) + ORIGIN;
            let (own, inside) = (place.floor(), place - place.floor());
            let step = i64::from(inside > 1.0 - margin) - i64::from(inside < margin);
            let own = own as i64;
            let cells = hashes.len();
            if step != 0 {
                let beyond = mixed(own.saturating_add(step), axis);
                hashes.extend_from_within(..);
                hashes[cells..].iter_mut().for_each(|hash| *hash = hash.wrapping_add(beyond));
            }
            let own = mixed(own, axis);
            hashes[..cells].iter_mut().for_each(|hash| *hash = hash.wrapping_add(own));
        }
    }
}

/// Edge of a cell of joint values, rad or m: a pose read again is mostly in the same one. It is
/// [`ONE_POSE`] but for a last bit, which decides to what cell a joint at half a hundredth of a
/// degree belongs: rows must fall into the folds that parts written before have.
const CELL: [f64; 2] = [1.745_329_251_994_33e-4, 1e-5];

/// Hash of the cell of joint values alone, so that rows that are read apart agree.
#[must_use]
pub fn cell(q: &[f64], joints: impl IntoIterator<Item = JointKind>) -> u64 {
    let edge = |kind| match kind {
        JointKind::Revolute => CELL[0],
        JointKind::Prismatic => CELL[1],
    };
    let cells = q.iter().zip(joints).map(|(q, kind)| (q / edge(kind)).round() as i64);
    // FNV-1a
    cells.flat_map(i64::to_le_bytes).fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A coordinate of a cell as a part of its hash (the finaliser of SplitMix64).
fn mixed(cell: i64, axis: usize) -> u64 {
    let mut z = (cell as u64).wrapping_add(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(axis as u64 + 1));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use proptest::prelude::*;

    use super::*;

    /// What the numbers mean, without cells.
    fn plain(reach: &Reach, points: &[Vec<f64>]) -> (Vec<usize>, usize) {
        let mut firsts: Vec<&[f64]> = Vec::new();
        let number = |point| {
            firsts.iter().position(|first| reach.near(first, point)).unwrap_or_else(|| {
                firsts.push(point);
                firsts.len() - 1
            })
        };
        let numbers = points.iter().map(Vec::as_slice).map(number).collect();
        (numbers, firsts.len())
    }

    proptest! {
        /// Points on a grid of half reaches, so that many lie exactly a reach
        /// apart, and some off it.
        #[test]
        fn cells_change_no_number(
            points in prop::collection::vec(prop::collection::vec((-40..40_i32, 0..3_i32), 3), 1..120),
        ) {
            let reach = Reach(vec![0.5, 0.25, 2.0]);
            let coordinate = |((steps, off), reach): (&(i32, i32), &f64)| {
                f64::from(*steps) * reach / 2.0 + f64::from(*off) * reach * 1e-9
            };
            let points: Vec<Vec<f64>> =
                points.iter().map(|p| p.iter().zip(&reach.0).map(coordinate).collect()).collect();
            prop_assert_eq!(reach.number(points.iter().map(Vec::as_slice)), plain(&reach, &points));
        }
    }

    /// Rows of a file in which joint 1 stands still, every second one a
    /// repetition of the one before.
    #[test]
    fn many_poses_are_numbered_soon() {
        let count = 60_000;
        let q = |i: usize| vec![0.0, i as f64 * 1e-3, (i % 97) as f64 * 0.02, 0.5, 0.0, 1.0];
        let points: Vec<Vec<f64>> = (0..count).map(|i| q(i / 2)).collect();
        let start = Instant::now();
        let (numbers, poses) = Reach::uniform(6, 1.7e-4).number(points.iter().map(Vec::as_slice));
        assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
        assert_eq!(poses, count / 2);
        assert!(numbers.iter().enumerate().all(|(i, number)| *number == i / 2));
    }
}
