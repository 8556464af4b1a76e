//! What a deflection beyond joints does: links grow, the base and the axes of joints tilt.
//! The tool is walked to the first joint as if nothing did; then it is moved by what all do
//! together, tilts to first order: a rotation, and a shift of its centre.

use nalgebra::Vector3;

use super::chain::Chain;
use super::deflection::Deflection;
use super::folded_joint::Turns;
use super::jacobian::LinkColumns;
use super::pose::{cross, dot, tilt};
use crate::scalar::Scalar;

impl<T: Scalar, const N: usize> Chain<T, N> {
    /// Moves two axes and the point of the tool, in the frame that the first joint turns in,
    /// with the axes of joints, with the base, and with links if any `grows`.
    #[inline]
    pub(super) fn deflect(
        &self,
        frame: &mut [Vector3<T>; 3],
        turns: &Turns<T, N>,
        deflection: &Deflection<T, N>,
        grows: bool,
    ) {
        let [x, y] = deflection.base;
        // There the base's axes are (1, 0, 0) and (0, cos, -sin).
        let [sin, cos] = self.alpha;
        let mut about = Vector3::new(x, y * cos, -(y * sin));
        if grows || deflection.axes.is_some() {
            let [more, shift] = self.moved(turns, deflection);
            about += more;
            frame[2] += shift;
        }
        if [about.x, about.y, about.z] == [T::ZERO; 3] {
            return;
        }
        // About the base's origin.
        let a = self.first_length();
        frame[2].x += a;
        tilt(frame, &about);
        frame[2].x -= a;
    }

    /// The rotation of the tool by all axes together, and by how much they move the
    /// base's origin if that were fixed to the tool, and growth the tool; in the frame that the
    /// first joint turns in. Inwards, from frame to frame.
    #[inline(never)]
    fn moved(&self, turns: &Turns<T, N>, deflection: &Deflection<T, N>) -> [Vector3<T>; 2] {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let (mut about, mut shift) = (none, none);
        let (mut next, mut tilted) = (T::ZERO, false);
        let links = self.joints.iter().zip(&self.links).zip(turns.each());
        let own = deflection.growth.iter().enumerate();
        for (((joint, link), (turn, q)), (index, growth)) in links.zip(own).rev() {
            // From the next joint's frame to this one's.
            let inward = |v: &Vector3<T>, way: [T; 3]| {
                let [x, y, z] = joint.twist([v.x, v.y, v.z]);
                Vector3::from(turn.apply([x + way[0], y + way[1], z + way[2]]))
            };
            shift = inward(&shift, joint.growth(*growth, next));
            next = *growth;
            if tilted {
                about = inward(&about, [T::ZERO; 3]);
                let [ox, oy, oz] = joint.offset;
                let slides = if joint.prismatic() { *q } else { T::ZERO };
                shift -= cross(&about, &Vector3::from(turn.apply([ox, oy, oz + slides])));
            }
            let tilt = deflection.axes.as_ref().and_then(|tilts| tilts.get(index));
            if let Some([x, y]) = tilt.filter(|tilt| **tilt != [T::ZERO; 2]) {
                let [x, y, _] = joint.behind(link).apply([*x, *y, T::ZERO]);
                about += Vector3::new(x, y, T::ZERO);
                tilted = true;
            }
        }
        // The lever there is (a, 0, 0).
        let a = self.first_length();
        shift += Vector3::new(next, -about.z, about.y) * a;
        [about, shift]
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
