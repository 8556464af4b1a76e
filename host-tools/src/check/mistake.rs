//! What can be wrong between a robot file and its measurements, and what each
//! mistake would have done to them.

use std::f64::consts::FRAC_PI_2;

use truearm::LinkParameter;

use crate::units::DEGREES;

/// One mistake, as what undoes it. Joints are counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Mistake {
    /// The joints of a row stand in the row before (-1) or after (+1).
    Step(isize),
    /// The columns of turning joints hold another unit: this many degrees.
    JointUnit(AngleUnit),
    /// The columns of sliding joints hold another unit.
    SlideUnit(LengthUnit),
    /// The columns of the points hold another unit.
    PointUnit(LengthUnit),
    /// Two axes of the tracker are swapped, or one has the wrong sign; which
    /// one the base absorbs.
    Hand,
    /// The values of joint `i` stand in column `order[i]`.
    Order(Vec<usize>),
    /// A joint counts the other way.
    Sense(usize),
    /// The table is standard DH, or one that was shifted as if it were.
    Convention(Convention),
    /// The lengths of the robot file are in another unit.
    RobotUnit(LengthUnit),
    /// The angles of the robot file are in radians.
    RobotAngles,
    /// One number of the robot file.
    Value(usize, LinkParameter, New),
}

/// Units of angles that files hold by mistake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AngleUnit {
    /// Radians.
    Radian,
    /// Degrees that were taken for radians and made degrees again.
    DegreeTwice,
}

/// Units of lengths that files hold by mistake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LengthUnit {
    /// m
    Metre,
    /// cm
    Centimetre,
    /// inch
    Inch,
    /// Micrometre.
    Micrometre,
}

/// What a table of links really is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Convention {
    /// Standard DH: alpha and a belong to the next row.
    Standard,
    /// Modified DH that was shifted by a row as if it had been standard: alpha
    /// and a belong to the row before. The last of them are lost: alpha, rad,
    /// and a, m, which is fitted.
    Shifted(f64, f64),
}

/// What a number should have been.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum New {
    /// The same with the other sign.
    Negative,
    /// The same times this.
    Times(f64),
    /// The same and this; rad or m.
    Plus(f64),
    /// The same and about this, to be fitted; rad or m.
    About(f64),
}

impl AngleUnit {
    /// One of it in degrees.
    #[must_use]
    pub fn degrees(self) -> f64 {
        match self {
            Self::Radian => 1_f64.to_degrees(),
            Self::DegreeTwice => 1_f64.to_radians(),
        }
    }

    /// As files call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Radian => "rad",
            Self::DegreeTwice => "deg converted twice",
        }
    }
}

impl LengthUnit {
    /// One of it in mm.
    #[must_use]
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Metre => 1e3,
            Self::Centimetre => 10.0,
            Self::Inch => 25.4,
            Self::Micrometre => 1e-3,
        }
    }

    /// As files call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Inch => "inch",
            Self::Micrometre => "um",
        }
    }
}

impl New {
    /// In place of a value.
    #[must_use]
    pub fn of(self, value: f64) -> f64 {
        match self {
            Self::Negative => -value,
            Self::Times(factor) => value * factor,
            Self::Plus(more) | Self::About(more) => value + more,
        }
    }
}

impl Mistake {
    /// Place in the order in which mistakes are undone.
    pub(super) fn rank(&self) -> u8 {
        match self {
            Self::Step(_) => 0,
            Self::JointUnit(_) => 1,
            Self::SlideUnit(_) => 2,
            Self::PointUnit(_) => 3,
            Self::Hand => 4,
            Self::Order(_) => 5,
            Self::Sense(_) => 6,
            Self::Convention(_) => 7,
            Self::RobotUnit(_) => 8,
            Self::RobotAngles => 9,
            Self::Value(..) => 10,
        }
    }

    /// Whether two undo the same thing, so that only one of them can be meant.
    pub(super) fn same_place(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Sense(a), Self::Sense(b)) => a == b,
            (Self::Value(a, p, _), Self::Value(b, q, _)) => a == b && p == q,
            _ => self.rank() == other.rank(),
        }
    }

    /// What it costs in nats to say it: the more of its like there are, the
    /// less likely is each before the data are seen; a number that is fitted
    /// takes the range it may have over the tolerance.
    pub(super) fn price(&self) -> f64 {
        match self {
            Self::Step(_) | Self::Hand | Self::JointUnit(_) | Self::Sense(_) => 4.0,
            Self::SlideUnit(_) | Self::PointUnit(_) => 4.5,
            Self::RobotUnit(_) | Self::RobotAngles => 4.5,
            Self::Convention(_) | Self::Order(_) => 5.0,
            Self::Value(_, LinkParameter::Theta, New::Plus(angle)) if right(*angle) => 4.5,
            Self::Value(_, _, New::Negative | New::Times(_)) => 5.5,
            Self::Value(_, LinkParameter::Alpha, New::Plus(angle)) if right(*angle) => 5.5,
            Self::Value(..) => 9.0,
        }
    }
}

impl Mistake {
    /// A fitted number to 0.1 mm or 0.01 degrees: well below what arms are off
    /// by, which is not for this to find.
    pub(super) fn round(&mut self) {
        let (number, unit) = match self {
            Self::Value(_, p, New::About(by)) if p.is_length() => (by, 1e4),
            Self::Value(_, _, New::About(by)) => (by, 100.0 * DEGREES),
            Self::Convention(Convention::Shifted(_, a)) => (a, 1e4),
            _ => return,
        };
        *number = (*number * unit).round() / unit;
    }
}

/// Whether an angle is a multiple of 90 degrees.
fn right(angle: f64) -> bool {
    let quarters = angle / FRAC_PI_2;
    (quarters - quarters.round()).abs() < 1e-9
}
