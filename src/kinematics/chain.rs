use nalgebra::{Matrix3, Vector3};

use super::deflection::Deflection;
use super::folded_joint::{FoldedJoint, TurnedJoint, Turns};
use super::link::Link;
use super::pose::Pose;
use crate::scalar::Scalar;

/// A serial chain ready for the control loop: base, N links, tool
/// (paper Eq. 3, 18-20), with the sines of all constant angles taken at load.
///
/// Poses are of the tool in the frame the base is given in. Joint values are
/// rad (revolute) or m (prismatic), in the order of the links.
///
/// ```
/// use truearm::{Chain, JointKind, Link, MdhParameters, Pose};
///
/// // Two links of 0.3 m in a plane, the second one carries the tool.
/// let link = |a| Link {
///     kind: JointKind::Revolute,
///     parameters: MdhParameters::from_array([0.0, a, 0.0, 0.0, 0.0]),
/// };
/// let tool = Pose::translation(0.3, 0.0, 0.0);
/// let chain = Chain::new(&[link(0.0), link(0.3)], Pose::identity(), tool);
/// let point = chain.forward(&[0.0, core::f64::consts::FRAC_PI_2]).translation;
/// assert!((point.x - 0.3).abs() < 1e-12 && (point.y - 0.3).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain<T, const N: usize> {
    pub(super) links: [Link<T>; N],
    pub(super) joints: [FoldedJoint<T>; N],
    pub(super) base: Pose<T>,
    pub(super) tool: Pose<T>,
    /// All before the first joint, `base Rx(alpha_1) Tx(a_1)`.
    pub(super) root: Pose<T>,
    /// Sine and cosine of that alpha.
    pub(super) alpha: [T; 2],
    /// All behind the last joint, `Tz(d_N) Ry(beta_N) tool`.
    pub(super) tip: Pose<T>,
}

/// All behind the last joint of these links.
#[inline(never)]
fn behind<T: Scalar, const N: usize>(links: &[Link<T>; N], tool: &Pose<T>) -> Pose<T> {
    let Some(last) = links.last() else { return *tool };
    let ((s, c), o, l) = (last.parameters.beta.sin_cos_once(), T::ZERO, T::ONE);
    let behind = Pose {
        rotation: Matrix3::new(c, o, s, o, l, o, -s, o, c),
        translation: Vector3::new(o, o, last.parameters.d),
    };
    behind.compose(tool)
}

impl<T: Scalar, const N: usize> Chain<T, N> {
    /// Folds `links`, the pose of the robot base and the pose of the tool in
    /// the last frame. Costs about 5N sine-cosines; call it at load time.
    #[must_use]
    #[inline(never)]
    pub fn new(links: &[Link<T>; N], base: Pose<T>, tool: Pose<T>) -> Self {
        let (mut root, mut alpha) = (base, [T::ZERO, T::ONE]);
        if let Some(first) = links.first() {
            let ((s, c), o, l) = (first.parameters.alpha.sin_cos_once(), T::ZERO, T::ONE);
            alpha = [s, c];
            root = base.compose(&Pose {
                rotation: Matrix3::new(l, o, o, o, c, -s, o, s, c),
                translation: Vector3::new(first.parameters.a, o, o),
            });
        }
        let joints = FoldedJoint::between(links);
        let tip = behind(links, &tool);
        Self { links: *links, joints, base, tool, root, alpha, tip }
    }

    /// The same chain with another tool pose in the last frame.
    #[must_use]
    pub fn with_tool(&self, tool: Pose<T>) -> Self {
        let mut other = *self;
        other.set_tool(&tool);
        other
    }

    /// Another tool pose in the last frame.
    pub fn set_tool(&mut self, tool: &Pose<T>) {
        self.tip = behind(&self.links, tool);
        self.tool = *tool;
    }

    /// The links it was made of.
    #[must_use]
    pub fn links(&self) -> &[Link<T>; N] {
        &self.links
    }

    /// Pose of the base.
    #[must_use]
    pub fn base(&self) -> &Pose<T> {
        &self.base
    }

    /// Pose of the tool in the last frame.
    #[must_use]
    pub fn tool(&self) -> &Pose<T> {
        &self.tool
    }

    pub(crate) fn root(&self) -> &Pose<T> {
        &self.root
    }

    pub(crate) fn joints(&self) -> &[FoldedJoint<T>; N] {
        &self.joints
    }

    /// A point of the link `index` (from 0) in the turned frame of its joint.
    pub(crate) fn in_turned_frame(&self, index: usize, p: &Vector3<T>) -> [T; 3] {
        let p = [p.x, p.y, p.z];
        match (self.joints.get(index), self.links.get(index)) {
            (Some(joint), Some(link)) => joint.inside(link, p),
            _ => p,
        }
    }

    /// Sines and cosines of all joint angles at joint values `q`.
    #[inline]
    pub(crate) fn turns(&self, q: &[T; N]) -> Turns<T, N> {
        let mut turns = Turns::none();
        turns.set(&self.joints, q);
        turns
    }

    /// Pose of the tool at joint values `q`.
    ///
    /// Runs from the tool to the base with two columns and a point, the third
    /// column by a cross product at the end: 39 operations and one sine-cosine
    /// a joint, 716 instructions for six joints in `f32` on a Cortex-M4F (counted
    /// by the image in tests/firmware). In `f32` within 1 um of `f64` for a 1 m
    /// arm and |q| <= 2 pi. NaN or out-of-range joint values
    /// give NaN, never a panic.
    #[must_use]
    #[inline]
    pub fn forward(&self, q: &[T; N]) -> Pose<T> {
        self.root.of(&self.axes_to_first(self.turned(q), |_, _| ()))
    }

    /// The same of the deflected arm: joints, lengths and base.
    #[must_use]
    #[inline]
    pub fn forward_deflected(&self, q: &[T; N], deflection: &Deflection<T, N>) -> Pose<T> {
        let turns = self.turns(&deflection.deflected(q));
        let grows = deflection.growth != [T::ZERO; N];
        self.root.of(&self.axes_at(&turns, Some(deflection), grows))
    }

    /// Every joint with its angle.
    #[inline]
    pub(super) fn turned<'a>(
        &'a self,
        q: &'a [T; N],
    ) -> impl DoubleEndedIterator<Item = TurnedJoint<'a, T>> {
        self.joints.iter().zip(q).map(|(joint, q)| TurnedJoint {
            joint,
            q: *q,
            turn: joint.turn(*q),
        })
    }

    /// The first link's length, m.
    #[inline]
    pub(crate) fn first_length(&self) -> T {
        self.links.first().map_or(T::ZERO, |link| link.parameters.a)
    }

    /// A direction in the frame of the base, in the one that the first joint turns in.
    pub(crate) fn before_first(&self, v: [T; 3]) -> [T; 3] {
        let ([sin, cos], [x, y, z]) = (self.alpha, v);
        [x, cos * y + sin * z, cos * z - sin * y]
    }

    /// Two axes and the point of the tool, from the tool to the frame that the first joint
    /// turns in. `see` is shown the three in the turned frame of each joint, the last first.
    #[inline]
    pub(super) fn axes_to_first<'a>(
        &self,
        joints: impl DoubleEndedIterator<Item = TurnedJoint<'a, T>>,
        mut see: impl FnMut(&FoldedJoint<T>, &[[T; 3]; 3]),
    ) -> [Vector3<T>; 3] {
        let [mut x, mut y, _] = self.tip.rotation.data.0;
        let [mut p] = self.tip.translation.data.0;
        let mut joints = joints.rev();
        let mut next = joints.next();
        while let Some(TurnedJoint { joint, q, turn }) = next {
            if joint.prismatic() {
                p[2] += q;
            }
            see(joint, &[x, y, p]);
            (x, y, p) = (turn.apply(x), turn.apply(y), turn.apply(p));
            next = joints.next();
            let Some(TurnedJoint { joint: before, .. }) = next else { break };
            (x, y, p) = (before.twist(x), before.twist(y), before.twist(p));
            for (p, offset) in p.iter_mut().zip(&before.offset) {
                *p += *offset;
            }
        }
        [x, y, p].map(Vector3::from)
    }
}
