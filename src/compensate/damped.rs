//! Damped least squares in task space, in 3 x 3 blocks: position and, for a
//! pose, orientation.

use nalgebra::Vector3;

use crate::kinematics::{Twist, dot};
use crate::scalar::Scalar;

/// The joint change that takes back a task error, and how.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Damped<T, const N: usize> {
    pub joints: [T; N],
    /// What is left of the error, to first order.
    pub left: Twist<T>,
    /// mu, 0 away from singular poses, m^2.
    pub damping: T,
}

/// What to solve besides the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rule<T> {
    /// Orientation counts too.
    pub pose: bool,
    /// Squared singular value below which damping sets in, m^2.
    pub threshold: T,
    /// Square of the length that weighs orientation, m^2.
    pub weight: T,
}

/// `J' (J J' + mu W)^-1 (error + J c)` for the `error` left at a correction c:
/// the x that minimises `|J x - (error + J c)|^2 + mu |x|^2`, where W = I for
/// the position and 1 / weight for the orientation, which weighs an angle by
/// a length. By square-root-free Cholesky; its pivots give the damping.
///
/// The smallest pivot p of `J J' = L D L'`, those of the orientation times
/// `weight`, is at least the square of J's
/// smallest singular value. Where `p >= threshold`, mu is 0; below, it rises
/// smoothly to `threshold` in a singular pose:
/// `mu = threshold (1 - p / threshold)^2`. However damped, |x| is at most
/// `|error| / (2 sqrt(mu))`.
// Not inlined: the optimiser would keep whole arrays in registers that it does
// not have.
#[inline(never)]
pub(super) fn solve<T: Scalar, const N: usize>(
    columns: &[Twist<T>; N],
    error: &Twist<T>,
    correction: &[T; N],
    rule: &Rule<T>,
) -> Damped<T, N> {
    let Rule { pose, threshold, weight } = *rule;
    let gram = if pose { Gram::of_poses(columns) } else { Gram::of_points(columns) };
    let mut damping = T::ZERO;
    // Twice at most: without damping, then with the damping this asks for.
    let factor = loop {
        let factor = gram.factor([damping, damping / weight], pose);
        if damping > T::ZERO {
            break factor;
        }
        let mut smallest = factor.position.smallest;
        if pose && factor.rotation.smallest * weight < smallest {
            smallest = factor.rotation.smallest * weight;
        }
        let near = T::ONE - smallest / threshold;
        damping = if near > T::ZERO { threshold * near * near } else { T::ZERO };
        if damping <= T::ZERO {
            break factor;
        }
    };
    if pose && N == 6 && damping <= T::ZERO {
        // J can be inverted: the correction stays as it is, the error is added.
        let y = factor.solve(&gram, error, pose);
        let mut joints = *correction;
        for (joint, column) in joints.iter_mut().zip(columns) {
            *joint += dot(&column.linear, &y.linear) + dot(&column.angular, &y.angular);
        }
        return Damped { joints, left: Twist::zero(), damping };
    }
    let mut uncorrected = *error;
    for (column, c) in columns.iter().zip(correction) {
        uncorrected.linear += column.linear * *c;
        uncorrected.angular += column.angular * *c;
    }
    let y = factor.solve(&gram, &uncorrected, pose);
    let joints = columns.each_ref().map(|column| {
        let along = dot(&column.linear, &y.linear);
        if pose { along + dot(&column.angular, &y.angular) } else { along }
    });
    let left = Twist { linear: y.linear * damping, angular: y.angular * (damping / weight) };
    Damped { joints, left, damping }
}

/// `J J'` in blocks.
struct Gram<T> {
    position: Symmetric<T>,
    /// Linear parts times each coordinate of the angular part.
    mixed: [Vector3<T>; 3],
    rotation: Symmetric<T>,
}

/// Factors of `[[A, B], [B', C]]`: of A, `A^-1 B`, and of the Schur complement `C - B' A^-1 B`.
struct BlockFactor<T> {
    position: Factor<T>,
    lifted: [Vector3<T>; 3],
    rotation: Factor<T>,
}

impl<T: Scalar> Gram<T> {
    #[inline]
    fn of_points(columns: &[Twist<T>]) -> Self {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let mut position = Symmetric::of(&none);
        for column in columns {
            position.add(&column.linear);
        }
        Self { position, mixed: [none; 3], rotation: Symmetric::of(&none) }
    }

    #[inline]
    fn of_poses(columns: &[Twist<T>]) -> Self {
        // From the first column on instead of from zero: 21 additions less.
        let Some((Twist { linear, angular }, rest)) = columns.split_first() else {
            return Self::of_points(columns);
        };
        let (mut position, mut rotation) = (Symmetric::of(linear), Symmetric::of(angular));
        let (mut x, mut y, mut z) = (linear * angular.x, linear * angular.y, linear * angular.z);
        for Twist { linear, angular } in rest {
            position.add(linear);
            rotation.add(angular);
            x += linear * angular.x;
            y += linear * angular.y;
            z += linear * angular.z;
        }
        Self { position, mixed: [x, y, z], rotation }
    }

    /// With damping of position and orientation.
    #[inline]
    fn factor(&self, damping: [T; 2], pose: bool) -> BlockFactor<T> {
        let position = Factor::new(&self.position, damping[0]);
        let [x, y, z] = &self.mixed;
        if !pose {
            return BlockFactor { position, lifted: self.mixed, rotation: position };
        }
        let lifted = [position.solve(x), position.solve(y), position.solve(z)];
        let c = &self.rotation;
        let complement = Symmetric {
            xx: c.xx - dot(x, &lifted[0]),
            yx: c.yx - dot(y, &lifted[0]),
            yy: c.yy - dot(y, &lifted[1]),
            zx: c.zx - dot(z, &lifted[0]),
            zy: c.zy - dot(z, &lifted[1]),
            zz: c.zz - dot(z, &lifted[2]),
        };
        BlockFactor { position, lifted, rotation: Factor::new(&complement, damping[1]) }
    }
}

impl<T: Scalar> BlockFactor<T> {
    #[inline]
    fn solve(&self, gram: &Gram<T>, error: &Twist<T>, pose: bool) -> Twist<T> {
        let linear = self.position.solve(&error.linear);
        if !pose {
            return Twist { linear, angular: linear };
        }
        let [x, y, z] = &gram.mixed;
        let rest = error.angular - Vector3::new(dot(x, &linear), dot(y, &linear), dot(z, &linear));
        let angular = self.rotation.solve(&rest);
        let [x, y, z] = &self.lifted;
        Twist { linear: linear - x * angular.x - y * angular.y - z * angular.z, angular }
    }
}

/// Lower triangle of a symmetric matrix.
struct Symmetric<T> {
    xx: T,
    yx: T,
    yy: T,
    zx: T,
    zy: T,
    zz: T,
}

impl<T: Scalar> Symmetric<T> {
    /// `v v'`.
    #[inline]
    fn of(v: &Vector3<T>) -> Self {
        Self {
            xx: v.x * v.x,
            yx: v.y * v.x,
            yy: v.y * v.y,
            zx: v.z * v.x,
            zy: v.z * v.y,
            zz: v.z * v.z,
        }
    }

    /// Adds `v v'`.
    #[inline]
    fn add(&mut self, v: &Vector3<T>) {
        self.xx += v.x * v.x;
        self.yx += v.y * v.x;
        self.yy += v.y * v.y;
        self.zx += v.z * v.x;
        self.zy += v.z * v.y;
        self.zz += v.z * v.z;
    }
}

/// `L D L'` of a positive definite matrix.
#[derive(Clone, Copy)]
struct Factor<T> {
    yx: T,
    zx: T,
    zy: T,
    /// 1 / D.
    inverse: Vector3<T>,
    smallest: T,
}

impl<T: Scalar> Factor<T> {
    /// Of `a + damping I`. A pivot of zero gives infinities; the caller sees it
    /// as `smallest`.
    #[inline]
    fn new(a: &Symmetric<T>, damping: T) -> Self {
        let px = a.xx + damping;
        let ix = T::ONE / px;
        let (yx, zx) = (a.yx * ix, a.zx * ix);
        let py = a.yy + damping - yx * a.yx;
        let iy = T::ONE / py;
        let rest = a.zy - zx * a.yx;
        let zy = rest * iy;
        let pz = a.zz + damping - zx * a.zx - zy * rest;
        let mut smallest = px;
        for pivot in [py, pz] {
            if pivot < smallest {
                smallest = pivot;
            }
        }
        Self { yx, zx, zy, inverse: Vector3::new(ix, iy, T::ONE / pz), smallest }
    }

    #[inline]
    fn solve(&self, v: &Vector3<T>) -> Vector3<T> {
        let y = v.y - self.yx * v.x;
        let z = v.z - self.zx * v.x - self.zy * y;
        let z = z * self.inverse.z;
        let y = y * self.inverse.y - self.zy * z;
        Vector3::new(v.x * self.inverse.x - self.yx * y - self.zx * z, y, z)
    }
}
