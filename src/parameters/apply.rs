use nalgebra::Vector3;

use super::{Axis, Parameter};
use crate::arm::ArmParameters;
use crate::kinematics::{LinkParameter, MdhParameters, Pose};
use crate::scalar::Scalar;

impl Parameter {
    fn apply_alone<T: Scalar, const N: usize>(self, arm: &mut ArmParameters<'_, T, N>, step: T) {
        let along = |axis: Axis| axis.unit::<T>() * step;
        match self.canonical(&arm.nominal) {
            Self::BaseTranslation(axis) => arm.base_translation += along(axis),
            Self::Tool(axis) => arm.tool += along(axis),
            Self::Link { joint, parameter } => {
                if let Some(link) = arm.corrections.get_mut(usize::from(joint)) {
                    let steps =
                        LinkParameter::ALL.map(|p| if p == parameter { step } else { T::ZERO });
                    *link = link.plus(&MdhParameters::from_array(steps));
                }
            }
            Self::Term(term) => {
                if let Some(term) = arm.terms.get_mut(usize::from(term)) {
                    term.coefficient += step;
                }
            }
            _ => {}
        }
    }
}

/// Changes many parameters, each by its step in its unit. Rotations of the base are
/// taken as one rotation vector, so that their order does not matter.
pub fn apply<T: Scalar, const N: usize>(
    arm: &mut ArmParameters<'_, T, N>,
    parameters: &[Parameter],
    steps: &[T],
) {
    let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
    let mut turn = none;
    for (parameter, step) in parameters.iter().zip(steps) {
        if let Parameter::BaseRotation(axis) = parameter {
            turn += axis.unit::<T>() * *step;
        } else {
            parameter.apply_alone(arm, *step);
        }
    }
    if turn != none {
        let before = Pose::from_rotation_vector(none, arm.base_rotation);
        let after = Pose::from_rotation_vector(none, turn).compose(&before);
        arm.base_rotation = after.rotation_vector();
    }
}
