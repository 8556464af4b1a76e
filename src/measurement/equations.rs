//! The equations of a measurement, a column a parameter, as a triangle takes them.

use super::modelled::Rest;
use super::{Anchor, Measurement, MeasurementError, Reading};
use crate::kinematics::dot;
use crate::parameters::{Linearised, Parameter};
use crate::scalar::Scalar;

/// `sum_k columns[k] x[k] = rhs`: three equations of a point, one of a number.
pub(crate) enum Equations<T, const P: usize> {
    Point([[T; 3]; P], [T; 3]),
    Number([[T; 1]; P], [T; 1]),
}

/// What is being solved for.
pub(crate) struct Unknowns<'a, T, const P: usize> {
    pub parameters: &'a [Parameter; P],
    /// By how much each differs from the stored one where it is linearised: both sides
    /// count from the stored ones.
    pub change: &'a [T; P],
    /// The arm stays as it is: its columns are zero.
    pub arm_held: bool,
    /// Of both sides: 1 / sigma.
    pub weight: T,
}

impl<T: Scalar, const P: usize> Unknowns<'_, T, P> {
    /// The equations of `rest`, measured less modelled, whose model has these columns.
    #[inline(always)]
    fn equations<const M: usize>(
        &self,
        mut rest: [T; M],
        column: impl Fn(Parameter) -> [T; M],
    ) -> ([[T; M]; P], [T; M]) {
        let mut columns = [[T::ZERO; M]; P];
        for ((out, parameter), change) in columns.iter_mut().zip(self.parameters).zip(self.change) {
            if self.arm_held && parameter.is_of_arm() {
                continue;
            }
            let column = column(*parameter);
            for (rest, derivative) in rest.iter_mut().zip(&column) {
                *rest += *derivative * *change;
            }
            *out = column.map(|derivative| derivative * self.weight);
        }
        (columns, rest.map(|rest| rest * self.weight))
    }
}

impl<T: Scalar, const N: usize> Measurement<T, N> {
    /// Its equations about where the arm is linearised, seen from where the measured
    /// points are.
    #[inline(always)]
    pub(crate) fn equations_at<const P: usize>(
        &self,
        at: &Linearised<'_, T, N>,
        unknowns: &Unknowns<'_, T, P>,
    ) -> Result<Equations<T, P>, MeasurementError> {
        let rest = self.reading.rest(&at.point(), unknowns.parameters, unknowns.change);
        let (rest, modelled) = match rest {
            Rest::Point(rest) => {
                let [rest] = rest.data.0;
                let (columns, rhs) =
                    unknowns.equations(rest, |parameter| at.column(parameter).data.0[0]);
                return Ok(Equations::Point(columns, rhs));
            }
            Rest::Number(rest, modelled) => (rest, modelled),
        };
        let near = modelled.value < T::from_f32(Anchor::<T>::NEAREST);
        if near && matches!(self.reading, Reading::Distance { .. }) {
            return Err(MeasurementError::AtAnchor);
        }
        let column = |parameter| match self.reading.has(parameter) {
            true => modelled.derivative(parameter),
            false => dot(&modelled.along, &at.column(parameter)),
        };
        let (columns, rhs) = unknowns.equations([rest], |parameter| [column(parameter)]);
        Ok(Equations::Number(columns, rhs))
    }
}
