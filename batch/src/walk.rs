//! The walk from tool to base, of one vector of poses after the other.

use core::array;

use pulp::{Simd, WithSimd};
use truearm::kinematics::{Pose, Step};
use truearm::{JointKind, MAX_JOINTS};

use crate::lanes::Lanes;
use crate::wide::Wide;

/// The constants of a chain with any number of joints.
#[derive(Debug, Clone)]
pub struct Constants<T> {
    pub tip: Pose<T>,
    pub steps: Vec<Step<T>>,
    pub root: Pose<T>,
}

/// Numbers written a pose: x, y, z of the point, then row by row the rotation.
pub const POINT: usize = 3;
pub const POSE: usize = 12;

/// A batch. All slices are of one length, `q` has a slice a joint: the caller
/// has seen to it.
pub struct Batch<'a, T, const OUT: usize> {
    pub constants: &'a Constants<T>,
    pub q: &'a [&'a [T]],
    pub out: [&'a mut [T]; OUT],
}

type Vector3<T, S> = [Wide<T, S>; 3];

/// A step, each number in every lane.
#[derive(Clone, Copy)]
struct WideStep<T: Lanes, S: Simd> {
    revolute: bool,
    theta: Wide<T, S>,
    constant_turn: [Wide<T, S>; 2],
    twist: [Wide<T, S>; 2],
    offset: Vector3<T, S>,
}

/// All constants, each number in every lane.
struct WideChain<T: Lanes, S: Simd> {
    /// x axis, y axis and point of the tool.
    tip: [Vector3<T, S>; 3],
    /// As many as there are joints, and some that are not looked at.
    steps: [WideStep<T, S>; MAX_JOINTS],
    count: usize,
    rows: [Vector3<T, S>; 3],
    origin: Vector3<T, S>,
}

impl<T: Lanes, const OUT: usize> WithSimd for Batch<'_, T, OUT> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let chain = WideChain::new(simd, self.constants);
        let none: (&[T::Vector<S>], &[T]) = (&[], &[]);
        let columns: [_; MAX_JOINTS] =
            array::from_fn(|joint| self.q.get(joint).map_or(none, |q| T::split::<S>(q)));
        let mut out = self.out.map(|out| T::split_mut::<S>(out));
        chain.run(&columns.map(|(whole, _)| whole), &mut out.each_mut().map(|out| &mut *out.0));
        // What is left over goes through as a vector that is filled up with zeros.
        if columns[0].1.is_empty() {
            return;
        }
        let rest = columns.map(|(_, rest)| [T::load(simd, rest)]);
        let mut results = [[T::splat(simd, T::ZERO)]; OUT];
        chain.run(&rest.each_ref().map(|q| &q[..]), &mut results.each_mut().map(|r| &mut r[..]));
        for ((_, rest), [result]) in out.iter_mut().zip(results) {
            T::store(simd, rest, result);
        }
    }
}

impl<T: Lanes, S: Simd> WideChain<T, S> {
    #[inline(always)]
    fn new(simd: S, constants: &Constants<T>) -> Self {
        let wide = |value: T| Wide::splat(simd, value);
        let zero = wide(T::ZERO);
        let nothing = WideStep {
            revolute: true,
            theta: zero,
            constant_turn: [zero; 2],
            twist: [zero; 2],
            offset: [zero; 3],
        };
        let mut steps = [nothing; MAX_JOINTS];
        for (wide_step, step) in steps.iter_mut().zip(&constants.steps) {
            *wide_step = WideStep {
                revolute: step.kind == JointKind::Revolute,
                theta: wide(step.theta),
                constant_turn: step.constant_turn.map(wide),
                twist: step.twist.map(wide),
                offset: step.offset.map(wide),
            };
        }
        let [x, y, _] = constants.tip.rotation.data.0;
        let [a, b, c] = constants.root.rotation.data.0;
        let rows = array::from_fn(|row| [wide(a[row]), wide(b[row]), wide(c[row])]);
        let point = |pose: &Pose<T>| pose.translation.data.0[0].map(wide);
        Self {
            tip: [x.map(wide), y.map(wide), point(&constants.tip)],
            steps,
            count: constants.steps.len().min(MAX_JOINTS),
            rows,
            origin: point(&constants.root),
        }
    }

    /// All vectors, one after the other. Columns of joints that there are not are empty.
    #[inline(always)]
    fn run<const OUT: usize>(
        &self,
        q: &[&[T::Vector<S>]; MAX_JOINTS],
        out: &mut [&mut [T::Vector<S>]; OUT],
    ) {
        let mut turns = [[self.origin[0]; 2]; MAX_JOINTS];
        for index in 0..q[0].len() {
            // All sines first: they do not wait for one another.
            for joint in 0..self.count {
                let step = &self.steps[joint];
                turns[joint] = if step.revolute {
                    let (sin, cos) = (step.theta.with(q[joint][index]) + step.theta).sin_cos();
                    [sin, cos]
                } else {
                    step.constant_turn
                };
            }
            self.walk(&turns, q, out, index);
        }
    }

    /// [`truearm::Chain::forward`], operation by operation. Without closures: none may
    /// stay a call, whose vectors pass through memory.
    #[inline(always)]
    fn walk<const OUT: usize>(
        &self,
        turns: &[[Wide<T, S>; 2]; MAX_JOINTS],
        q: &[&[T::Vector<S>]; MAX_JOINTS],
        out: &mut [&mut [T::Vector<S>]; OUT],
        index: usize,
    ) {
        let [mut x, mut y, mut p] = self.tip;
        let last = self.count - 1;
        for joint in (0..=last).rev() {
            let (step, turn) = (&self.steps[joint], &turns[joint]);
            if joint < last {
                if OUT == POSE {
                    x = about_x(&step.twist, x);
                    y = about_x(&step.twist, y);
                }
                p = add(about_x(&step.twist, p), step.offset);
            }
            if !step.revolute {
                p[2] = p[2] + p[2].with(q[joint][index]);
            }
            if OUT == POSE {
                x = about_z(turn, x);
                y = about_z(turn, y);
            }
            p = about_z(turn, p);
        }
        let point = add(self.rotated(p), self.origin);
        for k in 0..POINT {
            out[k][index] = point[k].value;
        }
        if OUT == POSE {
            let (x, y) = (self.rotated(x), self.rotated(y));
            let z = cross(x, y);
            for row in 0..3 {
                out[POINT + 3 * row][index] = x[row].value;
                out[POINT + 3 * row + 1][index] = y[row].value;
                out[POINT + 3 * row + 2][index] = z[row].value;
            }
        }
    }

    /// From the turned frame of the first joint to that of the base.
    #[inline(always)]
    fn rotated(&self, v: Vector3<T, S>) -> Vector3<T, S> {
        let [a, b, c] = self.rows;
        [row(a, v), row(b, v), row(c, v)]
    }
}

#[inline(always)]
fn row<T: Lanes, S: Simd>([a, b, c]: Vector3<T, S>, v: Vector3<T, S>) -> Wide<T, S> {
    a * v[0] + b * v[1] + c * v[2]
}

#[inline(always)]
fn about_z<T: Lanes, S: Simd>(turn: &[Wide<T, S>; 2], v: Vector3<T, S>) -> Vector3<T, S> {
    let [sin, cos] = *turn;
    [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]]
}

#[inline(always)]
fn about_x<T: Lanes, S: Simd>(twist: &[Wide<T, S>; 2], v: Vector3<T, S>) -> Vector3<T, S> {
    let [sin, cos] = *twist;
    [v[0], cos * v[1] - sin * v[2], sin * v[1] + cos * v[2]]
}

#[inline(always)]
fn add<T: Lanes, S: Simd>(a: Vector3<T, S>, b: Vector3<T, S>) -> Vector3<T, S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn cross<T: Lanes, S: Simd>(a: Vector3<T, S>, b: Vector3<T, S>) -> Vector3<T, S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
