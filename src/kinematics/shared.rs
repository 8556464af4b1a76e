//! Poses of chains at angles whose sines are known already: a tick looks at the
//! nominal and at the identified arm near one command, and these differ by small angles.

use nalgebra::Vector3;

use super::chain::Chain;
use super::deflection::Deflection;
use super::folded_joint::{FoldedJoint, Turn, Turns};
use super::jacobian::Twist;
use super::pose::Pose;
use crate::scalar::Scalar;

impl<T: Scalar> Turn<T> {
    /// By no angle.
    pub fn none() -> Self {
        Self { sin: T::ZERO, cos: T::ONE }
    }

    /// By this angle and another one: four products in place of a sine.
    #[inline]
    pub fn then(&self, other: &Self) -> Self {
        Self {
            sin: self.sin * other.cos + self.cos * other.sin,
            cos: self.cos * other.cos - self.sin * other.sin,
        }
    }
}

impl<T: Scalar, const N: usize> Turns<T, N> {
    /// At joint values zero, of joints without angle.
    pub(crate) fn none() -> Self {
        Self { turns: [Turn::none(); N], q: [T::ZERO; N] }
    }

    /// The joint values.
    #[inline]
    pub(crate) fn joints(&self) -> &[T; N] {
        &self.q
    }

    // In place: a tick has no time for copies.

    /// Becomes those of `joints` at joint values `q`.
    #[inline(never)]
    pub(crate) fn set(&mut self, joints: &[FoldedJoint<T>; N], q: &[T; N]) {
        self.q = *q;
        for (turn, (joint, q)) in self.turns.iter_mut().zip(joints.iter().zip(q)) {
            *turn = joint.turn_once(*q);
        }
    }

    /// The same for a tick, where time counts more than text; and `other` becomes these
    /// with every joint turned on by a constant angle.
    #[inline(never)]
    pub(crate) fn set_both(
        &mut self,
        joints: &[FoldedJoint<T>; N],
        q: &[T; N],
        other: &mut Self,
        by: &[Turn<T>; N],
    ) {
        (self.q, other.q) = (*q, *q);
        let places = self.turns.iter_mut().zip(&mut other.turns);
        for ((turn, other), (joint, (q, by))) in places.zip(joints.iter().zip(q.iter().zip(by))) {
            *turn = joint.turn(*q);
            *other = turn.then(by);
        }
    }

    /// Becomes `other`, of the same joints, at joint values further by `by`, rad or m.
    #[inline]
    pub(crate) fn set_moved(&mut self, other: &Self, joints: &[FoldedJoint<T>; N], by: &[T; N]) {
        let places = self.turns.iter_mut().zip(&mut self.q);
        let others = other.turns.iter().zip(&other.q);
        for ((turn, q), ((other, at), (joint, by))) in places.zip(others.zip(joints.iter().zip(by)))
        {
            *q = *at + *by;
            *turn = *other;
            if !joint.prismatic() {
                let (sin, cos) = by.sin_cos_near_zero();
                *turn = turn.then(&Turn { sin, cos });
            }
        }
    }
}

impl<T: Scalar, const N: usize> Chain<T, N> {
    /// By how much the angle of each joint is further than in `other` at the
    /// same joint value.
    pub(crate) fn turned_from(&self, other: &Self) -> [Turn<T>; N] {
        let mut joints = self.joints.iter().zip(&other.joints);
        [(); N].map(|()| {
            joints.next().map_or(Turn::none(), |(own, other)| {
                let (own, other) = (own.turn(T::ZERO), other.turn(T::ZERO));
                own.then(&Turn { sin: -other.sin, ..other })
            })
        })
    }

    /// Tool pose with the sines taken already, with `root` in place of all before the first
    /// joint; the geometric Jacobian *in the frame of the tool* goes into `columns`.
    ///
    /// On the way from the tool inwards the axes and the point of the tool
    /// pass through the frame of every joint. There the joint's axis is z, and
    /// a column has two products a coordinate; from the base outwards, in the
    /// frame of the base, it takes half as many operations again.
    #[inline]
    pub(crate) fn tool_jacobian(
        &self,
        turns: &Turns<T, N>,
        columns: &mut [Twist<T>; N],
        root: &Pose<T>,
    ) -> Pose<T> {
        let mut places = columns.iter_mut().rev();
        let frame = self.axes_to_first(turns.of(&self.joints), |joint, [x, y, p]| {
            let Some(column) = places.next() else { return };
            // The tool's third axis. The z coordinates of all three are the
            // joint's axis in the frame of the tool.
            let z =
                [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
            let axis = Vector3::new(x[2], y[2], z[2]);
            if joint.prismatic() {
                *column = Twist { linear: axis, ..Twist::zero() };
            } else {
                // z x p = (-p_y, p_x, 0).
                let along = |a: &[T; 3]| a[1] * p[0] - a[0] * p[1];
                column.linear = Vector3::new(along(x), along(y), along(&z));
                column.angular = axis;
            }
        });
        root.of(&frame)
    }

    /// Two axes and the point of the tool in the frame that the first joint turns in, with
    /// the sines taken already; of the `deflected` chain, whose angles are those of `turns` as
    /// they are, but whose links grow and whose base tilts. Where they do not grow, the same
    /// bits take fewer instructions by saying so. One copy of it serves all.
    #[inline(never)]
    pub(crate) fn axes_at(
        &self,
        turns: &Turns<T, N>,
        deflected: Option<&Deflection<T, N>>,
        grows: bool,
    ) -> [Vector3<T>; 3] {
        let mut frame = self.axes_to_first(turns.of(&self.joints), |_, _| ());
        if let Some(deflected) = deflected {
            self.deflect(&mut frame, turns, deflected, grows);
        }
        frame
    }
}
