use nalgebra::Vector3;

use crate::kinematics::{Chain, Turns, axes, cross, dot, rotate};
use crate::scalar::Scalar;

/// Masses that load an arm; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Masses<T, const N: usize> {
    /// Gravity in the frame of the chain's base, m/s^2.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub gravity: Vector3<T>,
    /// Mass of each link, kg.
    pub mass: [T; N],
    /// Centre of mass of each link in its own frame (behind its joint), m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub com: [Vector3<T>; N],
    /// Centre of mass of the payload in the last frame, m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub payload_com: Vector3<T>,
}

/// What gravity does to an arm at one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Load<T, const N: usize> {
    /// Generalised force of gravity on each joint, positive in +q: N m, or N
    /// for a prismatic joint.
    pub torque: [T; N],
    /// Overturning moment about the base's x and y axes, N m.
    pub moment: [T; 2],
}

impl<T: Scalar, const N: usize> Load<T, N> {
    /// No load.
    #[must_use]
    pub fn none() -> Self {
        Self { torque: [T::ZERO; N], moment: [T::ZERO; 2] }
    }
}

/// What gravity does to a chain, reduced to what a tick has to compute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GravityModel<T, const N: usize> {
    gravity: Vector3<T>,
    mass: [T; N],
    /// Mass times centre of mass of each link in its joint's turned frame, kg m.
    moment: [[T; 3]; N],
    /// Payload point in the last joint's turned frame, m.
    payload: [T; 3],
}

impl<T: Scalar, const N: usize> Masses<T, N> {
    /// Folds the masses for this chain, at load time. The chain's base pose
    /// must be the frame of `gravity`.
    #[must_use]
    pub(crate) fn on(&self, chain: &Chain<T, N>) -> GravityModel<T, N> {
        let mut moment = [[T::ZERO; 3]; N];
        for (i, out) in moment.iter_mut().enumerate() {
            if let (Some(m), Some(com)) = (self.mass.get(i), self.com.get(i)) {
                *out = chain.in_turned_frame(i, com).map(|x| x * *m);
            }
        }
        let payload = chain.in_turned_frame(N.saturating_sub(1), &self.payload_com);
        GravityModel { gravity: self.gravity, mass: self.mass, moment, payload }
    }

    /// Gravity torque of every joint and overturning moment of the base, at
    /// joint values `q` with `payload` kg at the payload point; exact for the
    /// rigid arm. The chain's base pose must be the frame of `gravity`.
    #[must_use]
    pub fn load(&self, chain: &Chain<T, N>, q: &[T; N], payload: T) -> Load<T, N> {
        self.on(chain).load(chain, &chain.turns(q), payload)
    }
}

impl<T: Scalar, const N: usize> GravityModel<T, N> {
    /// As [`Masses::load`]: gravity is turned outwards from joint to joint, the
    /// first moment of all that hangs on a joint is summed inwards.
    #[must_use]
    #[inline]
    pub fn load(&self, chain: &Chain<T, N>, turns: &Turns<T, N>, payload: T) -> Load<T, N> {
        let mut load = Load::none();
        let mut pull = [[T::ZERO; 3]; N];
        let root = &chain.root().rotation;
        let mut g = axes(root).map(|axis| dot(&axis, &self.gravity));
        for ((joint, (turn, _)), pull) in chain.joints().iter().zip(turns.each()).zip(&mut pull) {
            g = turn.undo(g);
            *pull = g;
            g = joint.untwist(g);
        }
        let mut mass = payload;
        let mut moment = self.payload.map(|x| x * payload);
        let joints = chain.joints().iter().zip(turns.each());
        let links = self.mass.iter().zip(&self.moment);
        let loads = pull.iter().zip(&mut load.torque);
        let mut tip = true;
        for (((joint, (turn, q)), (m, own)), (g, torque)) in joints.zip(links).zip(loads).rev() {
            if !core::mem::take(&mut tip) {
                moment = joint.twist(moment);
                for (moment, offset) in moment.iter_mut().zip(&joint.offset) {
                    *moment += *offset * mass;
                }
            }
            for (moment, own) in moment.iter_mut().zip(own) {
                *moment += *own;
            }
            mass += *m;
            *torque = if joint.prismatic() {
                moment[2] += *q * mass;
                g[2] * mass
            } else {
                moment[0] * g[1] - moment[1] * g[0]
            };
            moment = turn.apply(moment);
        }
        let [x, y, z] = moment;
        let base = chain.base();
        let arm = chain.root().translation - base.translation;
        let moment = rotate(root, &Vector3::new(x, y, z)) + arm * mass;
        let about = cross(&moment, &self.gravity);
        let [x, y, _] = axes(&base.rotation);
        load.moment = [dot(&x, &about), dot(&y, &about)];
        load
    }
}
