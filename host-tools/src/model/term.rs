//! Terms of a model: those of the arm, which go into a blob, and those of the
//! measurement, which never do.

use truearm::JointKind;
use truearm::effects::{Effect, Term};

/// A term with its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelTerm {
    /// Of the arm.
    Arm(Term<f64>),
    /// The tracker drifts: its frame against the robot, linear in `time_s`.
    /// Components 0..3 rotate about the x, y, z axes of the station's frame
    /// through the robot base's origin (rad/h), 3..6 translate along them (m/h).
    Drift {
        /// 0..6
        component: usize,
        /// rad/h or m/h
        coefficient: f64,
    },
    /// The target was re-seated before this series: its point moved in the
    /// flange frame, relative to the first series.
    Remount {
        /// Label of the series.
        series: String,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// m
        coefficient: f64,
    },
}

impl ModelTerm {
    /// Name of its effect in reports.
    #[must_use]
    pub fn effect_name(&self) -> &'static str {
        match self {
            Self::Arm(term) => term.effect.name(),
            Self::Drift { .. } => "measurement-drift",
            Self::Remount { .. } => "tool-remount",
        }
    }

    /// The coefficient.
    #[must_use]
    pub fn coefficient(&self) -> f64 {
        match self {
            Self::Arm(term) => term.coefficient,
            Self::Drift { coefficient, .. } | Self::Remount { coefficient, .. } => *coefficient,
        }
    }

    /// The coefficient, to be changed.
    pub fn coefficient_mut(&mut self) -> &mut f64 {
        match self {
            Self::Arm(term) => &mut term.coefficient,
            Self::Drift { coefficient, .. } | Self::Remount { coefficient, .. } => coefficient,
        }
    }

    /// Joints it names in reports, counted from 1; coupling is source, target.
    #[must_use]
    pub fn joints(&self) -> Vec<usize> {
        match self {
            Self::Arm(term) => match term.effect {
                Effect::BaseCompliance => Vec::new(),
                Effect::ThermalExpansion if term.joint == Term::<f64>::ALL => Vec::new(),
                Effect::JointCoupling => {
                    vec![usize::from(term.source) + 1, usize::from(term.joint) + 1]
                }
                _ => vec![usize::from(term.joint) + 1],
            },
            Self::Drift { .. } | Self::Remount { .. } => Vec::new(),
        }
    }

    /// Order of a periodic effect, cycles a turn.
    #[must_use]
    pub fn order(&self) -> Option<f64> {
        match self {
            Self::Arm(term) => match term.effect {
                Effect::EncoderEccentricity
                | Effect::GearTransmissionError
                | Effect::JointPeriodicError => Some(term.order),
                _ => None,
            },
            _ => None,
        }
    }

    /// Unit of the coefficient.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Arm(term) => term.effect.unit(),
            Self::Drift { component: 0..3, .. } => "rad/h",
            Self::Drift { .. } => "m/h",
            Self::Remount { .. } => "m",
        }
    }
}

/// Unit of a coefficient for these joints.
#[must_use]
pub fn term_unit(term: &Term<f64>, kinds: &[JointKind]) -> String {
    let linear = |joint: u8| kinds.get(usize::from(joint)) == Some(&JointKind::Prismatic);
    let of = |joint| if linear(joint) { "m" } else { "rad" };
    match term.effect {
        Effect::JointCoupling => format!("{}/{}", of(term.joint), of(term.source)),
        Effect::BaseCompliance | Effect::ThermalExpansion => term.effect.unit().to_owned(),
        Effect::JointCompliance if linear(term.joint) => "m/N".to_owned(),
        effect => effect.unit().replace("rad", of(term.joint)),
    }
}
