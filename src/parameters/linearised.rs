use nalgebra::Vector3;

use super::Parameter;
use crate::arm::{Arm, State};
use crate::effects::TermInputs;
use crate::kinematics::{IdentificationJacobian, Pose, axes, cross, dot, rotate};
use crate::scalar::Scalar;

/// The tool point of an arm at one pose, and what it needs to be derived by any
/// [`Parameter`].
#[derive(Debug, Clone)]
pub struct Linearised<'a, T, const N: usize> {
    arm: &'a Arm<'a, T, N>,
    inputs: TermInputs<T, N>,
    jacobian: IdentificationJacobian<T, N>,
    point: Vector3<T>,
    /// Squared columns below this are what rounding leaves of the difference of two
    /// points on one axis.
    noise: T,
    station: Option<Pose<T>>,
}

impl<T: Scalar, const N: usize> Arm<'_, T, N> {
    /// Where the tool point is at encoder readings `q` (rad or m) in a state of the
    /// arm, with its derivatives, taken where the joints really are.
    #[must_use]
    pub fn linearised(&self, q: &[T; N], state: &State<T, N>) -> Linearised<'_, T, N> {
        let inputs = self.inputs(q, state);
        let deflection = self.deflection_at(&inputs);
        let point = self.real().forward_deflected(q, &deflection).translation;
        let jacobian = self.real().identification_jacobian(&deflection.deflected(q));
        let levers = jacobian.links.iter().map(|link| &link.theta).chain(&jacobian.base_rotation);
        let longest = levers.map(|v| dot(v, v)).fold(T::ZERO, |a, b| if b > a { b } else { a });
        let share = T::EPSILON * T::from_f32(64.0);
        Linearised {
            arm: self,
            inputs,
            jacobian,
            point,
            noise: share * share * longest,
            station: None,
        }
    }
}

impl<T: Scalar, const N: usize> Linearised<'_, T, N> {
    /// The same seen by a tracker; the pose is that of the commanded frame in the
    /// tracker's.
    #[must_use]
    pub fn seen_from(mut self, station: &Pose<T>) -> Self {
        self.move_to(station);
        self
    }

    /// The same in place: what it holds is not copied.
    pub(crate) fn move_to(&mut self, station: &Pose<T>) {
        self.station = Some(*station);
    }

    /// The tool point, m, in the commanded frame or the tracker's.
    #[must_use]
    pub fn point(&self) -> Vector3<T> {
        match &self.station {
            Some(station) => station.transform_point(&self.point),
            None => self.point,
        }
    }

    /// Derivative of [`Self::point`] to a parameter, m per unit of it. Zero for a
    /// parameter that neither arm nor tracker has, and for a rotation about an axis on which
    /// the tool point lies to 64 `EPSILON` of the longest lever.
    #[must_use]
    pub fn column(&self, parameter: Parameter) -> Vector3<T> {
        let (jacobian, links) = (&self.jacobian, self.arm.real().links());
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let of_arm = match parameter.canonical(links) {
            Parameter::BaseRotation(axis) => axis.of(jacobian.base_rotation),
            Parameter::BaseTranslation(axis) => axis.of(jacobian.base_translation),
            Parameter::Tool(axis) => axis.of(jacobian.tool),
            Parameter::Link { joint, parameter } => {
                let link = jacobian.links.get(usize::from(joint));
                link.map_or(none, |link| *link.get(parameter))
            }
            Parameter::Term(term) => {
                let term = self.arm.terms().get(usize::from(term));
                term.map_or(none, |term| {
                    term.column(&self.inputs, links, &jacobian.links, &self.own_rotation())
                })
            }
            Parameter::StationRotation(axis) => {
                let centre = self.station.map_or(none, |station| station.translation);
                return cross(&axis.unit(), &(self.point() - centre));
            }
            Parameter::StationTranslation(axis) => return axis.unit(),
            _ => none,
        };
        if dot(&of_arm, &of_arm) < self.noise && !matches!(parameter, Parameter::Term(_)) {
            return none;
        }
        match &self.station {
            Some(station) => rotate(&station.rotation, &of_arm),
            None => of_arm,
        }
    }

    /// To rotations about the base's own axes.
    fn own_rotation(&self) -> [Vector3<T>; 3] {
        let base = self.arm.real().base();
        let lever = self.jacobian.point - base.translation;
        axes(&base.rotation).map(|axis| cross(&axis, &lever))
    }
}
