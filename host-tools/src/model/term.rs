//! Terms of a model: those of the arm, which go into a blob, and those of the
//! measurement, which never do.

use truearm::JointKind;
use truearm::effects::{Order, Term, time_constant};

use super::measurements::Row;

/// What a drift goes with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// What passes.
    pub clock: Clock,
    /// Settles as `1 - exp(-passed / settling)`, in the clock's unit; else it goes on.
    pub settling: Option<f64>,
}

/// What passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// `time_s`, in hours.
    Time,
    /// The number in `order`, in thousands of rows.
    Rows,
}

impl Clock {
    /// How much has passed at a row; 0 where nothing is known of it.
    #[must_use]
    pub fn at(self, row: &Row) -> f64 {
        match self {
            Self::Time => row.time.unwrap_or(0.0) / 3600.0,
            Self::Rows => row.order.unwrap_or(0.0) / 1000.0,
        }
    }

    /// A drift that goes on with it.
    #[must_use]
    pub const fn goes_on(self) -> Course {
        Course { clock: self, settling: None }
    }

    /// One that settles.
    #[must_use]
    pub const fn settles(self, settling: f64) -> Course {
        Course { clock: self, settling: Some(settling) }
    }
}

impl Course {
    /// How far it has come at a row.
    #[must_use]
    pub fn at(&self, row: &Row) -> f64 {
        self.after(self.clock.at(row))
    }

    /// How far it has come when so much has passed.
    #[must_use]
    pub fn after(&self, passed: f64) -> f64 {
        // Long before anything began it grows beyond all bounds.
        let settled = |settling: f64| -(-passed / settling).min(BEFORE).exp_m1();
        self.settling.map_or(passed, settled)
    }
}

/// Settling times before the begin of time up to which a course is told.
const BEFORE: f64 = 20.0;

/// A term with its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelTerm {
    /// Of the arm.
    Arm(Term<f64>),
    /// The tracker drifts: its frame against the robot. Components 0..3 rotate about the x, y, z axes of the station's
    /// frame through the robot base's origin, 3..6 translate along them.
    Drift {
        /// 0..6
        component: usize,
        /// With what.
        course: Course,
        /// rad or m by the unit of the course
        coefficient: f64,
    },
    /// The read-out of a joint lags behind its motion: the joint is ahead of what
    /// was read, on the side that it came to rest moving to.
    Lag {
        /// Counted from 0.
        joint: usize,
        /// rad
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
            Self::Lag { .. } => "readout-lag",
            Self::Remount { .. } => "tool-remount",
        }
    }

    /// The coefficient.
    #[must_use]
    pub fn coefficient(&self) -> f64 {
        match self {
            Self::Arm(term) => term.coefficient,
            Self::Drift { coefficient, .. }
            | Self::Lag { coefficient, .. }
            | Self::Remount { coefficient, .. } => *coefficient,
        }
    }

    /// The same with coefficient zero, as candidates have it.
    #[must_use]
    pub fn at_zero(&self) -> Self {
        let mut out = self.clone();
        *out.coefficient_mut() = 0.0;
        out
    }

    /// The coefficient, to be changed.
    pub fn coefficient_mut(&mut self) -> &mut f64 {
        match self {
            Self::Arm(term) => &mut term.coefficient,
            Self::Drift { coefficient, .. }
            | Self::Lag { coefficient, .. }
            | Self::Remount { coefficient, .. } => coefficient,
        }
    }

    /// Joints it names in reports, counted from 1; coupling is source, target.
    #[must_use]
    pub fn joints(&self) -> Vec<usize> {
        let term = match self {
            Self::Arm(term) => term,
            Self::Lag { joint, .. } => return vec![joint + 1],
            Self::Drift { .. } | Self::Remount { .. } => return Vec::new(),
        };
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

    /// What it goes with, of a drift.
    #[must_use]
    pub fn course(&self) -> Option<Course> {
        if let Self::Drift { course, .. } = self { Some(*course) } else { None }
    }

    /// Friction, N m or N, above which gravity decides; none where it never does.
    #[must_use]
    pub fn friction(&self) -> Option<f64> {
        match self {
            Self::Arm(term) => friction(term),
            _ => None,
        }
    }

    /// Time constant, s, with which the arm follows its temperature; none where it does at
    /// once, and of what does not depend on it.
    #[must_use]
    pub fn time_constant(&self) -> Option<f64> {
        match self {
            Self::Arm(term) => {
                Some(time_constant(std::slice::from_ref(term))).filter(|tau| *tau > 0.0)
            }
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
            Self::Lag { .. } => "",
        }
    }

    /// Unit of the coefficient in an arm of joints of these kinds.
    #[must_use]
    pub fn unit(&self, kinds: &[JointKind]) -> &'static str {
        match self {
            Self::Arm(term) => term.unit(kinds),
            Self::Drift { component, course, .. } => {
                match (course.settling, course.clock, *component < 3) {
                    (Some(_), _, true) => "rad",
                    (Some(_), _, false) => "m",
                    (None, Clock::Time, true) => "rad/h",
                    (None, Clock::Time, false) => "m/h",
                    (None, Clock::Rows, true) => "rad/1000 rows",
                    (None, Clock::Rows, false) => "m/1000 rows",
                }
            }
            Self::Lag { .. } => "rad",
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
