use crate::kinematics::JointKind;

/// What a controller knows of an effect besides its arithmetic; each effect's
/// file has one. It is taken apart while compiling: an image holds only what it
/// asks for.
pub(super) struct Descriptor {
    /// Its code in a blob, which is its place in the table.
    pub code: u8,
    /// In reports and files.
    pub name: &'static str,
    pub acts_on: ActsOn,
    /// Whether it follows another joint, [`super::Term::source`].
    pub coupled: bool,
    /// What components 0 and 1 are; empty where there is one coefficient only.
    pub components: &'static [&'static str],
    pub order: Order,
    pub load: NeedsLoad,
    /// Whether it needs to know how the joint came to rest.
    pub approach: bool,
    /// Whether it needs the temperature.
    pub warmth: bool,
    /// Whether a joint must turn to have it.
    pub revolute_only: bool,
    pub units: Units,
    /// A coefficient beyond this is no such effect but a wrong model.
    pub plausible: f32,
    /// What a coefficient changes by in the life of an arm.
    pub usual: f32,
}

/// What a term deflects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ActsOn {
    /// The value of its joint, rad or m.
    Joint,
    /// The rotation of the base about its x (component 0) or y axis, rad; such a
    /// term has no joint.
    Base,
    /// The direction of its joint's axis: a rotation about the moment across it, rad.
    Axis,
    /// The lengths a and d of its link, or of all links: relative growth.
    Lengths,
}

/// What [`super::Term::order`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// Unused, 0.
    None,
    /// 1 or 2 cycles per turn of the joint.
    Harmonic,
    /// Cycles per turn of the joint, above 0.
    Cycles,
    /// Friction of the joint, N m or N, above which gravity decides; 0: never.
    Friction,
    /// Time constant, s, with which the arm follows the temperature that is read; 0:
    /// at once. All terms of an arm have the same: it is one temperature that a
    /// [`State`](crate::State) holds.
    TimeConstant,
}

/// Steps of small frictions, N m or N: a small arm's wrist carries a tenth of a newton metre.
pub(crate) const FINE: f64 = 1.0 / 4096.0;
/// Frictions below it have them, as 16 bits hold.
const MOST_FINE: f64 = 65535.5 * FINE;

impl Order {
    /// Whether it is a number of cycles a turn.
    #[must_use]
    pub const fn is_cycles(self) -> bool {
        matches!(self, Self::Harmonic | Self::Cycles)
    }

    /// What one step of a term's number of this size in a blob is: cycles a turn, N m or
    /// N, s.
    #[must_use]
    pub const fn step(self, order: f64) -> f64 {
        match self {
            // 1/64 of a minute: up to 17 hours.
            Self::TimeConstant => 60.0 / 64.0,
            Self::Friction if order < MOST_FINE => FINE,
            _ => 1.0 / 64.0,
        }
    }

    /// Whether a term may have this order, a finite number of 0 or more.
    #[must_use]
    pub(crate) fn takes(self, order: f32) -> bool {
        match self {
            Self::None => order == 0.0,
            Self::Harmonic => order == 1.0 || order == 2.0,
            Self::Cycles => order > 0.0,
            Self::Friction | Self::TimeConstant => true,
        }
    }
}

/// What of gravity a term depends on: torques that the arm's [`super::Masses`] give or a
/// sensor reads, or moments that masses alone tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NeedsLoad {
    /// Nothing.
    Never,
    /// The torque of its joint.
    Torque,
    /// The same, if its [`super::Term::order`], a friction, is above 0.
    WithFriction,
    /// Moments on the base or across an axis, which no sensor reads.
    Moments,
}

/// Units of a coefficient by the kinds of its joint and of its source joint.
#[derive(Clone, Copy)]
pub(super) struct Units([[&'static str; 2]; 2]);

impl Units {
    /// Whatever the joint.
    pub const fn any(unit: &'static str) -> Self {
        Self([[unit; 2]; 2])
    }

    /// Of a joint that turns, and of one that slides.
    pub const fn joint(revolute: &'static str, prismatic: &'static str) -> Self {
        Self([[revolute; 2], [prismatic; 2]])
    }

    /// Of a joint that turns with a source that turns and that slides; then of
    /// one that slides.
    pub const fn joints(units: [[&'static str; 2]; 2]) -> Self {
        Self(units)
    }

    pub const fn of(self, joint: JointKind, source: JointKind) -> &'static str {
        let Self([[rr, rp], [pr, pp]]) = self;
        match (joint, source) {
            (JointKind::Revolute, JointKind::Revolute) => rr,
            (JointKind::Revolute, JointKind::Prismatic) => rp,
            (JointKind::Prismatic, JointKind::Revolute) => pr,
            (JointKind::Prismatic, JointKind::Prismatic) => pp,
        }
    }
}
