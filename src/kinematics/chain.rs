use nalgebra::{Matrix3, Vector3};

use super::hinge::{Hinge, Joint, Turn, Turns};
use super::link::{JointKind, Link};
use super::pose::{Pose, axis, cross, rotate};
use crate::effects::Bending;
use crate::scalar::Scalar;

/// A serial chain ready for the control loop: base, N links, tool
/// (paper Eq. 3, 18-20), with the sines of all constant angles taken at load.
///
/// Poses are of the tool in the frame the base is given in. Joint values are
/// rad (revolute) or m (prismatic), in the order of the links.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain<T, const N: usize> {
    pub(super) links: [Link<T>; N],
    pub(super) hinges: [Hinge<T>; N],
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
        let hinges = Hinge::between(links);
        Self { links: *links, hinges, base, tool, root, tip: tool }.with_tool(tool)
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

    pub(crate) fn hinges(&self) -> &[Hinge<T>; N] {
        &self.hinges
    }

    /// A point of the link `index` (from 0) in the turned frame of its hinge.
    pub(crate) fn in_hinge(&self, index: usize, p: &Vector3<T>) -> [T; 3] {
        let p = [p.x, p.y, p.z];
        match (self.hinges.get(index), self.links.get(index)) {
            (Some(hinge), Some(link)) => hinge.inside(link, p),
            _ => p,
        }
    }

    /// Sines and cosines of all joint angles at joint values `q`.
    #[must_use]
    #[inline]
    pub fn turns(&self, q: &[T; N]) -> Turns<T, N> {
        let mut joints = self.turned(q);
        let none = Turn { sin: T::ZERO, cos: T::ONE };
        Turns { turns: [(); N].map(|()| joints.next().map_or(none, |joint| joint.turn)), q: *q }
    }

    /// Pose of the tool at joint values `q`.
    ///
    /// Runs from the tool to the base with two columns and a point, the third
    /// column by a cross product at the end: 39 operations and one sine-cosine
    /// a joint, 650 instructions for six joints in `f32` on a Cortex-M4F (counted
    /// by the image in tests/firmware). In `f32` within 1 um of `f64` for a 1 m
    /// arm and |q| <= 2 pi. NaN or out-of-range joint values
    /// give NaN, never a panic.
    #[must_use]
    #[inline]
    pub fn forward(&self, q: &[T; N]) -> Pose<T> {
        let (root, tip) = (&self.root.translation, &self.tip.translation);
        self.carry(self.turned(q), |hinge, _| hinge.offset, root, tip)
    }

    /// Tool pose with everything bent that terms bend: joints, lengths, base.
    #[must_use]
    #[inline]
    pub fn forward_bent(&self, q: &[T; N], bending: &Bending<T, N>) -> Pose<T> {
        let joints = bending.bent(q);
        let mut pose = if bending.grows() {
            let (root, tip) = self.grown_ends(&bending.growth);
            self.carry(self.turned(&joints), Self::grown(&bending.growth), &root, &tip)
        } else {
            self.forward(&joints)
        };
        self.tilt(&mut pose, bending);
        pose
    }

    /// Tilts a pose with the base.
    #[inline]
    pub(super) fn tilt(&self, pose: &mut Pose<T>, bending: &Bending<T, N>) {
        let [x, y] = bending.base;
        if x != T::ZERO || y != T::ZERO {
            let r = &self.base.rotation;
            pose.tilt(&self.base.translation, &(axis(r, 0) * x + axis(r, 1) * y));
        }
    }

    /// Every hinge with its angle.
    #[inline]
    pub(super) fn turned<'a>(
        &'a self,
        q: &'a [T; N],
    ) -> impl DoubleEndedIterator<Item = Joint<'a, T>> + ExactSizeIterator {
        self.hinges.iter().zip(q).map(|(hinge, q)| Joint { hinge, q: *q, turn: hinge.turn(*q) })
    }

    /// From each joint's axis to the next, with every link's growth.
    #[inline]
    pub(super) fn grown(growth: &[T; N]) -> impl Fn(&Hinge<T>, usize) -> [T; 3] {
        let of = |index: usize| growth.get(index).copied().unwrap_or(T::ZERO);
        move |hinge, index| hinge.grown(of(index), of(index + 1))
    }

    /// Translations of root and tip, with the growth of the first and the last link.
    pub(super) fn grown_ends(&self, growth: &[T; N]) -> (Vector3<T>, Vector3<T>) {
        let (mut root, mut tip) = (self.root.translation, self.tip.translation);
        if let (Some(link), Some(growth)) = (self.links.first(), growth.first()) {
            root += axis(&self.base.rotation, 0) * (link.parameters.a * *growth);
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
    fn carry<'a>(
        &'a self,
        joints: impl DoubleEndedIterator<Item = Joint<'a, T>> + ExactSizeIterator,
        offset: impl Fn(&Hinge<T>, usize) -> [T; 3],
        root: &Vector3<T>,
        tip: &Vector3<T>,
    ) -> Pose<T> {
        let column = |j: usize| {
            let m = &self.tip.rotation;
            [m[(0, j)], m[(1, j)], m[(2, j)]]
        };
        let mut state = [column(0), column(1), [tip.x, tip.y, tip.z]];
        let mut joints = joints.enumerate().rev();
        let mut next = joints.next();
        while let Some((_, Joint { hinge, q, turn })) = next {
            if hinge.kind == JointKind::Prismatic {
                state[2][2] += q;
            }
            for v in &mut state {
                *v = turn.apply(*v);
            }
            next = joints.next();
            let Some((index, Joint { hinge: before, .. })) = next else { break };
            for v in &mut state {
                *v = before.twist(*v);
            }
            for (p, offset) in state[2].iter_mut().zip(offset(before, index)) {
                *p += offset;
            }
        }
        let [x, y, p] = state.map(|[x, y, z]| Vector3::new(x, y, z));
        let x = rotate(&self.root.rotation, &x);
        let y = rotate(&self.root.rotation, &y);
        let z = cross(&x, &y);
        Pose {
            rotation: Matrix3::from_columns(&[x, y, z]),
            translation: rotate(&self.root.rotation, &p) + root,
        }
    }
}
