//! What of an arm can be identified: one vocabulary for re-identification,
//! streaming identification, the drift watch, covariances and terms.
//!
//! ```
//! use truearm::parameters::{Axis, Parameter};
//! use truearm::LinkParameter;
//!
//! let offset = Parameter::JointOffset(1);
//! let length = Parameter::Link { joint: 2, parameter: LinkParameter::A };
//! // Joints are counted from 0 in the code and from 1 in a text.
//! assert_eq!(offset.to_string(), "joint offset of joint 2");
//! assert_eq!(length.to_string(), "link length a of joint 3");
//! assert_eq!(Parameter::Tool(Axis::Z).to_string(), "tool point, z");
//! ```

mod apply;
mod axis;
mod certainty;
mod linearised;

use core::fmt;

use nalgebra::Vector3;

pub use apply::apply;
pub use axis::Axis;
pub(crate) use certainty::Certainty;
pub use linearised::Linearised;

use crate::arm::ArmParameters;
use crate::kinematics::{JointKind, Link, LinkParameter};
use crate::scalar::Scalar;

/// The prior standard deviation of what an accident moves: a joint offset, the
/// tool, the base; rad or m.
pub(crate) const USUAL_SCALE: f64 = 0.02;

/// A parameter of an arm, or of where what measured it stands. Joints and terms are
/// counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Parameter {
    /// Rotation of the robot's base about an axis of the commanded frame, through
    /// the base's origin: rad.
    BaseRotation(Axis),
    /// Translation of the base along an axis of the commanded frame: m.
    BaseTranslation(Axis),
    /// A coordinate of the tool point in the flange frame: m.
    Tool(Axis),
    /// The zero of a joint's encoder: theta of a revolute joint, rad; d of a
    /// prismatic one, m.
    JointOffset(u8),
    /// A parameter of a link: twist, length, joint angle, link offset, Hayati's
    /// beta; rad or m.
    Link {
        /// The joint behind it.
        joint: u8,
        /// Which of its five.
        parameter: LinkParameter,
    },
    /// The coefficient of a term, by its place in the arm's list, in the unit of
    /// its effect.
    Term(u8),
    /// Where the tracker stands: rotation of the commanded frame about an axis of
    /// the tracker's frame, rad. Of the measurement, not of the arm: fitted and
    /// never stored.
    StationRotation(Axis),
    /// The same: translation of the commanded frame, m.
    StationTranslation(Axis),
    /// Where a plane of unknown place lies, see [`Plane`](crate::measurement::Plane):
    /// rotation about an axis of the points' frame, through the plane's point, rad.
    PlaneRotation {
        /// The plane's label.
        plane: u8,
        /// The axis.
        axis: Axis,
    },
    /// The same of a plane of this label: translation along its normal, m.
    PlaneOffset(u8),
    /// Where an anchor of unknown place is, see [`Anchor`](crate::measurement::Anchor):
    /// translation along an axis of the points' frame, m.
    AnchorTranslation {
        /// The anchor's label.
        anchor: u8,
        /// The axis.
        axis: Axis,
    },
}

impl Parameter {
    /// The tool point.
    pub const TOOL: [Self; 3] = [Self::Tool(Axis::X), Self::Tool(Axis::Y), Self::Tool(Axis::Z)];

    /// The base: rotations, then translations.
    pub const BASE: [Self; 6] = [
        Self::BaseRotation(Axis::X),
        Self::BaseRotation(Axis::Y),
        Self::BaseRotation(Axis::Z),
        Self::BaseTranslation(Axis::X),
        Self::BaseTranslation(Axis::Y),
        Self::BaseTranslation(Axis::Z),
    ];

    /// The tracker's place: rotations, then translations.
    pub const STATION: [Self; 6] = [
        Self::StationRotation(Axis::X),
        Self::StationRotation(Axis::Y),
        Self::StationRotation(Axis::Z),
        Self::StationTranslation(Axis::X),
        Self::StationTranslation(Axis::Y),
        Self::StationTranslation(Axis::Z),
    ];

    /// The place of the plane of this label: rotations about the two axes that its normal
    /// is not nearest to, and its offset. A rotation about the normal moves no plane.
    ///
    /// ```
    /// use truearm::parameters::{Axis, Parameter};
    ///
    /// let [_, _, offset] = Parameter::plane(0, Axis::Z);
    /// assert_eq!(offset, Parameter::PlaneOffset(0));
    /// ```
    #[must_use]
    pub const fn plane(plane: u8, normal: Axis) -> [Self; 3] {
        let [first, second] = match normal {
            Axis::X => [Axis::Y, Axis::Z],
            Axis::Y => [Axis::Z, Axis::X],
            Axis::Z => [Axis::X, Axis::Y],
        };
        [
            Self::PlaneRotation { plane, axis: first },
            Self::PlaneRotation { plane, axis: second },
            Self::PlaneOffset(plane),
        ]
    }

    /// The place of the anchor of this label.
    #[must_use]
    pub const fn anchor(anchor: u8) -> [Self; 3] {
        [
            Self::AnchorTranslation { anchor, axis: Axis::X },
            Self::AnchorTranslation { anchor, axis: Axis::Y },
            Self::AnchorTranslation { anchor, axis: Axis::Z },
        ]
    }

    /// All parameters of an arm of so many joints and terms in the order of a
    /// covariance: base translation, base rotation, tool point, links, terms.
    pub fn of_arm(joints: u8, terms: u8) -> impl Iterator<Item = Self> {
        let base = Axis::ALL.map(Self::BaseTranslation).into_iter();
        let frames = base.chain(Axis::ALL.map(Self::BaseRotation)).chain(Self::TOOL);
        let links = (0..joints)
            .flat_map(|joint| LinkParameter::ALL.map(|parameter| Self::Link { joint, parameter }));
        frames.chain(links).chain((0..terms).map(Self::Term))
    }

    /// Whether it is of the tracker and not of the arm.
    #[must_use]
    pub const fn is_station(self) -> bool {
        matches!(self, Self::StationRotation(_) | Self::StationTranslation(_))
    }

    /// Whether it is of the arm, to be stored, and not of where a tracker, a plane or an
    /// anchor stands.
    #[must_use]
    pub const fn is_of_arm(self) -> bool {
        use Parameter::{AnchorTranslation, PlaneOffset, PlaneRotation};
        let of_place =
            matches!(self, PlaneRotation { .. } | PlaneOffset(_) | AnchorTranslation { .. });
        !(of_place || self.is_station())
    }

    /// Whether this arm has it. The other functions leave an arm alone that does
    /// not: its column is zero, its scale is zero, applying it does nothing.
    #[must_use]
    pub fn exists_in<T: Scalar, const N: usize>(self, arm: &ArmParameters<'_, T, N>) -> bool {
        match self {
            Self::JointOffset(joint) | Self::Link { joint, .. } => usize::from(joint) < N,
            Self::Term(term) => usize::from(term) < arm.terms.len(),
            _ => true,
        }
    }

    /// The same parameter under its one name: a joint offset by that of its link,
    /// so that two of a list can be compared.
    #[must_use]
    pub fn canonical<T: Scalar, const N: usize>(self, links: &[Link<T>; N]) -> Self {
        let Self::JointOffset(joint) = self else { return self };
        let kind = links.get(usize::from(joint)).map_or(JointKind::Revolute, |link| link.kind);
        Self::Link { joint, parameter: offset_of(kind) }
    }

    /// How far it may have moved, 1 sigma, unless the user knows better; the prior
    /// of an identification:
    ///
    /// | parameter | scale |
    /// |---|---|
    /// | joint offset, tool, base | 20 mrad, 20 mm |
    /// | the rest of a link | 1 mrad, 1 mm |
    /// | coefficient of a term | [`Effect::usual`](crate::effects::Effect::usual): 0.2 mrad/(N m) of a spring, 1 mrad of a gap |
    /// | tracker, plane, anchor | infinite: no prior |
    #[must_use]
    pub fn usual_scale<T: Scalar, const N: usize>(self, arm: &ArmParameters<'_, T, N>) -> T {
        if !self.exists_in(arm) {
            return T::ZERO;
        }
        let kind = |joint: u8| arm.nominal.get(usize::from(joint)).map(|link| link.kind);
        match self {
            Self::Link { joint, parameter } if kind(joint).map(offset_of) != Some(parameter) => {
                T::from_f64(0.001)
            }
            Self::Term(term) => arm
                .terms
                .get(usize::from(term))
                .map_or(T::ZERO, |term| T::from_f32(term.effect.usual())),
            _ if !self.is_of_arm() => T::ONE / T::ZERO,
            _ => T::from_f64(USUAL_SCALE),
        }
    }

    /// Its unit: `rad`, `m` or that of a term's effect; empty where the arm does not
    /// have it.
    #[must_use]
    pub fn unit<T: Scalar, const N: usize>(self, arm: &ArmParameters<'_, T, N>) -> &'static str {
        if !self.exists_in(arm) {
            return "";
        }
        match self.canonical(&arm.nominal) {
            Self::BaseRotation(_) | Self::StationRotation(_) | Self::PlaneRotation { .. } => "rad",
            Self::Link { parameter, .. } if !parameter.is_length() => "rad",
            Self::Term(term) => {
                let kinds = arm.nominal.map(|link| link.kind);
                arm.terms.get(usize::from(term)).map_or("", |term| term.unit(&kinds))
            }
            _ => "m",
        }
    }

    /// Changes it by `step`, in its unit. Nothing happens for the place of a tracker, a
    /// plane or an anchor, which is not the arm's. Several rotations of the base at once: [`apply`].
    pub fn apply<T: Scalar, const N: usize>(self, arm: &mut ArmParameters<'_, T, N>, step: T) {
        apply(arm, &[self], &[step]);
    }

    /// Derivative of the tool point to it, m per unit, see [`Linearised::column`].
    #[must_use]
    pub fn column<T: Scalar, const N: usize>(self, at: &Linearised<'_, T, N>) -> Vector3<T> {
        at.column(self)
    }
}

/// The first of a list that the arm does not have or that repeats an earlier one.
pub(crate) fn first_bad<T: Scalar, const N: usize, const P: usize>(
    parameters: &[Parameter; P],
    arm: &ArmParameters<'_, T, N>,
) -> Option<(usize, Parameter)> {
    parameters.iter().copied().enumerate().find(|(index, parameter)| {
        let same =
            |other: &Parameter| other.canonical(&arm.nominal) == parameter.canonical(&arm.nominal);
        !parameter.exists_in(arm) || parameters.iter().take(*index).any(same)
    })
}

/// The first whose scale is none: not positive, or finite for the place of a tracker,
/// which has no prior.
pub(crate) fn first_bad_scale<T: Scalar, const P: usize>(
    parameters: &[Parameter; P],
    scale: &[T; P],
) -> Option<(usize, Parameter)> {
    let mut all = parameters.iter().copied().zip(scale).enumerate();
    let (index, (parameter, _)) = all.find(|(_, (parameter, scale))| {
        let positive = **scale > T::ZERO;
        !positive || (parameter.is_station() && scale.is_finite())
    })?;
    Some((index, parameter))
}

/// Which of a link's parameters the zero of the joint's encoder is.
const fn offset_of(kind: JointKind) -> LinkParameter {
    match kind {
        JointKind::Revolute => LinkParameter::Theta,
        JointKind::Prismatic => LinkParameter::D,
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = |axis: Axis| axis.of(["x", "y", "z"]);
        let number = |index: u8| u16::from(index) + 1;
        match *self {
            Self::BaseRotation(a) => write!(f, "base rotation about {}", axis(a)),
            Self::BaseTranslation(a) => write!(f, "base translation along {}", axis(a)),
            Self::Tool(a) => write!(f, "tool point, {}", axis(a)),
            Self::JointOffset(joint) => write!(f, "joint offset of joint {}", number(joint)),
            Self::Link { joint, parameter } => {
                let name = match parameter {
                    LinkParameter::Alpha => "link twist alpha",
                    LinkParameter::A => "link length a",
                    LinkParameter::Theta => "joint angle theta",
                    LinkParameter::D => "link offset d",
                    LinkParameter::Beta => "Hayati's beta",
                };
                write!(f, "{name} of joint {}", number(joint))
            }
            Self::Term(term) => write!(f, "coefficient of term {}", number(term)),
            Self::StationRotation(a) => write!(f, "tracker's rotation about {}", axis(a)),
            Self::StationTranslation(a) => write!(f, "tracker's translation along {}", axis(a)),
            Self::PlaneRotation { plane, axis: a } => {
                write!(f, "rotation of plane {} about {}", number(plane), axis(a))
            }
            Self::PlaneOffset(plane) => write!(f, "offset of plane {}", number(plane)),
            Self::AnchorTranslation { anchor, axis: a } => {
                write!(f, "translation of anchor {} along {}", number(anchor), axis(a))
            }
        }
    }
}
