use nalgebra::{ArrayStorage, Matrix3, Vector3};

use crate::scalar::Scalar;

/// A rigid transform: `p -> rotation * p + translation`, lengths in metres.
///
/// ```
/// use truearm::{Pose, nalgebra::Vector3};
///
/// // A quarter turn about z, then 1 m along x of what it is turned from.
/// let turn = Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2);
/// let pose = Pose::from_rotation_vector(Vector3::new(1.0, 0.0, 0.0), turn);
/// let point = pose.transform_point(&Vector3::new(0.2, 0.0, 0.0));
/// assert!((point - Vector3::new(1.0, 0.2, 0.0)).norm() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose<T> {
    /// Rotation matrix; its columns are the axes of the moved frame.
    pub rotation: Matrix3<T>,
    /// Origin of the moved frame, m.
    pub translation: Vector3<T>,
}

/// As `Debug` has it, with the rotation column by column. A derived one would
/// make text of the numbers on the controller, by nalgebra's `Debug`.
#[cfg(feature = "defmt")]
impl<T: defmt::Format> defmt::Format for Pose<T> {
    fn format(&self, f: defmt::Formatter<'_>) {
        let (rotation, translation) = (&self.rotation.data.0, &self.translation.data.0);
        defmt::write!(f, "Pose {{ rotation: {}, translation: {} }}", rotation, translation);
    }
}

impl<T: Scalar> Pose<T> {
    /// The transform that moves nothing.
    #[must_use]
    pub fn identity() -> Self {
        let (o, l) = (T::ZERO, T::ONE);
        Self {
            rotation: Matrix3::new(l, o, o, o, l, o, o, o, l),
            translation: Vector3::new(o, o, o),
        }
    }

    /// Translation by `x, y, z` in m.
    #[must_use]
    pub fn translation(x: T, y: T, z: T) -> Self {
        Self { translation: Vector3::new(x, y, z), ..Self::identity() }
    }

    /// A translation (m) and a rotation vector (axis times angle, rad;
    /// Rodrigues' formula). Exact to rounding for any angle, zero included, that
    /// [`Scalar::sin_cos`] takes and whose square fits: up to 8192 rad in `f32`, 1e154 in `f64`;
    /// NaN beyond.
    #[must_use]
    pub fn from_rotation_vector(translation: Vector3<T>, w: Vector3<T>) -> Self {
        let angle2 = dot(&w, &w);
        let angle = angle2.sqrt();
        let (sin, cos) = angle.sin_cos_once();
        // sin(x)/x and (1 - cos x)/x^2; below 1e-2 rad by series, where the
        // quotients would cancel.
        let (s, c) = if angle2 < T::from_f32(1e-4) {
            let (sixth, half) = (T::from_f64(1.0 / 6.0), T::from_f64(0.5));
            let (a, b) = (T::from_f64(1.0 / 120.0), T::from_f64(1.0 / 24.0));
            let d = T::from_f64(1.0 / 720.0);
            (T::ONE - angle2 * (sixth - angle2 * a), half - angle2 * (b - angle2 * d))
        } else {
            (sin / angle, (T::ONE - cos) / angle2)
        };
        let (x, y, z) = (w.x, w.y, w.z);
        let l = T::ONE;
        let rotation = Matrix3::new(
            l - c * (y * y + z * z),
            c * x * y - s * z,
            c * x * z + s * y,
            c * x * y + s * z,
            l - c * (x * x + z * z),
            c * y * z - s * x,
            c * x * z - s * y,
            c * y * z + s * x,
            l - c * (x * x + y * y),
        );
        Self { rotation, translation }
    }

    /// From three rows of four, the rotation and the translation in m, as matrices are written
    /// and a controller's tool comes; `None` where it [is no rigid transform](Self::is_rigid).
    ///
    /// ```
    /// use truearm::Pose;
    ///
    /// let tool = [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.15]];
    /// assert!(Pose::from_rows(&tool).is_some());
    /// let left_handed = tool.map(|[x, y, z, t]| [-x, y, z, t]);
    /// assert_eq!(Pose::from_rows(&left_handed), None);
    /// ```
    #[must_use]
    pub fn from_rows(rows: &[[T; 4]; 3]) -> Option<Self> {
        let [[a, b, c, x], [d, e, f, y], [g, h, i, z]] = *rows;
        let rotation = Matrix3::new(a, b, c, d, e, f, g, h, i);
        let pose = Self { rotation, translation: Vector3::new(x, y, z) };
        pose.is_rigid().then_some(pose)
    }

    /// Whether it is what a pose has to be: a finite translation and a rotation, axes of length
    /// one at right angles, right-handed, within 1e-4. Its fields are public and hold anything;
    /// what this crate computes of a matrix that is scaled, skew or left-handed is of another
    /// one, without a word.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        let [x, y, z] = axes(&self.rotation);
        let off = |product: T, wanted: T| (product - wanted).abs();
        // The third axis by its coordinates: a product with it hardly changes where it is skewed.
        let third = cross(&x, &y);
        let errors = [
            off(dot(&x, &x), T::ONE),
            off(dot(&y, &y), T::ONE),
            off(dot(&x, &y), T::ZERO),
            off(third.x, z.x),
            off(third.y, z.y),
            off(third.z, z.z),
        ];
        // A NaN fails every comparison.
        errors.iter().all(|error| *error < T::from_f32(1e-4))
            && self.translation.iter().all(|length| length.is_finite())
    }

    /// The rotation as a vector, axis times angle, of at most half a turn, rad: by the
    /// quaternion, from its largest component.
    #[must_use]
    pub fn rotation_vector(&self) -> Vector3<T> {
        let (one, two) = (T::ONE, T::ONE + T::ONE);
        let [x, y, z] = axes(&self.rotation);
        let (a, b, c) = (y.z - z.y, z.x - x.z, x.y - y.x);
        let (d, e, f) = (x.y + y.x, x.z + z.x, y.z + z.y);
        // Four times the quaternion (w, x, y, z) by its transpose.
        let rows = [
            (one + x.x + y.y + z.z, [a, b, c], one + x.x + y.y + z.z),
            (one + x.x - y.y - z.z, [one + x.x - y.y - z.z, d, e], a),
            (one - x.x + y.y - z.z, [d, one - x.x + y.y - z.z, f], b),
            (one - x.x - y.y + z.z, [e, f, one - x.x - y.y + z.z], c),
        ];
        let [mut best, others @ ..] = rows;
        for row in others {
            if row.0 > best.0 {
                best = row;
            }
        }
        let (_, [x, y, z], w) = best;
        // The same rotation with a positive w turns by half a turn at most.
        let sign = if w < T::ZERO { -one } else { one };
        let v = Vector3::new(x, y, z) * sign;
        let length = dot(&v, &v).sqrt();
        let ratio = if length > T::ZERO { length.atan2(w * sign) / length } else { one };
        v * (two * ratio)
    }

    /// `self * other`: first `other`, then `self`.
    // Work of load time, of which every copy is text.
    #[must_use]
    #[inline(never)]
    pub fn compose(&self, other: &Self) -> Self {
        let [x, y, _] = axes(&other.rotation);
        self.of(&[x, y, other.translation])
    }

    /// `self` times the pose of two axes and an origin.
    #[inline]
    pub(crate) fn of(&self, [x, y, p]: &[Vector3<T>; 3]) -> Self {
        let [x, y] = [x, y].map(|axis| rotate(&self.rotation, axis));
        let rotation = from_axes([x, y, cross(&x, &y)]);
        Self { rotation, translation: self.transform_point(p) }
    }

    /// The transform that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        let moved = rotate(&rotation, &self.translation);
        Self { rotation, translation: -moved }
    }

    /// `rotation * p + translation`, m.
    #[must_use]
    pub fn transform_point(&self, p: &Vector3<T>) -> Vector3<T> {
        rotate(&self.rotation, p) + self.translation
    }
}

/// Turns axes and points about the origin by the small rotation `w`, rad. By Cayley's
/// formula, without sine or root: always a rotation, about `w`, by an angle whose half has
/// the tangent |w| / 2, so |w|^3 / 12 less than |w|.
// Where it is not inlined, what was walked to goes through memory.
#[inline(always)]
pub(crate) fn tilt<T: Scalar>(all: &mut [Vector3<T>], w: &Vector3<T>) {
    let half = *w * T::from_f32(0.5);
    let scale = (T::ONE + T::ONE) / (T::ONE + dot(&half, &half));
    for p in all {
        *p += cross(&half, &(*p + cross(&half, p))) * scale;
    }
}

// A matrix is taken apart by its columns: `m[(i, j)]` can panic, and built for
// size the compiler does not see that it never does.

/// The columns of a rotation matrix: the axes of the moved frame.
pub(crate) fn axes<T: Scalar>(m: &Matrix3<T>) -> [Vector3<T>; 3] {
    let [[a, b, c], [d, e, f], [g, h, i]] = m.data.0;
    [Vector3::new(a, b, c), Vector3::new(d, e, f), Vector3::new(g, h, i)]
}

/// The rotation matrix of three axes.
pub(crate) fn from_axes<T: Scalar>([x, y, z]: [Vector3<T>; 3]) -> Matrix3<T> {
    Matrix3::from_array_storage(ArrayStorage([[x.x, x.y, x.z], [y.x, y.y, y.z], [z.x, z.y, z.z]]))
}

/// `m * v`, summed in a fixed order, so that no build of nalgebra can change
/// a bit of it.
pub(crate) fn rotate<T: Scalar>(m: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    let [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]] = m.data.0;
    Vector3::new(
        xx * v.x + xy * v.y + xz * v.z,
        yx * v.x + yy * v.y + yz * v.z,
        zx * v.x + zy * v.y + zz * v.z,
    )
}

pub(crate) fn cross<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

pub(crate) fn dot<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}
