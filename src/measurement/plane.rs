//! A plane that the tool touches.

use nalgebra::Vector3;

use super::{Measurement, Modelled, Moved, PlaneError, Reading};
use crate::arm::State;
use crate::kinematics::{cross, dot};
use crate::parameters::Parameter;
use crate::scalar::Scalar;

/// A plane: a point of it, m, and its normal, in the frame of the measured points. It is
/// touched from the side that the normal points to.
///
/// The height of a tool point `p` above it is `n . (p - o) - c`, with the normal
/// `n = (n0 + w x n0) / |n0 + w x n0|`; `o` and `n0` are as stated. The rotation `w` about
/// `o` and the offset `c` along the normal are zero but for a plane of unknown place.
///
/// ```
/// use truearm::measurement::{Plane, PlaneError};
/// use truearm::nalgebra::Vector3;
///
/// let wall = Plane::new(Vector3::new(1.0, 0.0, 0.0), Vector3::new(-2.0, 0.0, 0.0));
/// assert_eq!(wall.map(|wall| *wall.normal()), Ok(Vector3::new(-1.0, 0.0, 0.0)));
/// let none = Plane::new(Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.0));
/// assert_eq!(none, Err(PlaneError::NoNormal));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plane<T> {
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    point: Vector3<T>,
    /// Of length 1.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    normal: Vector3<T>,
    label: Option<u8>,
}

impl<T: Scalar> Plane<T> {
    /// Of known place: any point of it, m, and its normal, of any length.
    ///
    /// # Errors
    /// [`PlaneError::NotFinite`], [`PlaneError::NoNormal`].
    pub fn new(point: Vector3<T>, normal: Vector3<T>) -> Result<Self, PlaneError> {
        let square = dot(&normal, &normal);
        if !(square.is_finite() && point.iter().all(|v| v.is_finite())) {
            return Err(PlaneError::NotFinite);
        }
        // Well above where a square loses digits.
        if square < T::from_f32(1e-24) {
            return Err(PlaneError::NoNormal);
        }
        Ok(Self { point, normal: normal / square.sqrt(), label: None })
    }

    /// Through three points, m, from whose side they follow each other
    /// counterclockwise: where a plane of unknown place is about, by the tool points that
    /// the stored arm has at its first touches.
    ///
    /// ```
    /// use truearm::measurement::Plane;
    /// use truearm::nalgebra::Vector3;
    ///
    /// let [x, y] = [Vector3::new(1.0, 0.0, 0.2), Vector3::new(0.0, 1.0, 0.2)];
    /// let plane = Plane::through([Vector3::new(0.0, 0.0, 0.2), x, y]);
    /// assert_eq!(plane.map(|plane| *plane.normal()), Ok(Vector3::new(0.0, 0.0, 1.0)));
    /// ```
    ///
    /// # Errors
    /// [`PlaneError::NotFinite`]; [`PlaneError::PointsOnALine`] where one of them is nearer to the
    /// line of the others than a thousandth of the longest side, in whatever order they are.
    pub fn through([a, b, c]: [Vector3<T>; 3]) -> Result<Self, PlaneError> {
        let (along, aside) = (b - a, c - a);
        let normal = cross(&along, &aside);
        let across = c - b;
        let [own, other, third] = [along, aside, across].map(|side| dot(&side, &side));
        let longer = |a: T, b: T| if b > a { b } else { a };
        let longest = longer(longer(own, other), third);
        let sides = longest * longest;
        let square = dot(&normal, &normal);
        let finite = (own + other + third).is_finite() && sides.is_finite();
        if !(finite && a.iter().all(|v| v.is_finite())) {
            return Err(PlaneError::NotFinite);
        }
        // A square of 1e-6 underflows for none but points that are one point.
        if square > T::from_f32(1e-6) * sides {
            Self::new(a, normal / square.sqrt())
        } else {
            Err(PlaneError::PointsOnALine)
        }
    }

    /// The same, only near where it is stated to be: its place is unknown, under this
    /// label, by the parameters [`Parameter::plane`].
    #[must_use]
    pub fn unknown(self, label: u8) -> Self {
        Self { label: Some(label), ..self }
    }

    /// Where it was found: known from now on. `change` is that of `parameters` in a
    /// result; those of other planes and of the arm do not matter here.
    ///
    /// It is as sure as what found it. Where that matters it stays [`Self::unknown`], with
    /// the `sigma` of that result as the scale of its parameters: of intervals of 95 %
    /// after eight touches of a plate that is then held as it was found 83 % are true, with
    /// this prior 94 % (`tests/touches`).
    #[must_use]
    pub fn found(&self, parameters: &[Parameter], change: &[T]) -> Self {
        let moved = Moved::by(parameters, change, |parameter| self.has(parameter));
        let (normal, _) = self.turned_normal(&moved.turn);
        Self { point: self.point + normal * moved.offset, normal, label: None }
    }

    /// A point of it, m.
    #[must_use]
    pub fn point(&self) -> &Vector3<T> {
        &self.point
    }

    /// Its normal, of length 1.
    #[must_use]
    pub fn normal(&self) -> &Vector3<T> {
        &self.normal
    }

    /// The label of its place if that is unknown.
    #[must_use]
    pub fn label(&self) -> Option<u8> {
        self.label
    }

    /// Touched at joints `q` with a ball of this radius, m, whose centre is the tool
    /// point. Without payload: the measurement's `state` is there to be changed.
    #[must_use]
    pub fn touched<const N: usize>(
        self,
        q: [T; N],
        radius: T,
        temperature: T,
    ) -> Measurement<T, N> {
        let reading = Reading::Height { plane: self, height: radius };
        Measurement { q, state: State::at(temperature), reading }
    }

    /// Whether it is a parameter of its place, which is unknown.
    pub(super) fn has(&self, parameter: Parameter) -> bool {
        use Parameter::{PlaneOffset, PlaneRotation};
        matches!(parameter, PlaneRotation { plane, .. } | PlaneOffset(plane) if self.label == Some(plane))
    }

    /// The normal, and the length that it was divided by.
    fn turned_normal(&self, turn: &Vector3<T>) -> (Vector3<T>, T) {
        let longer = self.normal + cross(turn, &self.normal);
        let length = dot(&longer, &longer).sqrt();
        (longer / length, length)
    }

    /// Height of a tool point, m.
    pub(super) fn modelled(&self, point: &Vector3<T>, moved: &Moved<T>) -> Modelled<T> {
        let (along, length) = self.turned_normal(&moved.turn);
        let lever = point - self.point;
        let height = dot(&along, &lever);
        // d/dw of n(w) . lever, by the quotient rule.
        let turned = cross(&self.normal, &(lever - along * height)) / length;
        Modelled { value: height - moved.offset, along, turned }
    }
}
