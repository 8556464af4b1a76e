//! Damped least squares in task space, in 3 x 3 blocks: position and, for a
//! pose, orientation.

use nalgebra::Vector3;

use crate::kinematics::{Twist, dot};
use crate::scalar::Scalar;

/// What is solved for, and where damping begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rule<T> {
    /// Orientation counts too.
    pub pose: bool,
    /// Squared singular value below which damping sets in, m^2.
    pub threshold: T,
    /// Square of the length that weighs orientation, m^2.
    pub weight: T,
}

/// `J J' + mu W`, factored, of a Jacobian J; W = I for the position and
/// 1 / weight for the orientation, which weighs an angle by a length. The x
/// that minimises `|J x - error|^2 + mu |x|^2` is `J' (J J' + mu W)^-1 error`.
///
/// mu follows from the harmonic sum h of the squared singular values s_i of J,
/// `1 / h = sum 1 / s_i^2`, the trace of the inverse: h is at most the smallest of
/// them and at least this over their number. Where `h >= threshold`, mu is 0;
/// below, it rises to `threshold` in a singular pose,
/// `mu = threshold (1 - h / threshold)^2`. h is smooth in the joints, as the
/// smallest singular value itself is not.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct System<T> {
    gram: Gram<T>,
    factor: BlockFactor<T>,
    /// mu and mu / weight.
    pub damping: [T; 2],
}

impl<T: Scalar> System<T> {
    /// Of no Jacobian yet.
    pub fn none() -> Self {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let block = || Symmetric::of(&none);
        let gram = Gram { position: block(), mixed: [none; 3], rotation: block() };
        let one = Vector3::new(T::ONE, T::ONE, T::ONE);
        let factor = Factor { yx: T::ZERO, zx: T::ZERO, zy: T::ZERO, inverse: one };
        let factor = BlockFactor { position: factor, lifted: [none; 3], rotation: factor };
        Self { gram, factor, damping: [T::ZERO; 2] }
    }

    /// Becomes that of a Jacobian by columns.
    // Not inlined: the optimiser would keep whole arrays in registers that it
    // does not have.
    #[inline(never)]
    pub fn set(&mut self, columns: &[Twist<T>], rule: &Rule<T>) {
        let Rule { pose, threshold, weight } = *rule;
        self.gram = Gram::of(columns);
        self.factor.set(&self.gram, [T::ZERO; 2], pose);
        let harmonic = self.factor.harmonic(weight, pose);
        // A pivot that rounding made negative, or NaN: as singular as can be.
        let regular = harmonic > T::ZERO && self.factor.is_positive();
        let near = if regular { T::ONE - harmonic / threshold } else { T::ONE };
        self.damping = [T::ZERO; 2];
        if near > T::ZERO {
            let mu = threshold * near * near;
            self.damping = [mu, mu / weight];
            self.damp(pose);
        }
    }

    #[cold]
    #[inline(never)]
    fn damp(&mut self, pose: bool) {
        self.factor.set(&self.gram, self.damping, pose);
    }

    /// `(J J' + mu W)^-1 error`: in the directions of the task. With orientation
    /// or zeros in its place.
    #[inline]
    pub fn solve(&self, error: &Twist<T>, pose: bool) -> Twist<T> {
        self.factor.solve(&self.gram, error, pose)
    }
}

/// `J J'` in blocks.
#[derive(Debug, Clone, PartialEq)]
struct Gram<T> {
    position: Symmetric<T>,
    /// Linear parts times each coordinate of the angular part.
    mixed: [Vector3<T>; 3],
    rotation: Symmetric<T>,
}

/// Factors of `[[A, B], [B', C]]`: of A, `A^-1 B`, and of the Schur complement `C - B' A^-1 B`.
#[derive(Debug, Clone, PartialEq)]
struct BlockFactor<T> {
    position: Factor<T>,
    lifted: [Vector3<T>; 3],
    rotation: Factor<T>,
}

impl<T: Scalar> Gram<T> {
    /// Of a Jacobian by columns; of the position alone the rest is not used.
    #[inline]
    fn of(columns: &[Twist<T>]) -> Self {
        // Minus zero, to which a number is added without a bit changed: as if nothing were.
        let none = -T::ZERO;
        let mut position = Symmetric { xx: none, yx: none, yy: none, zx: none, zy: none, zz: none };
        let mut rotation = position.clone();
        let [mut x, mut y, mut z] = [Vector3::new(none, none, none); 3];
        for Twist { linear, angular } in columns {
            position.add(linear);
            rotation.add(angular);
            x += linear * angular.x;
            y += linear * angular.y;
            z.x += linear.x * angular.z;
            z.y += linear.y * angular.z;
        }
        // A joint moves the tool across its axis: of all products of like coordinates the sum
        // is zero.
        z.z = -(x.x + y.y);
        Self { position, mixed: [x, y, z], rotation }
    }
}

impl<T: Scalar> BlockFactor<T> {
    /// Becomes the factors with damping of position and orientation.
    // Inlined into the tick that is not damped.
    #[inline(always)]
    fn set(&mut self, gram: &Gram<T>, damping: [T; 2], pose: bool) {
        self.position = Factor::new(&gram.position, damping[0]);
        if !pose {
            return;
        }
        let [x, y, z] = &gram.mixed;
        self.lifted = [self.position.solve(x), self.position.solve(y), self.position.solve(z)];
        let (c, l) = (&gram.rotation, &self.lifted);
        let complement = Symmetric {
            xx: c.xx - dot(x, &l[0]),
            yx: c.yx - dot(y, &l[0]),
            yy: c.yy - dot(y, &l[1]),
            zx: c.zx - dot(z, &l[0]),
            zy: c.zy - dot(z, &l[1]),
            zz: c.zz - dot(z, &l[2]),
        };
        self.rotation = Factor::new(&complement, damping[1]);
    }

    /// Whether every pivot is positive; those of the orientation stay one where
    /// it is not asked for.
    #[inline]
    fn is_positive(&self) -> bool {
        let [a, b] = [&self.position.inverse, &self.rotation.inverse];
        let pivots = [a.x, a.y, a.z, b.x, b.y, b.z];
        pivots.iter().all(|pivot| *pivot > T::ZERO)
    }

    /// One over the trace of the inverse, the orientation weighed: m^2.
    #[inline]
    fn harmonic(&self, weight: T, pose: bool) -> T {
        let position = self.position.inverse();
        let mut sum = position.xx + position.yy + position.zz;
        if pose {
            // Of the block inverse: C^-1 below, A^-1 + (A^-1 B) C^-1 (A^-1 B)' above.
            let below = self.rotation.inverse();
            let [x, y, z] = &self.lifted;
            let across = dot(x, y) * below.yx + dot(x, z) * below.zx + dot(y, z) * below.zy;
            sum += dot(x, x) * below.xx + dot(y, y) * below.yy + dot(z, z) * below.zz;
            sum += across + across + (below.xx + below.yy + below.zz) / weight;
        }
        T::ONE / sum
    }

    #[inline]
    fn solve(&self, gram: &Gram<T>, error: &Twist<T>, pose: bool) -> Twist<T> {
        let linear = self.position.solve(&error.linear);
        if !pose {
            return Twist { linear, ..Twist::zero() };
        }
        let [x, y, z] = &gram.mixed;
        let rest = error.angular - Vector3::new(dot(x, &linear), dot(y, &linear), dot(z, &linear));
        let angular = self.rotation.solve(&rest);
        let [x, y, z] = &self.lifted;
        Twist { linear: linear - x * angular.x - y * angular.y - z * angular.z, angular }
    }
}

/// Lower triangle of a symmetric matrix.
#[derive(Debug, Clone, PartialEq)]
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
#[derive(Debug, Clone, Copy, PartialEq)]
struct Factor<T> {
    yx: T,
    zx: T,
    zy: T,
    /// 1 / D.
    inverse: Vector3<T>,
}

impl<T: Scalar> Factor<T> {
    /// Of `a + damping I`. A pivot of zero gives infinities; the caller sees it
    /// in the harmonic sum.
    #[inline]
    fn new(a: &Symmetric<T>, damping: T) -> Self {
        let ix = T::ONE / (a.xx + damping);
        let (yx, zx) = (a.yx * ix, a.zx * ix);
        let iy = T::ONE / (a.yy + damping - yx * a.yx);
        let rest = a.zy - zx * a.yx;
        let zy = rest * iy;
        let iz = T::ONE / (a.zz + damping - zx * a.zx - zy * rest);
        Self { yx, zx, zy, inverse: Vector3::new(ix, iy, iz) }
    }

    /// The inverse matrix: `L^-T D^-1 L^-1`.
    #[inline]
    fn inverse(&self) -> Symmetric<T> {
        let (x, y, z) = (self.inverse.x, self.inverse.y, self.inverse.z);
        let corner = self.yx * self.zy - self.zx;
        let (y_yx, z_zy, z_corner) = (y * self.yx, z * self.zy, z * corner);
        Symmetric {
            xx: x + y_yx * self.yx + z_corner * corner,
            yx: -y_yx - z_corner * self.zy,
            yy: y + z_zy * self.zy,
            zx: z_corner,
            zy: -z_zy,
            zz: z,
        }
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
