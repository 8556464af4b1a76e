//! What a row has recorded that a part of the cell may err with.

use std::f64::consts::TAU;

use truearm::JointKind;

use crate::identify::Problem;
use crate::observations::kind;

/// Something recorded of every row; joints are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Covariate {
    /// Of a joint: rad, or m of one that slides.
    Joint(usize),
    /// s
    Time,
    /// The number in `order`, where nobody wrote the time down.
    Order,
    /// Degrees Celsius.
    Temperature,
    /// kg
    Payload,
    /// Of the measured point about the z axis of the frame it was measured in, rad.
    Azimuth,
    /// Of the same above that frame's x-y plane, rad.
    Elevation,
    /// Of the same from that frame's origin, m.
    Distance,
    /// Of the target, along an axis of the arm's base, counted from 0, m.
    Place(usize),
    /// That was measured, to an anchor, m.
    Length,
}

/// Axes of the base.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Rows from which on what they are measured with is looked at.
pub(super) const ENOUGH: usize = 20;

/// Share of the rows that have what is looked at: what others are off by is nothing then.
const MOST: f64 = 0.95;

impl Covariate {
    /// All that nearly every row of the data has.
    #[must_use]
    pub fn recorded(problem: &Problem) -> Vec<Self> {
        let rows = problem.data.rows.len();
        let has = |c: &Self| (0..rows).filter(|row| c.at(problem, *row).is_some()).count();
        // Of other kinds of measurements the instrument is another.
        let enough = |c: &Self| match c {
            Self::Azimuth | Self::Elevation | Self::Distance | Self::Length => has(c) >= ENOUGH,
            _ => has(c) as f64 >= MOST * rows as f64,
        };
        let rest = [
            if enough(&Self::Time) { Self::Time } else { Self::Order },
            Self::Temperature,
            Self::Payload,
            Self::Azimuth,
            Self::Elevation,
            Self::Distance,
            Self::Length,
        ];
        let rest = rest.into_iter().chain((0..AXES.len()).map(Self::Place));
        let joints = (0..problem.nominal.len()).map(Self::Joint);
        joints.chain(rest).filter(enough).collect()
    }

    /// Of a row, within a turn from the begin of its range where it comes round.
    #[must_use]
    pub fn within(self, problem: &Problem, index: usize, [low, _]: [f64; 2]) -> Option<f64> {
        let value = self.at(problem, index)?;
        Some(if self == Self::Azimuth { low + (value - low).rem_euclid(TAU) } else { value })
    }

    /// Of a row.
    #[must_use]
    pub fn at(self, problem: &Problem, index: usize) -> Option<f64> {
        let row = &problem.data.rows[index];
        let point = || kind(row).point(row);
        match self {
            Self::Joint(joint) => row.q.get(joint).copied(),
            Self::Time => row.time,
            Self::Order => row.order,
            Self::Temperature => row.temperature,
            Self::Payload => row.payload,
            Self::Azimuth => point().map(|p| p.y.atan2(p.x)),
            Self::Elevation => point().map(|p| p.z.atan2(p.x.hypot(p.y))),
            Self::Distance => point().map(|p| p.norm()),
            Self::Place(axis) => problem.cell.place(index).map(|p| p[axis]),
            Self::Length => kind(row).distance(row),
        }
    }

    /// Whether it comes round again.
    #[must_use]
    pub fn turns(self, problem: &Problem) -> bool {
        match self {
            Self::Joint(joint) => problem.nominal[joint].kind == JointKind::Revolute,
            Self::Azimuth => true,
            _ => false,
        }
    }

    /// Number of the kind; joints last.
    #[must_use]
    pub fn number(self) -> usize {
        match self {
            Self::Time => 0,
            Self::Temperature => 1,
            Self::Payload => 2,
            Self::Azimuth => 3,
            Self::Elevation => 4,
            Self::Distance => 5,
            Self::Order => 6,
            Self::Length => 7,
            Self::Place(axis) => 8 + axis,
            Self::Joint(joint) => 8 + AXES.len() + joint,
        }
    }

    /// Its joint, counted from 0.
    #[must_use]
    pub fn joint(self) -> Option<usize> {
        if let Self::Joint(joint) = self { Some(joint) } else { None }
    }

    /// As in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Joint(_) => "joint",
            Self::Time => "time",
            Self::Order => "order",
            Self::Temperature => "temperature",
            Self::Payload => "payload",
            Self::Azimuth => "azimuth",
            Self::Elevation => "elevation",
            Self::Distance => "distance",
            Self::Place(axis) => AXES[axis],
            Self::Length => "length",
        }
    }

    /// In a sentence.
    #[must_use]
    pub fn words(self, problem: &Problem) -> String {
        match self {
            Self::Joint(joint) if self.turns(problem) => {
                format!("the angle of joint {}", joint + 1)
            }
            Self::Joint(joint) => format!("the position of joint {}", joint + 1),
            Self::Time => "time".to_owned(),
            Self::Order => "the order of the rows".to_owned(),
            Self::Temperature => "the temperature".to_owned(),
            Self::Payload => "the payload".to_owned(),
            Self::Azimuth => "the azimuth".to_owned(),
            Self::Elevation => "the elevation".to_owned(),
            Self::Distance => "the distance".to_owned(),
            Self::Place(axis) => format!("the place along the base's {}", AXES[axis]),
            Self::Length => "the length".to_owned(),
        }
    }

    /// What its values are multiplied by in a report, and their unit there.
    #[must_use]
    pub fn unit(self, problem: &Problem) -> (f64, &'static str) {
        let degrees = (180.0 / std::f64::consts::PI, "deg");
        match self {
            Self::Joint(_) if self.turns(problem) => degrees,
            Self::Azimuth | Self::Elevation => degrees,
            Self::Joint(_) | Self::Distance | Self::Place(_) | Self::Length => (1e3, "mm"),
            Self::Time => (1.0, "s"),
            Self::Order => (1.0, "rows"),
            Self::Temperature => (1.0, "degC"),
            Self::Payload => (1.0, "kg"),
        }
    }
}
