use nalgebra::Vector3;

use super::chain::Chain;
use super::link::{JointKind, LinkParameter};
use super::pose::{Pose, axis, cross};
use crate::effects::Bending;
use crate::scalar::Scalar;

/// Velocity of the tool for one joint moving at 1 rad/s or 1 m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist<T> {
    /// Of the tool point, m per rad or m per m.
    pub linear: Vector3<T>,
    /// Of the tool frame, rad per rad or rad per m.
    pub angular: Vector3<T>,
}

/// Tool pose and geometric Jacobian, both in the frame of the chain's base pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobian<T, const N: usize> {
    /// Pose of the tool.
    pub pose: Pose<T>,
    /// One column a joint.
    pub columns: [Twist<T>; N],
}

/// Derivatives of the tool point with respect to the five MD-H parameters of a
/// link: m per rad for the angles, m per m for the lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkColumns<T> {
    /// With respect to alpha.
    pub alpha: Vector3<T>,
    /// With respect to a.
    pub a: Vector3<T>,
    /// With respect to theta.
    pub theta: Vector3<T>,
    /// With respect to d.
    pub d: Vector3<T>,
    /// With respect to beta.
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
}

/// The tool point and its exact derivative to all 5N + 6 + 3 parameters, in
/// the frame the base is given in (paper Eq. 4, 5, 7; the paper's Eq. 6 adds
/// the links' transforms where the derivative of a product is needed).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdentificationJacobian<T, const N: usize> {
    /// The tool point, m.
    pub point: Vector3<T>,
    /// To the MD-H parameters of each link.
    pub links: [LinkColumns<T>; N],
    /// To a rotation of the base about the x, y, z axes of the outer frame
    /// through the base origin, `R -> exp(w) R`, m per rad.
    pub base_rotation: [Vector3<T>; 3],
    /// To a translation of the base along the outer x, y, z, m per m.
    pub base_translation: [Vector3<T>; 3],
    /// To the tool point's coordinates in the last frame, m per m.
    pub tool: [Vector3<T>; 3],
}

/// Where a link is at one pose, in the frame the base is given in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkFrame<T> {
    /// Axes of the link's frame, behind its joint.
    pub x: Vector3<T>,
    /// y axis.
    pub y: Vector3<T>,
    /// z axis.
    pub z: Vector3<T>,
    /// Origin of the link's frame, m.
    pub origin: Vector3<T>,
    /// Joint axis.
    pub axis: Vector3<T>,
    /// A point on the joint axis, m.
    pub on_axis: Vector3<T>,
    /// The joint slides along its axis instead of turning about it.
    pub prismatic: bool,
}

/// The axes of one link on the way from base to tool.
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
    /// Walks from base to tool; returns the tool pose and each link's axes.
    #[inline]
    fn walk(&self, q: &[T; N]) -> (Pose<T>, [Axes<T>; N]) {
        let r = &self.base.rotation;
        let (mut x, mut y, mut z) = (axis(r, 0), axis(r, 1), axis(r, 2));
        let mut o = self.base.translation;
        let blank = Axes { x, before: o, z, on_z: o, y, after: o };
        let mut axes = [blank; N];
        for ((link, &q), out) in self.links.iter().zip(q).zip(&mut axes) {
            let (sin, cos, d) = link.at(q);
            out.x = x;
            out.before = o;
            (y, z) =
                (y * link.cos_alpha + z * link.sin_alpha, z * link.cos_alpha - y * link.sin_alpha);
            o += x * link.a;
            out.z = z;
            out.on_z = o;
            (x, y) = (x * cos + y * sin, y * cos - x * sin);
            o += z * d;
            out.y = y;
            out.after = o;
            (x, z) = (x * link.cos_beta - z * link.sin_beta, x * link.sin_beta + z * link.cos_beta);
        }
        let flange = Pose { rotation: nalgebra::Matrix3::from_columns(&[x, y, z]), translation: o };
        (flange.compose(&self.tool), axes)
    }

    /// Frames of all links at joint values `q` (rad or m).
    #[must_use]
    pub fn link_frames(&self, q: &[T; N]) -> [LinkFrame<T>; N] {
        let (_, axes) = self.walk(q);
        let mut links = self.links.iter();
        axes.map(|at| {
            let link = links.next();
            let (s, c) = link.map_or((T::ZERO, T::ONE), |l| (l.sin_beta, l.cos_beta));
            // x before beta, from the axes that are known: y cross z.
            let x = cross(&at.y, &at.z);
            LinkFrame {
                x: x * c - at.z * s,
                y: at.y,
                z: x * s + at.z * c,
                origin: at.after,
                axis: at.z,
                on_axis: at.on_z,
                prismatic: link.is_some_and(|l| l.kind == JointKind::Prismatic),
            }
        })
    }

    /// Tool pose with everything bent that terms bend: joints, base, lengths.
    #[must_use]
    pub fn forward_bent(&self, q: &[T; N], bending: &Bending<T, N>) -> Pose<T> {
        let mut joints = *q;
        for (q, bend) in joints.iter_mut().zip(&bending.joints) {
            *q += *bend;
        }
        let mut pose = self.forward(&joints);
        if bending.growth.iter().any(|g| *g != T::ZERO) {
            // The tool point is linear in the lengths.
            let (_, axes) = self.walk(&joints);
            for ((link, at), growth) in self.links.iter().zip(&axes).zip(&bending.growth) {
                pose.translation += (at.x * link.a + at.z * link.d) * *growth;
            }
        }
        let [x, y] = bending.base;
        if x != T::ZERO || y != T::ZERO {
            let base = &self.base;
            let turn = Pose::from_rotation_vector(
                Vector3::new(T::ZERO, T::ZERO, T::ZERO),
                axis(&base.rotation, 0) * x + axis(&base.rotation, 1) * y,
            );
            let arm = pose.translation - base.translation;
            pose.translation = base.translation + turn.transform_point(&arm);
            pose.rotation = turn.compose(&pose).rotation;
        }
        pose
    }

    /// Tool pose and geometric Jacobian at joint values `q` (rad or m).
    #[must_use]
    pub fn jacobian(&self, q: &[T; N]) -> Jacobian<T, N> {
        let (pose, axes) = self.walk(q);
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let mut columns = [Twist { linear: none, angular: none }; N];
        for ((link, at), out) in self.links.iter().zip(&axes).zip(&mut columns) {
            *out = match link.kind {
                JointKind::Revolute => {
                    Twist { linear: cross(&at.z, &(pose.translation - at.on_z)), angular: at.z }
                }
                JointKind::Prismatic => Twist { linear: at.z, angular: none },
            };
        }
        Jacobian { pose, columns }
    }

    /// Tool point and its derivative to every parameter at joint values `q`
    /// (rad or m). Exact, not a difference quotient.
    #[must_use]
    pub fn identification_jacobian(&self, q: &[T; N]) -> IdentificationJacobian<T, N> {
        let (pose, axes) = self.walk(q);
        let p = pose.translation;
        let links = axes.map(|at| LinkColumns {
            alpha: cross(&at.x, &(p - at.before)),
            a: at.x,
            theta: cross(&at.z, &(p - at.on_z)),
            d: at.z,
            beta: cross(&at.y, &(p - at.after)),
        });
        let outer = Pose::identity().rotation;
        let unit = [axis(&outer, 0), axis(&outer, 1), axis(&outer, 2)];
        let arm = p - self.base.translation;
        // The tool point moves along the axes of the last frame; a rotation of
        // the tool frame does not turn these.
        let flange = pose.rotation;
        let tool_axes = self.tool.rotation.transpose();
        let flange_axis = |j: usize| super::pose::rotate(&flange, &axis(&tool_axes, j));
        IdentificationJacobian {
            point: p,
            links,
            base_rotation: unit.map(|e| cross(&e, &arm)),
            base_translation: unit,
            tool: [flange_axis(0), flange_axis(1), flange_axis(2)],
        }
    }
}
