//! Structure without a name: what a part of the arm does as a function of
//! something recorded, where no effect of the repertoire does the same. It is in
//! the evidence so that no listed name is forced on it, and it is what a report
//! describes.

use std::sync::Arc;

use nalgebra::{DVector, Vector3};
use rayon::prelude::*;
use truearm::effects::Term;

use super::follows::Follows;
use crate::effects::{Offer, courses, growing};
use crate::identify::{Problem, State};
use crate::model::arm::{Derivatives, RowInputs};
use crate::model::{Course, ModelTerm, Values};
use crate::observations::equations_of;

/// As many ways more to grow with time where the file has a temperature that varies: an arm
/// that grows mostly grows with it, and it hardly differs from time in a session that only
/// warms up. At 1 four of four arms that somebody else let grow shared their name with
/// "grows with time" (thermal-expansion at P 0.76 to 0.90, 1.00 without the times).
const BESIDE_TEMPERATURE: usize = 10;

/// An action of a joint and what it goes with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Nameless {
    /// The axis tilts as its own joint turns, so many times a turn.
    Wobble {
        /// Counted from 0.
        joint: usize,
        /// 1, 2, 3...
        times: usize,
    },
    /// The link behind the joint bends with the square of its load.
    Bend {
        /// Counted from 0.
        joint: usize,
    },
    /// The joint is off by a share of its last move.
    Memory {
        /// Counted from 0.
        joint: usize,
    },
    /// The joint's zero wanders with time.
    Creep {
        /// Counted from 0.
        joint: usize,
        /// How.
        course: Course,
    },
    /// The arm grows with time, which no temperature says: it warms up, or later than
    /// where its temperature is read.
    Growth {
        /// The term of what grows: all links, or that of a joint.
        grown: Term<f64>,
        /// How.
        course: Course,
    },
    /// The joint's zero is another from a row on, in the order of measurement.
    Slip {
        /// Counted from 0.
        joint: usize,
        /// First row after it, counted from 0.
        row: usize,
    },
    /// The target sits elsewhere on the flange from a row on, which no series says.
    Reseated {
        /// First row after it, counted from 0.
        row: usize,
    },
    /// The arm stands elsewhere, or what measures it, from a row on.
    Shifted {
        /// First row after it, counted from 0.
        row: usize,
    },
    /// A part errs as something recorded goes.
    Follows(Follows),
}

/// What a gap does, which most joints have, looks nearly like a memory, which few have.
const RARE: usize = 10;

impl Nameless {
    /// All of an arm's revolute joints that the data can test; how many there
    /// are of each kind is the price of looking.
    #[must_use]
    pub fn all(problem: &Problem, joints: &[usize], wobbles: usize) -> Vec<(Self, usize)> {
        let n = joints.len();
        let mut out = Vec::new();
        for joint in joints.iter().copied() {
            for times in 1..=wobbles {
                out.push((Self::Wobble { joint, times }, n * wobbles));
            }
            if problem.conditions.masses || problem.conditions.torques {
                out.push((Self::Bend { joint }, n));
            }
            out.push((Self::Memory { joint }, RARE * n));
        }
        if problem.conditions.time {
            out.extend(Self::of_time(problem, joints));
        }
        out
    }

    fn of_time(problem: &Problem, joints: &[usize]) -> Vec<(Self, usize)> {
        let tried = courses().count();
        let ways = if problem.conditions.temperature { BESIDE_TEMPERATURE } else { 1 };
        let creep = |joint: &usize| {
            let joint = *joint;
            courses().map(move |course| (Self::Creep { joint, course }, tried * joints.len()))
        };
        let mut out: Vec<_> = joints.iter().flat_map(creep).collect();
        for Offer { terms, tried: price } in growing(&problem.nominal) {
            if let [ModelTerm::Arm(grown)] = terms[..] {
                let price = ways * tried * price as usize;
                out.extend(courses().map(|course| (Self::Growth { grown, course }, price)));
            }
        }
        out
    }

    /// The joint, counted from 0; `None` of what is of no joint.
    #[must_use]
    pub fn joint(&self) -> Option<usize> {
        match self {
            Self::Wobble { joint, .. }
            | Self::Bend { joint }
            | Self::Memory { joint }
            | Self::Creep { joint, .. }
            | Self::Slip { joint, .. } => Some(*joint),
            Self::Growth { grown, .. } => grown.own_joint().map(usize::from),
            Self::Reseated { .. } | Self::Shifted { .. } => None,
            Self::Follows(follows) => follows.part.joint(),
        }
    }

    /// Whether all that was measured before it was otherwise: no course of anything that goes on.
    #[must_use]
    pub fn is_step(&self) -> bool {
        matches!(self, Self::Slip { .. } | Self::Reseated { .. } | Self::Shifted { .. })
    }

    /// Number of the kind.
    #[must_use]
    pub fn kind(&self) -> usize {
        match self {
            Self::Wobble { .. } => 0,
            Self::Bend { .. } => 1,
            Self::Memory { .. } => 2,
            Self::Creep { .. } => 3,
            Self::Slip { .. } => 4,
            Self::Reseated { .. } => 5,
            Self::Shifted { .. } => 6,
            Self::Growth { .. } => 7,
            Self::Follows(follows) => 8 + follows.number(),
        }
    }

    /// Which of several at one place.
    #[must_use]
    pub fn part(&self) -> usize {
        if let Self::Wobble { times, .. } = self { *times } else { 0 }
    }

    /// How many columns.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Wobble { .. } | Self::Bend { .. } => 4,
            Self::Memory { .. } | Self::Creep { .. } | Self::Slip { .. } | Self::Growth { .. } => 1,
            Self::Reseated { .. } => 3,
            Self::Shifted { .. } => 6,
            Self::Follows(follows) => follows.count(),
        }
    }

    /// Columns of one unit have one number: turns, then shifts.
    #[must_use]
    pub fn units(&self) -> Vec<usize> {
        match self {
            Self::Shifted { .. } => vec![0, 0, 0, 1, 1, 1],
            _ => vec![0; self.count()],
        }
    }

    /// What it says.
    #[must_use]
    pub fn words(&self, problem: &Problem) -> String {
        let joint = self.joint().map_or(0, |joint| joint + 1);
        match self {
            Self::Wobble { times, .. } => {
                let times = if *times == 1 { "once".to_owned() } else { format!("{times} times") };
                format!("the axis of joint {joint} tilts {times} a turn")
            }
            Self::Bend { .. } => {
                format!("the link behind joint {joint} bends more than in proportion to its load")
            }
            Self::Memory { .. } => {
                format!("joint {joint} is off by a share of its move from the pose before")
            }
            Self::Creep { .. } => format!("the zero of joint {joint} wanders with time"),
            Self::Growth { .. } => match self.joint() {
                None => "the arm grows with time".to_owned(),
                Some(joint) => format!("the link of joint {} grows with time", joint + 1),
            },
            Self::Slip { row, .. } => {
                format!("the zero of joint {joint} is another from row {} on", row + 1)
            }
            Self::Reseated { row } => {
                format!("the target sits elsewhere on the flange from row {} on", row + 1)
            }
            Self::Shifted { row } => {
                format!("the arm, or what measures it, stands elsewhere from row {} on", row + 1)
            }
            Self::Follows(follows) => follows.words(problem),
        }
    }

    /// How the target of a row moves with each of its coefficients, SI.
    #[must_use]
    pub fn columns(&self, problem: &Problem, index: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let row = &problem.data.rows[index];
        let moved = |joint: usize| *d.links[joint].joint(problem.nominal[joint].kind);
        let after = |first: usize| {
            f64::from(u8::from(problem.data.when(index) >= problem.data.when(first)))
        };
        match *self {
            Self::Wobble { joint, times } => {
                let (sin, cos) = (times as f64 * row.q[joint]).sin_cos();
                let [x, y] = d.tilts(joint);
                vec![x * cos, x * sin, y * cos, y * sin]
            }
            Self::Bend { joint } => {
                let inputs = &problem.conditions.rows[index];
                let turn = row.q[joint] + problem.nominal[joint].parameters.theta;
                bends(inputs, joint, turn, d.tilts(joint)).to_vec()
            }
            Self::Memory { joint } => {
                let q = row.q[joint];
                let before = problem.conditions.before[index];
                let before = before.map_or(q, |i| problem.data.rows[i].q[joint]);
                vec![moved(joint) * (before - q)]
            }
            Self::Slip { joint, row } => vec![moved(joint) * after(row)],
            Self::Reseated { row } => d.tool.iter().map(|way| way * after(row)).collect(),
            Self::Shifted { row } => d.base.iter().map(|way| way * after(row)).collect(),
            Self::Creep { joint, course } => vec![moved(joint) * course.at(row)],
            Self::Follows(follows) => follows.columns(problem, index, d),
            Self::Growth { grown, course } => {
                let warm = RowInputs { warmth: course.at(row), ..RowInputs::default() };
                vec![d.column(&grown, &warm, &row.q, &problem.nominal)]
            }
        }
    }
}

/// With its coefficients, SI.
pub type Held = (Nameless, DVector<f64>);

/// How the target of a row is moved by all of it.
#[must_use]
pub fn moved(held: &[Held], problem: &Problem, index: usize, d: &Derivatives) -> Vector3<f64> {
    let of = |(what, by): &Held| {
        let columns = what.columns(problem, index, d);
        columns.iter().zip(by.iter()).map(|(column, c)| column * *c).sum::<Vector3<f64>>()
    };
    held.iter().map(of).sum()
}

/// The problem without it: what it does to rows at a state is set aside.
#[must_use]
pub fn without<'a>(problem: &Problem<'a>, state: &State, held: &[Held]) -> Problem<'a> {
    if held.is_empty() {
        return problem.clone();
    }
    let at = problem.linearise(state);
    let of_row = |row: usize| {
        // The first row of a pair has no equations.
        if equations_of(&problem.data.rows[row]) == 0 {
            return Values::default();
        }
        let e = at.equations_beside(row, &|i, d| vec![moved(held, problem, i, d)]);
        let last = e.block.ncols() - 1;
        Values::from_fn(e.scale.len(), |c| e.block[(c, last)] * e.scale[c])
    };
    let rows = (0..problem.data.rows.len()).into_par_iter().map(of_row).collect();
    Problem { aside: Arc::new(rows), ..problem.clone() }
}

/// How the target moves when the link behind a joint bends about its x and y: with the
/// square of the torque on the joint, and with that of the moment about the same axis.
/// Without masses the moment is not known, and about which axes the link bends is left
/// open instead. A joint turned so far `tilts` its axis about the x and y before it.
fn bends(
    inputs: &RowInputs,
    joint: usize,
    turn: f64,
    [x, y]: [Vector3<f64>; 2],
) -> [Vector3<f64>; 4] {
    let square = |load: f64| load * load.abs();
    let torque = square(inputs.torque[joint]);
    let (sin, cos) = turn.sin_cos();
    let Some([mx, my]) = inputs.across.get(joint) else {
        return [x * cos, x * sin, y * cos, y * sin].map(|column| column * torque);
    };
    let (x, y) = (x * cos + y * sin, y * cos - x * sin);
    let [mx, my] = [mx * cos + my * sin, my * cos - mx * sin].map(square);
    [x * torque, y * torque, x * mx, y * my]
}
