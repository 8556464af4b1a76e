//! Joints for a pose of the tool, by damped least squares.
//!
//! Each step minimises `|J x - e|^2 + mu |x|^2`, e the way and the turn that are
//! left, the turn weighed by a length, J the geometric Jacobian; mu falls where a
//! step is good and rises where it is not (Levenberg and Marquardt), so that what
//! is left never grows and singular poses are no obstacle. A joint at a limit that
//! would go beyond takes no part. Rows follow each other: each starts at the row before,
//! and only what is not reached from there is looked for from elsewhere.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;

use super::forward::{Forward, turn};
use crate::model::{Measurements, Robot, Row, Target};

/// A pose is reached within this of its point, m.
pub const REACHED_POINT: f64 = 1e-6;
/// And within this of its axes, rad: what three decimals of a degree say.
pub const REACHED_ANGLE: f64 = 1e-5;
/// Weighs an angle against a length, m, as the law of compensation does.
const ROTATION_LENGTH: f64 = 0.3;
const MOST_STEPS: usize = 200;
/// Largest step of a joint, rad or m: within it a Jacobian says something.
const LONGEST_STEP: f64 = 0.3;
/// Squares of what is left that are rounding, m^2.
const ROUNDING: f64 = 1e-26;
/// Beside the row before: starts near it, for rows that begin in a singular pose.
const NEAR_STARTS: usize = 4;
/// Starts anywhere within the limits, for a first row without a start and for what
/// the row before does not lead to.
const ANY_STARTS: usize = 100;
/// Rows in a row that none of them led to, after which fewer are tried: a long path
/// beyond the arm's reach is to be called so soon.
const PATIENCE: usize = 20;
/// How many then.
const FEW_STARTS: usize = 15;

/// Joints that were found for a pose, and what is left.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// rad or m, within the limits.
    pub joints: Vec<f64>,
    /// Of the point, m.
    pub position: f64,
    /// Of the axes, rad; 0 where only the position counts.
    pub rotation: f64,
}

impl Found {
    /// Whether the tool is where it is to be.
    #[must_use]
    pub fn is_reached(&self) -> bool {
        self.position <= REACHED_POINT && self.rotation <= REACHED_ANGLE
    }

    fn left(&self) -> f64 {
        self.position.hypot(self.rotation * ROTATION_LENGTH)
    }
}

/// A path of poses as joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Of each row the joints, or the nearest that was found.
    pub rows: Vec<Found>,
    /// Whether the configuration of the first row was chosen here.
    pub chosen: bool,
    /// Rows, from 0, that no way leads to from the row before, or from the start,
    /// but that are reached from elsewhere: the robot has to change its
    /// configuration.
    pub jumps: Vec<usize>,
}

/// Solves for the joints of an arm.
pub struct Inverse<'a> {
    pub(super) forward: &'a Forward,
    pub(super) limits: Vec<[f64; 2]>,
    /// Where each joint is better to be, see [`Inverse::preferring`].
    pub(super) preferred: Vec<Option<[f64; 2]>>,
}

impl<'a> Inverse<'a> {
    /// Within the joint limits of a robot.
    #[must_use]
    pub fn new(forward: &'a Forward, robot: &Robot) -> Self {
        let none = [f64::NEG_INFINITY, f64::INFINITY];
        let limits = robot.joints.iter().map(|j| j.limits.unwrap_or(none)).collect();
        Self { forward, limits, preferred: Vec::new() }
    }

    /// Within these limits instead, rad or m, one a joint.
    #[must_use]
    pub fn limited(self, limits: &[[f64; 2]]) -> Self {
        Self { limits: limits.to_vec(), ..self }
    }

    /// A configuration that is chosen here is one within these ranges, as far as there
    /// is one: those that the identification covered.
    #[must_use]
    pub fn preferring(self, ranges: &[Option<[f64; 2]>]) -> Self {
        Self { preferred: ranges.to_vec(), ..self }
    }

    /// Joints of all rows, each from the last one that was reached, the first from
    /// `start` (rad or m); what is not reached so from `start`, and then from
    /// wherever it can be.
    #[must_use]
    pub fn follow(
        &self,
        data: &Measurements,
        targets: &[Target],
        start: Option<&[f64]>,
    ) -> Followed {
        let mut last: Option<Vec<f64>> = start.map(<[f64]>::to_vec);
        let elsewhere: Vec<Vec<f64>> =
            start.iter().map(|start| start.to_vec()).chain(self.anywhere()).collect();
        let (mut rows, mut jumps, mut missed) = (Vec::new(), Vec::new(), 0);
        let all: Vec<_> = data.rows.iter().zip(targets).collect();
        for (i, (row, target)) in all.iter().copied().enumerate() {
            let near = last.as_ref().map(|last| self.best(row, target, &self.near(last)));
            let found = match near {
                Some(near) if near.is_reached() => near,
                near => {
                    let count = if missed < PATIENCE { elsewhere.len() } else { FEW_STARTS };
                    let first = last.is_none() && missed < PATIENCE;
                    let chosen = if first { self.choose(&all[i..]) } else { None };
                    let found =
                        chosen.unwrap_or_else(|| self.best(row, target, &elsewhere[..count]));
                    if near.is_some() && found.is_reached() {
                        jumps.push(i);
                    }
                    // What is nearest to a pose that no start leads to.
                    near.filter(|near| near.left() < found.left()).unwrap_or(found)
                }
            };
            let found = self.at_ends(row, target, found);
            missed = if found.is_reached() { 0 } else { missed + 1 };
            if found.is_reached() {
                last = Some(found.joints.clone());
            }
            rows.push(found);
        }
        Followed { rows, chosen: start.is_none(), jumps }
    }

    /// The first start from which the pose is reached; else the nearest to it.
    fn best(&self, row: &Row, target: &Target, starts: &[Vec<f64>]) -> Found {
        let mut best: Option<Found> = None;
        for start in starts {
            let found = self.solve(row, target, start);
            if found.is_reached() {
                return found;
            }
            if best.as_ref().is_none_or(|best| found.left() < best.left()) {
                best = Some(found);
            }
        }
        best.unwrap_or(Found { joints: Vec::new(), position: f64::INFINITY, rotation: 0.0 })
    }

    fn near(&self, q: &[f64]) -> Vec<Vec<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut moved = || q.iter().map(|q| q + rng.random_range(-0.05..0.05)).collect();
        let others: Vec<Vec<f64>> = (0..NEAR_STARTS).map(|_| moved()).collect();
        std::iter::once(q.to_vec()).chain(others).collect()
    }

    /// Starts within the limits, the middle first.
    pub(super) fn anywhere(&self) -> Vec<Vec<f64>> {
        self.spread(|j| self.usual(j))
    }

    /// A turn more is the same pose; the one near zero is what is usual.
    pub(super) fn usual(&self, j: usize) -> [f64; 2] {
        let most = match self.forward.kinds()[j] {
            JointKind::Revolute => PI,
            JointKind::Prismatic => 1.0,
        };
        let [low, high] = self.limits[j];
        let (near, far) = (low.max(-most), high.min(most));
        if near < far { [near, far] } else { [low.max(far - most), high.min(near + most)] }
    }

    /// The middle of ranges, and draws from them.
    pub(super) fn spread(&self, range: impl Fn(usize) -> [f64; 2]) -> Vec<Vec<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let kinds = self.forward.kinds();
        let middle = (0..kinds.len()).map(|j| (range(j)[0] + range(j)[1]) / 2.0).collect();
        let mut draw = |j| {
            let [low, high] = range(j);
            if low < high { rng.random_range(low..high) } else { low }
        };
        let draws: Vec<Vec<f64>> =
            (0..ANY_STARTS).map(|_| (0..kinds.len()).map(&mut draw).collect()).collect();
        std::iter::once(middle).chain(draws).collect()
    }

    /// From one start, as near as it comes.
    #[must_use]
    pub fn solve(&self, row: &Row, target: &Target, start: &[f64]) -> Found {
        let mut q: Vec<f64> = self.within(start.to_vec());
        let mut left = self.error(row, target, &q);
        let mut mu = 1e-3;
        for _ in 0..MOST_STEPS {
            if left.norm_squared() < ROUNDING {
                break;
            }
            let jacobian = self.free(&q, &left, target.rotation.is_some());
            let Some((moved, rest)) = self.improve(row, target, (&q, &left), &jacobian, &mut mu)
            else {
                break;
            };
            (q, left) = (moved, rest);
        }
        Self::found(q, &left)
    }

    /// What joints leave.
    pub(super) fn left_at(&self, row: &Row, target: &Target, joints: Vec<f64>) -> Found {
        let left = self.error(row, target, &joints);
        Self::found(joints, &left)
    }

    fn found(joints: Vec<f64>, left: &DVector<f64>) -> Found {
        let rotation = if left.len() > 3 { left.rows(3, 3).norm() / ROTATION_LENGTH } else { 0.0 };
        Found { joints, position: left.rows(0, 3).norm(), rotation }
    }

    /// The next joints and what they leave; `None` where no step leaves less.
    fn improve(
        &self,
        row: &Row,
        target: &Target,
        (q, left): (&[f64], &DVector<f64>),
        jacobian: &DMatrix<f64>,
        mu: &mut f64,
    ) -> Option<(Vec<f64>, DVector<f64>)> {
        let gram = jacobian * jacobian.transpose();
        while *mu < 1e6 {
            let damped = &gram + DMatrix::identity(gram.nrows(), gram.nrows()) * *mu;
            let step = damped.cholesky().map(|c| jacobian.tr_mul(&c.solve(left)));
            if let Some(step) = step {
                let scale = (LONGEST_STEP / step.amax()).min(1.0);
                let moved = q.iter().zip(step.iter()).map(|(q, x)| q + x * scale).collect();
                let moved = self.within(moved);
                let rest = self.error(row, target, &moved);
                if rest.norm_squared() < left.norm_squared() {
                    *mu = (*mu * 0.1).max(1e-15);
                    return Some((moved, rest));
                }
            }
            *mu *= 10.0;
        }
        None
    }

    fn within(&self, mut q: Vec<f64>) -> Vec<f64> {
        for (q, [low, high]) in q.iter_mut().zip(&self.limits) {
            *q = q.max(*low).min(*high);
        }
        q
    }

    /// What is left: the way of the point and, where it counts, the weighed turn.
    fn error(&self, row: &Row, target: &Target, q: &[f64]) -> DVector<f64> {
        let pose = self.forward.pose(row, q);
        let way = target.point - pose.translation;
        match &target.rotation {
            None => DVector::from_column_slice(way.as_slice()),
            Some(rotation) => {
                let turn = turn(rotation, &pose.rotation) * ROTATION_LENGTH;
                DVector::from_iterator(6, way.iter().chain(turn.iter()).copied())
            }
        }
    }

    /// The Jacobian by joints that are not held by a limit.
    fn free(&self, q: &[f64], left: &DVector<f64>, pose: bool) -> DMatrix<f64> {
        let columns = self.forward.jacobian(q);
        let mut jacobian = DMatrix::zeros(left.len(), columns.len());
        for (j, [linear, angular]) in columns.iter().enumerate() {
            let mut column = jacobian.column_mut(j);
            column.rows_mut(0, 3).copy_from(linear);
            if pose {
                let turn: Vector3<f64> = angular * ROTATION_LENGTH;
                column.rows_mut(3, 3).copy_from(&turn);
            }
            let way = column.dot(left);
            let [low, high] = self.limits[j];
            if (q[j] <= low && way < 0.0) || (q[j] >= high && way > 0.0) {
                column.fill(0.0);
            }
        }
        jacobian
    }
}
