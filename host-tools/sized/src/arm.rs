//! The arm as the controller has it.

use truearm::{Approach, Arm, Pose, Scalar, State};

use crate::{Parameters, fixed, with_joints};

/// What a controller knows of a moment beside the joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions<'a> {
    /// How each joint came to rest.
    pub approach: &'a [Approach],
    /// kg; that of the arm at rest if nothing is known.
    pub payload: Option<f64>,
    /// Degrees Celsius, as the arm has it; the same.
    pub temperature: Option<f64>,
    /// What loads each joint, N m or N, in the sense of gravity's torque; that of the masses if
    /// nothing is read.
    pub torque: Option<&'a [f64]>,
}

impl Conditions<'_> {
    pub(crate) fn state<T: Scalar, const N: usize>(&self, arm: &Arm<'_, T, N>) -> State<T, N> {
        let rest = arm.state();
        State {
            approach: fixed(self.approach),
            payload: self.payload.map_or(rest.payload, T::from_f64),
            temperature: self.temperature.map_or(rest.temperature, T::from_f64),
            torque: self.torque.map(|torque| fixed::<f64, N>(torque).map(T::from_f64)),
        }
    }
}

/// An arm with everything identified.
pub trait RealArm {
    /// Where its tool stands at joint values `q`, rad or m.
    fn real_pose(&self, q: &[f64], at: &Conditions<'_>) -> Pose<f64>;
}

struct Sized<'t, const N: usize>(Arm<'t, f64, N>);

impl<const N: usize> RealArm for Sized<'_, N> {
    fn real_pose(&self, q: &[f64], at: &Conditions<'_>) -> Pose<f64> {
        self.0.real_pose_in(&fixed(q), &at.state(&self.0))
    }
}

/// The arm of these parameters.
#[must_use]
pub fn real_arm<'t>(parameters: &Parameters<'t>) -> Box<dyn RealArm + 't> {
    with_joints!(parameters.nominal.len(), N => {
        Box::new(Sized(Arm::new(&parameters.sized::<N>())))
    })
}
