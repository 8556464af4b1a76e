//! Tilts of the base and of the axes of joints. The tool is walked to the base as if
//! nothing tilted; then it is moved by what all tilts together do, to first order: a
//! rotation, and a shift of its centre.

use nalgebra::Vector3;

use super::chain::Chain;
use super::deflection::Deflection;
use super::folded_joint::Turns;
use super::jacobian::LinkColumns;
use super::pose::{Pose, axes, cross, dot, rotate};
use crate::scalar::Scalar;

impl<T: Scalar, const N: usize> Chain<T, N> {
    /// Tilts the pose of the tool with the axes of joints and with the base.
    #[inline]
    pub(super) fn tilt(
        &self,
        pose: &mut Pose<T>,
        turns: &Turns<T, N>,
        deflection: &Deflection<T, N>,
    ) {
        let [x, y] = deflection.base;
        let [about_x, about_y, _] = axes(&self.base.rotation);
        let mut about = about_x * x + about_y * y;
        if let Some(tilts) = &deflection.axes {
            let [more, shift] = self.tilts_of_axes(turns, tilts);
            about += more;
            pose.translation += shift;
        } else if x == T::ZERO && y == T::ZERO {
            return;
        }
        pose.tilt(&self.base.translation, &about);
    }

    /// The rotation of the tool by all axes together, and by how much they move the
    /// base's origin if that were fixed to the tool. Inwards, from frame to frame.
    // Cold: few arms have axes that tilt.
    #[cold]
    #[inline(never)]
    fn tilts_of_axes(&self, turns: &Turns<T, N>, tilts: &[[T; 2]; N]) -> [Vector3<T>; 2] {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let (mut about, mut shift) = (none, none);
        let links = self.joints.iter().zip(&self.links);
        for (((joint, link), (turn, q)), [x, y]) in links.zip(turns.each()).zip(tilts).rev() {
            // From the next joint's frame to this one's.
            let inward = |v: &Vector3<T>| {
                let [x, y, z] = turn.apply(joint.twist([v.x, v.y, v.z]));
                Vector3::new(x, y, z)
            };
            (about, shift) = (inward(&about), inward(&shift));
            let [ox, oy, oz] = joint.offset;
            let slides = if joint.prismatic() { *q } else { T::ZERO };
            let [ox, oy, oz] = turn.apply([ox, oy, oz + slides]);
            shift -= cross(&about, &Vector3::new(ox, oy, oz));
            if *x != T::ZERO || *y != T::ZERO {
                let [x, y, _] = joint.behind(link).apply([*x, *y, T::ZERO]);
                about += Vector3::new(x, y, T::ZERO);
            }
        }
        let [about, shift] = [about, shift].map(|v| rotate(&self.root.rotation, &v));
        let arm = self.root.translation - self.base.translation;
        [about, shift - cross(&about, &arm)]
    }
}

impl<T: Scalar> LinkColumns<T> {
    /// With respect to a rotation of the joint's axis about the x and about the y of
    /// the frame that the joint turns in, behind alpha and a. A rotation about that x
    /// is one by alpha; the one about y follows from the lever, of which the products
    /// with x and z are known.
    #[must_use]
    pub fn tilts(&self) -> [Vector3<T>; 2] {
        let y = cross(&self.d, &self.a);
        [self.alpha, -(self.a * dot(&self.alpha, &y) + self.d * dot(&self.theta, &y))]
    }
}
