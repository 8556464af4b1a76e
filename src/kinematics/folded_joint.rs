use super::link::{JointKind, Link, MdhParameters};
use super::step::Step;
use crate::scalar::Scalar;

/// A joint with the constant way to the next one, reduced to what a tick has
/// to compute.
///
/// Between two joints stand `Tz(d) Ry(beta) Rx(alpha) Tx(a)`. Its rotation is
/// also `Rz(before) Rx(twist) Rz(behind)`; the two turns about z join the
/// constant angles of the joints on either side, so that beta costs nothing:
/// a joint is `Rz(theta + q) T(offset) Rx(twist)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoldedJoint<T> {
    pub kind: JointKind,
    /// Constant part of the angle about the joint axis.
    theta: T,
    /// The share of it that this link's beta and the next one's alpha add.
    before: T,
    /// Of a prismatic joint, whose angle never changes.
    sin_theta: T,
    cos_theta: T,
    pub sin_twist: T,
    pub cos_twist: T,
    /// From a point on this axis to one on the next, turned with the joint.
    pub offset: [T; 3],
    /// The part of its z that the next link's length is; its x and y are that length's alone.
    down: T,
    /// This link's offset, the rest of its z; behind the last joint the tip has it.
    along: T,
}

/// Sine and cosine of a joint's angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn<T> {
    pub sin: T,
    pub cos: T,
}

/// All joints of a [`super::Chain`] at one moment, so that pose, Jacobian and
/// gravity loads share the sines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turns<T, const N: usize> {
    pub(super) turns: [Turn<T>; N],
    pub(super) q: [T; N],
}

/// A joint at joint value `q`.
pub struct TurnedJoint<'a, T> {
    pub joint: &'a FoldedJoint<T>,
    pub q: T,
    pub turn: Turn<T>,
}

impl<T: Scalar, const N: usize> Turns<T, N> {
    /// Angle and value of every joint.
    #[inline]
    pub fn each(&self) -> impl DoubleEndedIterator<Item = (&Turn<T>, &T)> + ExactSizeIterator {
        self.turns.iter().zip(&self.q)
    }

    /// Every joint with its angle.
    #[inline]
    pub fn of<'a>(
        &'a self,
        joints: &'a [FoldedJoint<T>; N],
    ) -> impl DoubleEndedIterator<Item = TurnedJoint<'a, T>> {
        let turns = self.turns.iter().zip(&self.q);
        joints.iter().zip(turns).map(|(joint, (turn, q))| TurnedJoint { joint, q: *q, turn: *turn })
    }
}

impl<T: Scalar> Turn<T> {
    /// `Rz(angle) v`.
    #[inline]
    pub fn apply(&self, v: [T; 3]) -> [T; 3] {
        [self.cos * v[0] - self.sin * v[1], self.sin * v[0] + self.cos * v[1], v[2]]
    }

    /// `Rz(-angle) v`.
    #[inline]
    pub fn undo(&self, v: [T; 3]) -> [T; 3] {
        [self.cos * v[0] + self.sin * v[1], self.cos * v[1] - self.sin * v[0], v[2]]
    }
}

impl<T: Scalar> FoldedJoint<T> {
    /// The joints of a chain of links. The way behind the last is the tip's.
    pub fn between<const N: usize>(links: &[Link<T>; N]) -> [Self; N] {
        let none = Self {
            kind: JointKind::Revolute,
            theta: T::ZERO,
            before: T::ZERO,
            sin_theta: T::ZERO,
            cos_theta: T::ONE,
            sin_twist: T::ZERO,
            cos_twist: T::ONE,
            offset: [T::ZERO; 3],
            down: T::ZERO,
            along: T::ZERO,
        };
        let mut joints = [none; N];
        Self::fold(&mut joints, links);
        joints
    }

    // Of slices, whose length the optimiser does not know: what is done once is
    // not unrolled.
    #[inline(never)]
    fn fold(joints: &mut [Self], links: &[Link<T>]) {
        let mut behind = T::ZERO;
        for (i, (joint, this)) in joints.iter_mut().zip(links).enumerate() {
            joint.kind = this.kind;
            joint.theta = this.parameters.theta + behind;
            joint.along = this.parameters.d;
            behind = match links.get(i + 1) {
                Some(next) => joint.reach(this, next),
                None => T::ZERO,
            };
            (joint.sin_theta, joint.cos_theta) = joint.theta.sin_cos_once();
        }
    }

    /// Takes in the way from `this` link to the `next`; returns the turn about
    /// the next axis.
    #[inline(never)]
    fn reach(&mut self, this: &Link<T>, next: &Link<T>) -> T {
        let (sb, cb) = this.parameters.beta.sin_cos_once();
        let (sa, ca) = next.parameters.alpha.sin_cos_once();
        // Third column and third row of Ry(beta) Rx(alpha), compared with those
        // of Rz(before) Rx(twist) Rz(behind). The twist takes alpha's sign, so
        // that without beta nothing turns.
        let size = (sa * sa + sb * ca * (sb * ca)).sqrt();
        self.sin_twist = if sa < T::ZERO { -size } else { size };
        self.cos_twist = cb * ca;
        let sign = if sa < T::ZERO { -T::ONE } else { T::ONE };
        let before = (sign * sb * ca).atan2(sign * sa);
        let behind = (-sign * sb).atan2(sign * cb * sa);
        self.theta += before;
        self.before = before;
        let (s, c) = before.sin_cos_once();
        let a = next.parameters.a;
        self.down = -(sb * a);
        self.offset = [c * cb * a, -(s * cb * a), self.down + self.along];
        behind
    }

    /// By how much the way to the next joint, or to the tip, grows with this link and the next.
    #[inline]
    pub fn growth(&self, this: T, next: T) -> [T; 3] {
        let [x, y, _] = self.offset;
        [x * next, y * next, self.down * next + self.along * this]
    }

    /// `Rx(twist) v`.
    #[inline]
    pub fn twist(&self, v: [T; 3]) -> [T; 3] {
        let (s, c) = (self.sin_twist, self.cos_twist);
        [v[0], c * v[1] - s * v[2], s * v[1] + c * v[2]]
    }

    /// `Rx(-twist) v`.
    #[inline]
    pub fn untwist(&self, v: [T; 3]) -> [T; 3] {
        let (s, c) = (self.sin_twist, self.cos_twist);
        [v[0], c * v[1] + s * v[2], c * v[2] - s * v[1]]
    }

    /// A point of this link's frame, behind `Tz(d) Ry(beta)`, in the turned frame.
    #[inline(never)]
    pub fn inside(&self, link: &Link<T>, p: [T; 3]) -> [T; 3] {
        let MdhParameters { d, beta, .. } = link.parameters;
        let (s, c) = beta.sin_cos_once();
        let [x, y, z] = [c * p[0] + s * p[2], p[1], c * p[2] - s * p[0] + d];
        // What the joint turns more than the link, on this side of it.
        let (s, c) = self.before.sin_cos_once();
        [c * x + s * y, c * y - s * x, z]
    }

    /// By how much the frame that this `link` turns in, behind its alpha and a, is
    /// turned against the one that the folded joint turns in.
    pub fn behind(&self, link: &Link<T>) -> Turn<T> {
        let angle = self.theta - self.before - link.parameters.theta;
        // Where no beta is, as in most nominal arms, nothing is.
        if angle == T::ZERO {
            return Turn::none();
        }
        let (sin, cos) = angle.sin_cos_once();
        Turn { sin, cos }
    }

    /// The angle at joint value `q`, rad or m.
    #[inline]
    pub fn turn(&self, q: T) -> Turn<T> {
        let (sin, cos) = match self.kind {
            JointKind::Revolute => (q + self.theta).sin_cos(),
            JointKind::Prismatic => (self.sin_theta, self.cos_theta),
        };
        Turn { sin, cos }
    }

    /// The same by a call of the sine, where text counts more than time.
    #[inline]
    pub fn turn_once(&self, q: T) -> Turn<T> {
        let (sin, cos) = match self.kind {
            JointKind::Revolute => (q + self.theta).sin_cos_once(),
            JointKind::Prismatic => (self.sin_theta, self.cos_theta),
        };
        Turn { sin, cos }
    }

    /// Its constants, for others.
    pub fn step(&self) -> Step<T> {
        Step {
            kind: self.kind,
            theta: self.theta,
            constant_turn: [self.sin_theta, self.cos_theta],
            twist: [self.sin_twist, self.cos_twist],
            offset: self.offset,
        }
    }

    /// Whether it slides.
    #[inline]
    pub fn prismatic(&self) -> bool {
        self.kind == JointKind::Prismatic
    }
}
