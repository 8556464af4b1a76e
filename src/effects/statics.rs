use nalgebra::Vector3;

use crate::kinematics::{Chain, FoldedJoint, Turns, dot};
use crate::scalar::Scalar;

/// Masses that load an arm; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Masses<T, const N: usize> {
    /// Gravity in the frame of the chain's own base, wherever that stands, m/s^2.
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
    /// Moment across each joint's axis, about the x and y of the frame that the joint
    /// turns in, behind its link's alpha and a, N m; `None` where it is not wanted.
    pub across: Option<[[T; 2]; N]>,
}

impl<T: Scalar, const N: usize> Load<T, N> {
    /// No load.
    #[must_use]
    pub fn none() -> Self {
        Self { torque: [T::ZERO; N], moment: [T::ZERO; 2], across: None }
    }

    /// Size of the moment across a joint's axis, N m, and its direction: x and y of a
    /// unit vector, or of none without a moment.
    pub(crate) fn across_axis(&self, joint: usize) -> Option<[T; 3]> {
        let [x, y] = *self.across.as_ref()?.get(joint)?;
        let size = (x * x + y * y).sqrt();
        let per = if size > T::ZERO { T::ONE / size } else { T::ZERO };
        Some([size, x * per, y * per])
    }
}

/// What gravity does to a chain, reduced to what a tick has to compute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GravityModel<T, const N: usize> {
    /// Gravity in the frame that the first joint turns in, m/s^2.
    gravity: [T; 3],
    /// Overturning moment about the base's x and y axes: what a first moment there gives
    /// along each axis, m/s^2, and what a mass adds, m^2/s^2.
    overturning: [(Vector3<T>, T); 2],
    mass: [T; N],
    /// Mass times centre of mass of each link in its joint's turned frame, kg m.
    moment: [[T; 3]; N],
    /// Payload point in the last joint's turned frame, m.
    payload: [T; 3],
}

impl<T: Scalar, const N: usize> Masses<T, N> {
    /// Folds the masses for this chain, at load time.
    #[must_use]
    pub(crate) fn on(&self, chain: &Chain<T, N>) -> GravityModel<T, N> {
        let mut moment = [[T::ZERO; 3]; N];
        for (i, out) in moment.iter_mut().enumerate() {
            if let (Some(m), Some(com)) = (self.mass.get(i), self.com.get(i)) {
                *out = chain.in_turned_frame(i, com).map(|x| x * *m);
            }
        }
        let payload = chain.in_turned_frame(N.saturating_sub(1), &self.payload_com);
        let [x, y, z]: [T; 3] = self.gravity.into();
        // The base's x (m x g) = m (g x x).
        let overturning = [[T::ZERO, z, -y], [-z, T::ZERO, x]].map(|per_moment| {
            let per_mass = per_moment[0] * chain.first_length();
            (chain.before_first(per_moment).into(), per_mass)
        });
        let gravity = chain.before_first([x, y, z]);
        GravityModel { gravity, overturning, mass: self.mass, moment, payload }
    }

    /// Gravity torque of every joint, moment across its axis, and overturning moment of
    /// the base, at joint values `q` with `payload` kg at the payload point; exact for the
    /// rigid arm.
    #[must_use]
    pub fn load(&self, chain: &Chain<T, N>, q: &[T; N], payload: T) -> Load<T, N> {
        let (model, turns) = (self.on(chain), chain.turns(q));
        let across = Some(model.across(chain, &turns, payload, |_| true));
        Load { across, ..model.load(chain, &turns, payload) }
    }
}

impl<T: Scalar, const N: usize> GravityModel<T, N> {
    /// As [`Masses::load`], but for the moments across the axes.
    #[must_use]
    #[inline]
    pub fn load(&self, chain: &Chain<T, N>, turns: &Turns<T, N>, payload: T) -> Load<T, N> {
        let mut load = Load::none();
        let pull = self.pull(chain, turns);
        let mut loads = pull.iter().zip(&mut load.torque).rev();
        let (moment, mass) = self.hang(chain, turns, payload, |joint, moment, mass| {
            let Some((g, torque)) = loads.next() else { return };
            *torque =
                if joint.prismatic() { g[2] * mass } else { moment[0] * g[1] - moment[1] * g[0] };
        });
        let moment = Vector3::from(moment);
        let about =
            |(per_moment, per_mass): &(Vector3<T>, T)| dot(per_moment, &moment) + *per_mass * mass;
        let [x, y] = &self.overturning;
        load.moment = [about(x), about(y)];
        load
    }

    /// Gravity in the turned frame of each joint, outwards from joint to joint.
    #[inline(always)]
    fn pull(&self, chain: &Chain<T, N>, turns: &Turns<T, N>) -> [[T; 3]; N] {
        let mut pull = [[T::ZERO; 3]; N];
        let mut g = self.gravity;
        for ((joint, (turn, _)), pull) in chain.joints().iter().zip(turns.each()).zip(&mut pull) {
            g = turn.undo(g);
            *pull = g;
            g = joint.untwist(g);
        }
        pull
    }

    /// First moment and mass of all that hangs on a joint, inwards from the last: `see`
    /// is shown those of each in its turned frame. Returns those of the arm.
    #[inline(always)]
    fn hang(
        &self,
        chain: &Chain<T, N>,
        turns: &Turns<T, N>,
        payload: T,
        mut see: impl FnMut(&FoldedJoint<T>, &[T; 3], T),
    ) -> ([T; 3], T) {
        let mut mass = payload;
        let mut moment = self.payload.map(|x| x * payload);
        let joints = chain.joints().iter().zip(turns.each());
        let links = self.mass.iter().zip(&self.moment);
        let mut tip = true;
        for ((joint, (turn, q)), (m, own)) in joints.zip(links).rev() {
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
            if joint.prismatic() {
                moment[2] += *q * mass;
            }
            see(joint, &moment, mass);
            moment = turn.apply(moment);
        }
        (moment, mass)
    }

    /// Moment across the axes of the `wanted` joints, as [`Load::across`] has it; across those
    /// of others none.
    // On its own and cold: most arms need none.
    #[cold]
    #[inline(never)]
    pub fn across(
        &self,
        chain: &Chain<T, N>,
        turns: &Turns<T, N>,
        payload: T,
        wanted: impl Fn(usize) -> bool,
    ) -> [[T; 2]; N] {
        let mut out = [[T::ZERO; 2]; N];
        let pull = self.pull(chain, turns);
        let joints = chain.links().iter().zip(turns.each());
        let mut places = joints.zip(&pull).zip(&mut out).enumerate().rev();
        let _ = self.hang(chain, turns, payload, |joint, moment, _| {
            let Some((index, (((link, (turn, _)), g), out))) = places.next() else { return };
            // The frame of a link costs a sine.
            if !wanted(index) {
                return;
            }
            let x = moment[1] * g[2] - moment[2] * g[1];
            let y = moment[2] * g[0] - moment[0] * g[2];
            let [x, y, _] = joint.behind(link).undo(turn.apply([x, y, T::ZERO]));
            *out = [x, y];
        });
        out
    }
}
