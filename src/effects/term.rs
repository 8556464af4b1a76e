use nalgebra::Vector3;

use super::approach::Approach;
use super::inputs::TermInputs;
use crate::kinematics::{Deflection, JointKind, Link, LinkColumns};
use crate::scalar::Scalar;

/// What an arm does beyond rigid geometry. Each variant says what one
/// coefficient of it means; to add an effect, add a variant and its row in
/// [`Effect::NAMES`], [`Term::basis`] and the table of `FORMAT.md`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Effect {
    /// A joint turns under its gravity torque: rad per N m.
    JointCompliance,
    /// The base tilts about its x (component 0) or y (component 1) axis under
    /// the overturning moment: rad per N m.
    BaseCompliance,
    /// An eccentric encoder disc: cos or sin of `order` turns of the joint,
    /// order 1 or 2: rad.
    EncoderEccentricity,
    /// A gear's kinematic error: cos or sin of `order` cycles a turn, a
    /// multiple of the gear ratio: rad.
    GearTransmissionError,
    /// A periodic error of an order that is tied to nothing known: rad.
    JointPeriodicError,
    /// The encoder's scale: rad per rad.
    JointGain,
    /// Joint `joint` turns with joint `source`: rad per rad.
    JointCoupling,
    /// Half the play of a joint, positive: rad. The link lags behind the motion
    /// it came to rest from, unless the gravity torque exceeds the friction and
    /// pulls it to the other side of the gap.
    Backlash,
    /// Lengths grow with temperature, all links' or those of `joint`: per K.
    ThermalExpansion,
}

impl Effect {
    /// Whether a term of it is a cos or sin of some cycles a turn.
    #[must_use]
    pub const fn is_periodic(self) -> bool {
        matches!(
            self,
            Self::EncoderEccentricity | Self::GearTransmissionError | Self::JointPeriodicError
        )
    }

    /// Every effect with its name in reports and files; the place is its code
    /// in a blob.
    pub const NAMES: [(Self, &'static str); 9] = [
        (Self::JointCompliance, "joint-compliance"),
        (Self::BaseCompliance, "base-compliance"),
        (Self::EncoderEccentricity, "encoder-eccentricity"),
        (Self::GearTransmissionError, "gear-transmission-error"),
        (Self::JointPeriodicError, "joint-periodic-error"),
        (Self::JointGain, "joint-gain"),
        (Self::JointCoupling, "joint-coupling"),
        (Self::Backlash, "backlash"),
        (Self::ThermalExpansion, "thermal-expansion"),
    ];

    /// Name in reports and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(e, _)| *e == self).map_or("", |(_, name)| name)
    }

    /// The effect of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(_, n)| *n == name).map(|(e, _)| *e)
    }

    /// Unit of the coefficient for a revolute joint.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::JointCompliance | Self::BaseCompliance => "rad/Nm",
            Self::EncoderEccentricity
            | Self::GearTransmissionError
            | Self::JointPeriodicError
            | Self::Backlash => "rad",
            Self::JointGain | Self::JointCoupling => "rad/rad",
            Self::ThermalExpansion => "1/K",
        }
    }

    /// A coefficient beyond this is no such effect but a wrong model.
    #[must_use]
    pub const fn plausible(self) -> f32 {
        match self {
            Self::JointCompliance | Self::BaseCompliance => 1e-2,
            Self::EncoderEccentricity
            | Self::GearTransmissionError
            | Self::JointPeriodicError
            | Self::Backlash => 5e-2,
            Self::JointGain | Self::JointCoupling => 5e-2,
            Self::ThermalExpansion => 1e-3,
        }
    }
}

/// One term of an arm's model: linear in its coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Term<T> {
    /// Which effect.
    pub effect: Effect,
    /// The joint it acts on, counted from 0; for thermal expansion the link, or
    /// [`Term::ALL`]; unused by base compliance.
    pub joint: u8,
    /// The joint it follows, counted from 0; joint coupling only.
    pub source: u8,
    /// 0 for cos or x, 1 for sin or y; 0 where there is one coefficient only.
    pub component: u8,
    /// Cycles per turn of the joint (periodic effects), or the friction torque
    /// in N m above which gravity decides the side (backlash; 0: never).
    pub order: T,
    /// The identified coefficient, unit of [`Effect::unit`].
    pub coefficient: T,
}

impl<T: Scalar> Term<T> {
    /// `joint` of a thermal expansion of all links.
    pub const ALL: u8 = u8::MAX;

    /// Whether it depends on gravity, so that the arm's [`super::Masses`] are
    /// needed: the two compliances, and a backlash with a friction torque.
    #[must_use]
    pub fn needs_load(&self) -> bool {
        match self.effect {
            Effect::JointCompliance | Effect::BaseCompliance => true,
            Effect::Backlash => self.order > T::ZERO,
            _ => false,
        }
    }

    /// The known function that the coefficient multiplies.
    #[must_use]
    #[inline]
    pub fn basis<const N: usize>(&self, inputs: &TermInputs<T, N>) -> T {
        let joint = usize::from(self.joint);
        let at = |values: &[T; N], joint: u8| values.get(usize::from(joint)).copied();
        let value = match self.effect {
            Effect::JointCompliance => at(&inputs.load.torque, self.joint),
            Effect::BaseCompliance => inputs.load.moment.get(usize::from(self.component)).copied(),
            Effect::EncoderEccentricity
            | Effect::GearTransmissionError
            | Effect::JointPeriodicError => at(&inputs.q, self.joint).map(|q| {
                let (sin, cos) = (q * self.order).sin_cos();
                if self.component == 0 { cos } else { sin }
            }),
            Effect::JointGain => at(&inputs.q, self.joint),
            Effect::JointCoupling => at(&inputs.q, self.source),
            Effect::Backlash => at(&inputs.load.torque, self.joint)
                .zip(inputs.approach.get(joint))
                .map(|(torque, approach)| side_of_gap(self.order, torque, *approach)),
            Effect::ThermalExpansion => Some(inputs.warmth),
        };
        value.unwrap_or(T::ZERO)
    }

    /// Derivative of the tool point to the coefficient, m per unit: the basis
    /// times a geometric column (of the chain at the bent joint values). The
    /// columns of `base_rotation` are to rotations about the base's own axes.
    #[must_use]
    pub fn column<const N: usize>(
        &self,
        basis: T,
        links: &[Link<T>; N],
        columns: &[LinkColumns<T>; N],
        base_rotation: &[Vector3<T>; 3],
    ) -> Vector3<T> {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let joint = usize::from(self.joint);
        let column = match self.effect {
            Effect::BaseCompliance => base_rotation.get(usize::from(self.component)).copied(),
            Effect::ThermalExpansion => {
                let mut sum = none;
                for (i, (link, c)) in links.iter().zip(columns).enumerate() {
                    if self.joint == Self::ALL || i == joint {
                        sum += c.a * link.parameters.a + c.d * link.parameters.d;
                    }
                }
                Some(sum)
            }
            _ => columns.get(joint).zip(links.get(joint)).map(|(c, link)| match link.kind {
                JointKind::Revolute => c.theta,
                JointKind::Prismatic => c.d,
            }),
        };
        column.unwrap_or(none) * basis
    }
}

/// The side of the gap a link lies on: +1, -1, or 0 if unknown. It lags behind
/// the motion it came to rest from, unless gravity exceeds the friction and
/// pulls it over.
#[inline(never)]
pub(super) fn side_of_gap<T: Scalar>(friction: T, torque: T, approach: Approach) -> T {
    if friction > T::ZERO && torque.abs() > friction {
        if torque > T::ZERO { T::ONE } else { -T::ONE }
    } else {
        -approach.sign::<T>()
    }
}

/// What all terms together do to an arm, summed as they come. An [`crate::Arm`]
/// has them folded instead.
#[must_use]
pub fn deflection<T: Scalar, const N: usize>(
    terms: &[Term<T>],
    inputs: &TermInputs<T, N>,
) -> Deflection<T, N> {
    let mut out = Deflection::none();
    for term in terms {
        let amount = term.coefficient * term.basis(inputs);
        let slot = match term.effect {
            Effect::BaseCompliance => out.base.get_mut(usize::from(term.component)),
            Effect::ThermalExpansion if term.joint == Term::<T>::ALL => {
                for growth in &mut out.growth {
                    *growth += amount;
                }
                None
            }
            Effect::ThermalExpansion => out.growth.get_mut(usize::from(term.joint)),
            _ => out.joints.get_mut(usize::from(term.joint)),
        };
        if let Some(slot) = slot {
            *slot += amount;
        }
    }
    out
}
