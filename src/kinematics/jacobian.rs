use nalgebra::Vector3;

use super::chain::Chain;
use super::folded_joint::TurnedJoint;
use super::link::{JointKind, Link, LinkParameter, MdhParameters};
use super::pose::{Pose, axes, cross, from_axes, rotate};
use crate::scalar::Scalar;

/// Velocity of the tool for one joint moving at 1 rad/s or 1 m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Twist<T> {
    /// Of the tool point, m per rad or m per m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub linear: Vector3<T>,
    /// Of the tool frame, rad per rad or rad per m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub angular: Vector3<T>,
}

impl<T: Scalar> Twist<T> {
    pub(crate) fn zero() -> Self {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        Self { linear: none, angular: none }
    }
}

/// Tool pose and geometric Jacobian, both in the frame of the chain's base pose.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Jacobian<T, const N: usize> {
    /// Pose of the tool.
    pub pose: Pose<T>,
    /// One column a joint.
    pub columns: [Twist<T>; N],
}

/// Derivatives of the tool point with respect to the five MD-H parameters of a
/// link: m per rad for the angles, m per m for the lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkColumns<T> {
    /// With respect to alpha.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub alpha: Vector3<T>,
    /// With respect to a.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub a: Vector3<T>,
    /// With respect to theta.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub theta: Vector3<T>,
    /// With respect to d.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub d: Vector3<T>,
    /// With respect to beta.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub beta: Vector3<T>,
}

impl<T: Scalar> LinkColumns<T> {
    /// The column of one parameter.
    #[must_use]
    pub const fn get(&self, parameter: LinkParameter) -> &Vector3<T> {
        match parameter {
            LinkParameter::Alpha => &self.alpha,
            LinkParameter::A => &self.a,
            LinkParameter::Theta => &self.theta,
            LinkParameter::D => &self.d,
            LinkParameter::Beta => &self.beta,
        }
    }

    /// With respect to the value of the joint, its theta or its d.
    #[must_use]
    pub const fn joint(&self, kind: JointKind) -> &Vector3<T> {
        match kind {
            JointKind::Revolute => &self.theta,
            JointKind::Prismatic => &self.d,
        }
    }

    /// All five in the order of [`LinkParameter::ALL`].
    #[must_use]
    pub fn to_array(&self) -> [Vector3<T>; 5] {
        [self.alpha, self.a, self.theta, self.d, self.beta]
    }
}

/// The tool point and its exact derivative to all 5N + 6 + 3 parameters, in
/// the frame the base is given in (paper Eq. 4, 5, 7; the paper's Eq. 6 adds
/// the links' transforms where the derivative of a product is needed).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct IdentificationJacobian<T, const N: usize> {
    /// The tool point, m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub point: Vector3<T>,
    /// To the MD-H parameters of each link.
    pub links: [LinkColumns<T>; N],
    /// To a rotation of the base about the x, y, z axes of the outer frame
    /// through the base origin, `R -> exp(w) R`, m per rad.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub base_rotation: [Vector3<T>; 3],
    /// To a translation of the base along the outer x, y, z, m per m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub base_translation: [Vector3<T>; 3],
    /// To the tool point's coordinates in the last frame, m per m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub tool: [Vector3<T>; 3],
}

/// Sines and cosines of a link's constant angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkTurns<T> {
    alpha: (T, T),
    beta: (T, T),
}

impl<T: Scalar> LinkTurns<T> {
    /// Of this link.
    #[must_use]
    #[inline]
    pub fn of(link: &Link<T>) -> Self {
        let MdhParameters { alpha, beta, .. } = link.parameters;
        Self { alpha: alpha.sin_cos_once(), beta: beta.sin_cos_once() }
    }
}

/// Axes of one link on the way from base to tool, in the frame the base is given in.
#[derive(Clone, Copy)]
struct Axes<T> {
    /// x axis and origin of the frame before: alpha turns about it, a moves along it.
    x: Vector3<T>,
    before: Vector3<T>,
    /// Joint axis and a point on it.
    z: Vector3<T>,
    on_z: Vector3<T>,
    /// y axis and origin after the joint: beta turns about it.
    y: Vector3<T>,
    after: Vector3<T>,
}

impl<T: Scalar, const N: usize> Chain<T, N> {
    /// Tool pose and geometric Jacobian at joint values `q` (rad or m);
    /// instructions on a Cortex-M4F: README.
    #[must_use]
    #[inline]
    pub fn jacobian(&self, q: &[T; N]) -> Jacobian<T, N> {
        let mut columns = [Twist::zero(); N];
        let pose = self.jacobian_into(q, &mut columns);
        Jacobian { pose, columns }
    }

    /// Tool pose, from base to tool; the geometric Jacobian goes into `columns`.
    #[inline]
    pub(crate) fn jacobian_into(&self, q: &[T; N], columns: &mut [Twist<T>; N]) -> Pose<T> {
        let [mut x, mut y, mut z] = axes(&self.root.rotation);
        let mut o = self.root.translation;
        for (index, (TurnedJoint { joint, q, turn }, out)) in
            self.turned(q).zip(columns.iter_mut()).enumerate()
        {
            // The joint's axis and, until the tool point is known, a point on it.
            *out = Twist { linear: o, angular: z };
            (x, y) = (x * turn.cos + y * turn.sin, y * turn.cos - x * turn.sin);
            if joint.prismatic() {
                o += z * q;
            }
            if index + 1 < N {
                let [a, b, c] = joint.offset;
                o += x * a + y * b + z * c;
                let (sin, cos) = (joint.sin_twist, joint.cos_twist);
                (y, z) = (y * cos + z * sin, z * cos - y * sin);
            }
        }
        let flange = Pose { rotation: from_axes([x, y, z]), translation: o };
        let [x, y, _] = axes(&self.tip.rotation);
        let pose = flange.of(&[x, y, self.tip.translation]);
        for (joint, twist) in self.joints.iter().zip(columns) {
            if joint.prismatic() {
                *twist = Twist { linear: twist.angular, ..Twist::zero() };
            } else {
                twist.linear = cross(&twist.angular, &(pose.translation - twist.linear));
            }
        }
        pose
    }

    /// Tool point and its derivative to every parameter at joint values `q`
    /// (rad or m). Exact, not a difference quotient.
    #[must_use]
    pub fn identification_jacobian(&self, q: &[T; N]) -> IdentificationJacobian<T, N> {
        self.derivatives(q, |_, link| LinkTurns::of(link))
    }

    /// The same bits where the chain does not change from pose to pose: of 18
    /// sine-cosines of a six-joint arm, 12 are taken once.
    #[must_use]
    pub fn identification_jacobian_with(
        &self,
        turns: &[LinkTurns<T>; N],
        q: &[T; N],
    ) -> IdentificationJacobian<T, N> {
        self.derivatives(q, |index, link| {
            turns.get(index).copied().unwrap_or_else(|| LinkTurns::of(link))
        })
    }

    /// Of every link, for [`Self::identification_jacobian_with`].
    #[must_use]
    pub fn link_turns(&self) -> [LinkTurns<T>; N] {
        self.links.map(|link| LinkTurns::of(&link))
    }

    #[inline]
    fn derivatives(
        &self,
        q: &[T; N],
        turns: impl Fn(usize, &Link<T>) -> LinkTurns<T>,
    ) -> IdentificationJacobian<T, N> {
        let none = Twist::<T>::zero().linear;
        // In place: arrays made by a function of their entries pass through memory twice.
        let at = Axes { x: none, before: none, z: none, on_z: none, y: none, after: none };
        let mut on_the_way = [at; N];
        let flange = self.axes_on_the_way(q, turns, &mut on_the_way);
        let pose = flange.compose(&self.tool);
        let p = pose.translation;
        let mut links = [LinkColumns { alpha: none, a: none, theta: none, d: none, beta: none }; N];
        for (columns, at) in links.iter_mut().zip(&on_the_way) {
            *columns = LinkColumns {
                alpha: cross(&at.x, &(p - at.before)),
                a: at.x,
                theta: cross(&at.z, &(p - at.on_z)),
                d: at.z,
                beta: cross(&at.y, &(p - at.after)),
            };
        }
        let unit = axes(&Pose::identity().rotation);
        let arm = p - self.base.translation;
        // The tool point moves along the axes of the last frame; a rotation of
        // the tool frame does not turn these.
        let flange_axes = axes(&self.tool.rotation.transpose());
        IdentificationJacobian {
            point: p,
            links,
            base_rotation: unit.map(|e| cross(&e, &arm)),
            base_translation: unit,
            tool: flange_axes.map(|axis| rotate(&pose.rotation, &axis)),
        }
    }

    /// Axes of all links; the pose of the last frame.
    #[inline]
    fn axes_on_the_way(
        &self,
        q: &[T; N],
        turns: impl Fn(usize, &Link<T>) -> LinkTurns<T>,
        out: &mut [Axes<T>; N],
    ) -> Pose<T> {
        let [mut x, mut y, mut z] = axes(&self.base.rotation);
        let mut o = self.base.translation;
        let joints = self.links.iter().zip(q).enumerate();
        for ((index, (link, &q)), out) in joints.zip(out) {
            let (before, x_before) = (o, x);
            let MdhParameters { a, theta, d, .. } = link.parameters;
            let LinkTurns { alpha, beta } = turns(index, link);
            let (angle, d) = match link.kind {
                JointKind::Revolute => (theta + q, d),
                JointKind::Prismatic => (theta, d + q),
            };
            let (sin, cos) = alpha;
            (y, z) = (y * cos + z * sin, z * cos - y * sin);
            o += x * a;
            let (axis, on_axis) = (z, o);
            let (sin, cos) = angle.sin_cos_once();
            (x, y) = (x * cos + y * sin, y * cos - x * sin);
            o += z * d;
            let (sin, cos) = beta;
            (x, z) = (x * cos - z * sin, x * sin + z * cos);
            *out = Axes { x: x_before, before, z: axis, on_z: on_axis, y, after: o };
        }
        Pose { rotation: from_axes([x, y, z]), translation: o }
    }
}
