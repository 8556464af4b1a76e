//! Terms of a model: those of the arm, which go into a blob, and those of the
//! measurement, which never do.

use truearm::JointKind;
use truearm::effects::{Order, Term};

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
        let Self::Arm(term) = self else { return Vec::new() };
        let source = term.effect.is_coupled().then_some(term.source);
        source.into_iter().chain(term.own_joint()).map(|joint| usize::from(joint) + 1).collect()
    }

    /// Order of a periodic effect, cycles a turn.
    #[must_use]
    pub fn order(&self) -> Option<f64> {
        match self {
            Self::Arm(term) => term.effect.order().is_cycles().then_some(term.order),
            _ => None,
        }
    }

    /// Friction, N m or N, above which gravity decides; none where it never does.
    #[must_use]
    pub fn friction(&self) -> Option<f64> {
        match self {
            Self::Arm(term) => friction(term),
            _ => None,
        }
    }

    /// Which of several coefficients it is: cos, sin, x, y...; else empty.
    #[must_use]
    pub fn part(&self) -> &'static str {
        match self {
            Self::Arm(term) => part(term),
            Self::Drift { component, .. } => DRIFT.get(*component).copied().unwrap_or_default(),
            Self::Remount { axis, .. } => XYZ.get(*axis).copied().unwrap_or_default(),
        }
    }

    /// Unit of the coefficient in an arm of joints of these kinds.
    #[must_use]
    pub fn unit(&self, kinds: &[JointKind]) -> &'static str {
        match self {
            Self::Arm(term) => term.unit(kinds),
            Self::Drift { component: 0..3, .. } => "rad/h",
            Self::Drift { .. } => "m/h",
            Self::Remount { .. } => "m",
        }
    }
}

/// Names of the components of a drift.
pub(crate) const DRIFT: [&str; 6] = ["rx", "ry", "rz", "x", "y", "z"];
/// And of a re-seated target.
pub(crate) const XYZ: [&str; 3] = ["x", "y", "z"];

/// The name of a term's component, if its effect has several.
#[must_use]
pub fn part(term: &Term<f64>) -> &'static str {
    term.effect.components().get(usize::from(term.component)).copied().unwrap_or_default()
}

/// Friction of a term's joint, N m or N, above which gravity decides.
#[must_use]
pub fn friction(term: &Term<f64>) -> Option<f64> {
    (term.effect.order() == Order::Friction && term.order > 0.0).then_some(term.order)
}

/// Unit of a friction of a joint.
#[must_use]
pub fn friction_unit(kinds: &[JointKind], joint: u8) -> &'static str {
    match kinds.get(usize::from(joint)) {
        Some(JointKind::Prismatic) => "N",
        _ => "N m",
    }
}
