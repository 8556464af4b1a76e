//! A point that the tool's distance is measured from.

use nalgebra::Vector3;

use super::{Measurement, Modelled, Moved, Reading};
use crate::arm::State;
use crate::kinematics::dot;
use crate::parameters::Parameter;
use crate::scalar::Scalar;

/// A point that stays where it is, m, in the frame of the measured points: the foot of a
/// ballbar, the outlet of a draw wire, the centre of a sphere that is touched.
///
/// ```
/// use truearm::measurement::{Anchor, Reading};
/// use truearm::nalgebra::Vector3;
///
/// let foot = Anchor::new(Vector3::new(-0.5, 0.3, 0.0));
/// let measured = foot.distance([0.1, -1.2, 1.6, -1.2, -1.57, 0.8], 0.3, 20.0);
/// assert_eq!(measured.reading, Reading::Distance { anchor: foot, distance: 0.3 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Anchor<T> {
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    point: Vector3<T>,
    label: Option<u8>,
}

impl<T: Scalar> Anchor<T> {
    /// Nearer than this nothing tells a direction, m.
    pub(super) const NEAREST: f32 = 1e-6;

    /// Of known place.
    #[must_use]
    pub fn new(point: Vector3<T>) -> Self {
        Self { point, label: None }
    }

    /// The same, only near where it is stated to be: its place is unknown, under this
    /// label, by the parameters [`Parameter::anchor`].
    #[must_use]
    pub fn unknown(self, label: u8) -> Self {
        Self { label: Some(label), ..self }
    }

    /// Where it was found: known from now on. `change` is that of `parameters` in a
    /// result; those of other anchors and of the arm do not matter here.
    #[must_use]
    pub fn found(&self, parameters: &[Parameter], change: &[T]) -> Self {
        let moved = Moved::by(parameters, change, |parameter| self.has(parameter));
        Self::new(self.point + moved.shift)
    }

    /// Its place, m.
    #[must_use]
    pub fn point(&self) -> &Vector3<T> {
        &self.point
    }

    /// The label of its place if that is unknown.
    #[must_use]
    pub fn label(&self) -> Option<u8> {
        self.label
    }

    /// At joints `q` the tool point was at this distance, m. Without payload: the
    /// measurement's `state` is there to be changed.
    #[must_use]
    pub fn distance<const N: usize>(
        self,
        q: [T; N],
        distance: T,
        temperature: T,
    ) -> Measurement<T, N> {
        let reading = Reading::Distance { anchor: self, distance };
        Measurement { q, state: State::at(temperature), reading }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.point.iter().all(|v| v.is_finite())
    }

    /// Whether it is a parameter of its place, which is unknown.
    pub(super) fn has(&self, parameter: Parameter) -> bool {
        matches!(parameter, Parameter::AnchorTranslation { anchor, .. } if self.label == Some(anchor))
    }

    /// Distance of a tool point, m. Nearer than [`Self::NEAREST`] the direction means
    /// nothing.
    pub(super) fn modelled(&self, point: &Vector3<T>, moved: &Moved<T>) -> Modelled<T> {
        let lever = point - self.point - moved.shift;
        let value = dot(&lever, &lever).sqrt();
        let turned = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        Modelled { value, along: lever / value, turned }
    }
}
