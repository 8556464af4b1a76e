use nalgebra::Vector3;

use crate::kinematics::{Chain, Joint, Turns, axis, cross, dot, rotate};
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

/// Masses on a chain, reduced to what a tick has to compute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights<T, const N: usize> {
    gravity: Vector3<T>,
    mass: [T; N],
    /// Mass times centre of mass of each link in its hinge's turned frame, kg m.
    moment: [[T; 3]; N],
    /// Payload point in the last hinge's turned frame, m.
    payload: [T; 3],
}

impl<T: Scalar, const N: usize> Masses<T, N> {
    /// Folds the masses for this chain, at load time. The chain's base pose
    /// must be the frame of `gravity`.
    #[must_use]
    pub fn on(&self, chain: &Chain<T, N>) -> Weights<T, N> {
        let mut moment = [[T::ZERO; 3]; N];
        for (i, out) in moment.iter_mut().enumerate() {
            if let (Some(m), Some(com)) = (self.mass.get(i), self.com.get(i)) {
                *out = chain.in_hinge(i, com).map(|x| x * *m);
            }
        }
        let payload = chain.in_hinge(N.saturating_sub(1), &self.payload_com);
        Weights { gravity: self.gravity, mass: self.mass, moment, payload }
    }

    /// Gravity torque of every joint and overturning moment of the base, at
    /// joint values `q` with `payload` kg at the payload point; exact for the
    /// rigid arm. The chain's base pose must be the frame of `gravity`.
    #[must_use]
    pub fn load(&self, chain: &Chain<T, N>, q: &[T; N], payload: T) -> Load<T, N> {
        self.on(chain).load(chain, &chain.turns(q), payload)
    }
}

impl<T: Scalar, const N: usize> Weights<T, N> {
    /// As [`Masses::load`]: gravity is turned outwards from joint to joint, the
    /// first moment of all that hangs on a joint is summed inwards.
    #[must_use]
    #[inline]
    pub fn load(&self, chain: &Chain<T, N>, turns: &Turns<T, N>, payload: T) -> Load<T, N> {
        let mut load = Load::none();
        let mut pull = [[T::ZERO; 3]; N];
        let root = &chain.root().rotation;
        let mut g = [0, 1, 2].map(|j| dot(&axis(root, j), &self.gravity));
        for (Joint { hinge, turn, .. }, pull) in turns.of(chain.hinges()).zip(&mut pull) {
            g = turn.undo(g);
            *pull = g;
            g = hinge.untwist(g);
        }
        let mut mass = payload;
        let mut moment = self.payload.map(|x| x * payload);
        let weights = self.mass.iter().zip(&self.moment);
        let joints = turns.of(chain.hinges()).zip(weights).zip(pull.iter().zip(&mut load.torque));
        for (i, ((joint, (m, own)), (g, torque))) in joints.enumerate().rev() {
            let Joint { hinge, q, turn } = joint;
            if i + 1 < N {
                moment = hinge.twist(moment);
                for (moment, offset) in moment.iter_mut().zip(&hinge.offset) {
                    *moment += *offset * mass;
                }
            }
            for (moment, own) in moment.iter_mut().zip(own) {
                *moment += *own;
            }
            mass += *m;
            *torque = if hinge.prismatic() {
                moment[2] += q * mass;
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
        load.moment = [0, 1].map(|j| dot(&axis(&base.rotation, j), &about));
        load
    }
}
