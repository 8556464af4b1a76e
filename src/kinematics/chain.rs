use nalgebra::{Matrix3, Vector3};

use super::deflection::Deflection;
use super::folded_joint::{FoldedJoint, TurnedJoint, Turns};
use super::link::Link;
use super::pose::{Pose, axes, cross, from_axes, rotate};
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
    /// All behind the last joint, `Tz(d_N) Ry(beta_N) tool`.
    pub(super) tip: Pose<T>,
}

impl<T: Scalar, const N: usize> Chain<T, N> {
    /// Folds `links`, the pose of the robot base and the pose of the tool in
    /// the last frame. Costs about 5N sine-cosines; call it at load time.
    #[must_use]
    #[inline(never)]
    pub fn new(links: &[Link<T>; N], base: Pose<T>, tool: Pose<T>) -> Self {
        let mut root = base;
        if let Some(first) = links.first() {
            let ((s, c), o, l) = (first.parameters.alpha.sin_cos_once(), T::ZERO, T::ONE);
            root = base.compose(&Pose {
                rotation: Matrix3::new(l, o, o, o, c, -s, o, s, c),
                translation: Vector3::new(first.parameters.a, o, o),
            });
        }
        let joints = FoldedJoint::between(links);
        Self { links: *links, joints, base, tool, root, tip: tool }.with_tool(tool)
    }

    /// The same chain with another tool pose in the last frame.
    #[must_use]
    pub fn with_tool(&self, tool: Pose<T>) -> Self {
        let tip = self.links.last().map_or(tool, |last| {
            let ((s, c), o, l) = (last.parameters.beta.sin_cos_once(), T::ZERO, T::ONE);
            let behind = Pose {
                rotation: Matrix3::new(c, o, s, o, l, o, -s, o, c),
                translation: Vector3::new(o, o, last.parameters.d),
            };
            behind.compose(&tool)
        });
        Self { tool, tip, ..*self }
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
        let (root, tip) = (&self.root.translation, &self.tip.translation);
        self.tool_to_base(self.turned(q), |joint, _| joint.offset, root, tip)
    }

    /// The same of the deflected arm: joints, lengths and base.
    #[must_use]
    #[inline]
    pub fn forward_deflected(&self, q: &[T; N], deflection: &Deflection<T, N>) -> Pose<T> {
        let turns = self.turns(&deflection.deflected(q));
        let [x, y, p] = self.axes_at(&turns, Some(deflection), true);
        Pose { rotation: from_axes([x, y, cross(&x, &y)]), translation: p }
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

    /// From each joint's axis to the next, with every link's growth.
    #[inline]
    pub(super) fn grown(growth: &[T; N]) -> impl Fn(&FoldedJoint<T>, usize) -> [T; 3] {
        let of = |index: usize| growth.get(index).copied().unwrap_or(T::ZERO);
        move |joint, index| joint.grown(of(index), of(index + 1))
    }

    /// Translations of root and tip, with the growth of the first and the last link.
    pub(super) fn grown_ends(&self, growth: &[T; N]) -> (Vector3<T>, Vector3<T>) {
        let (mut root, mut tip) = (self.root.translation, self.tip.translation);
        if let (Some(link), Some(growth)) = (self.links.first(), growth.first()) {
            let [along, ..] = axes(&self.base.rotation);
            root += along * (link.parameters.a * *growth);
        }
        if let (Some(link), Some(growth)) = (self.links.last(), growth.last()) {
            tip.z += link.parameters.d * *growth;
        }
        (root, tip)
    }

    /// From tool to base, with `offset` from each joint's axis to the next
    /// (joints counted from 0), `root` and `tip` in place of the translations
    /// before the first and behind the last joint.
    #[inline]
    fn tool_to_base<'a>(
        &'a self,
        joints: impl DoubleEndedIterator<Item = TurnedJoint<'a, T>>,
        offset: impl Fn(&FoldedJoint<T>, usize) -> [T; 3],
        root: &Vector3<T>,
        tip: &Vector3<T>,
    ) -> Pose<T> {
        let [x, y, p] = self.axes_to_base(joints, offset, root, tip, |_, _| ());
        Pose { rotation: from_axes([x, y, cross(&x, &y)]), translation: p }
    }

    /// The same, short of the third axis: x and y axis of the tool, and the tool
    /// point. `see` is shown the three in the turned frame of each joint, the
    /// last first.
    #[inline]
    pub(super) fn axes_to_base<'a>(
        &'a self,
        joints: impl DoubleEndedIterator<Item = TurnedJoint<'a, T>>,
        offset: impl Fn(&FoldedJoint<T>, usize) -> [T; 3],
        root: &Vector3<T>,
        tip: &Vector3<T>,
        mut see: impl FnMut(&FoldedJoint<T>, &[[T; 3]; 3]),
    ) -> [Vector3<T>; 3] {
        let [mut x, mut y, _] = self.tip.rotation.data.0;
        let mut p = [tip.x, tip.y, tip.z];
        let mut joints = joints.rev();
        let mut next = joints.next();
        let mut index = N.wrapping_sub(1);
        while let Some(TurnedJoint { joint, q, turn }) = next {
            if joint.prismatic() {
                p[2] += q;
            }
            see(joint, &[x, y, p]);
            (x, y, p) = (turn.apply(x), turn.apply(y), turn.apply(p));
            next = joints.next();
            let Some(TurnedJoint { joint: before, .. }) = next else { break };
            index = index.wrapping_sub(1);
            (x, y, p) = (before.twist(x), before.twist(y), before.twist(p));
            for (p, offset) in p.iter_mut().zip(offset(before, index)) {
                *p += offset;
            }
        }
        let turned = |[x, y, z]: [T; 3]| rotate(&self.root.rotation, &Vector3::new(x, y, z));
        [turned(x), turned(y), turned(p) + root]
    }
}
