//! Changes in words, with what stands in the files and what should.

use truearm::{JointKind, LinkParameter};

use super::mistake::{Convention, Mistake};
use super::sample::Sample;
use super::scene::Scene;
use crate::model::Robot;
use crate::units::{joint_unit, link_unit};

/// A change as reports have it.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Said {
    /// What is wrong: `joint-sense`, `joint-zero`, `joint-order`, `joint-unit`,
    /// `slide-unit`, `point-unit`, `robot-unit`, `robot-angle-unit`, `dh-convention`,
    /// `tracker-handedness`, `row-step`, `alpha`, `a` or `d`.
    pub what: &'static str,
    /// At which joint, counted from 1.
    pub joint: Option<usize>,
    /// What the files say.
    pub from: String,
    /// What they should say.
    pub to: String,
    /// In which rows, counted from 1, where it is not in all: `37 to 60`.
    pub rows: Option<String>,
}

/// Several changes in a sentence.
#[must_use]
pub fn together(changes: &[Said]) -> String {
    changes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", and ")
}

impl std::fmt::Display for Said {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { from, to, .. } = self;
        let joint = self.joint.unwrap_or_default();
        if let Some(rows) = &self.rows {
            write!(f, "in rows {rows}: ")?;
        }
        match self.what {
            "joint-sense" => write!(f, "joint {joint} counts the other way"),
            "joint-zero" => write!(f, "the zero of joint {joint} is off: {from}, should be {to}"),
            "joint-order" => write!(f, "columns q1.. hold the joints in the order {to}"),
            "joint-unit" => write!(f, "the joint angles are in {from}, should be in {to}"),
            "slide-unit" => write!(f, "the sliding joints are in {from}, should be in {to}"),
            "point-unit" => write!(f, "the points are in {from}, should be in {to}"),
            "robot-unit" => write!(f, "the lengths of the robot are in {from}, should be in {to}"),
            "robot-angle-unit" => {
                write!(f, "the angles of the robot are in {from}, should be in {to}")
            }
            "dh-convention" => write!(f, "the table of links is {from}, should be {to}"),
            "tracker-handedness" => {
                write!(
                    f,
                    "the points are left-handed: two axes are swapped or one has the wrong sign"
                )
            }
            "row-step" => write!(f, "joints and points are out of step by one row: {to}"),
            what => write!(f, "{what} of joint {joint} is {from}, should be {to}"),
        }
    }
}

/// Mistakes of a robot and its measurements in words.
pub(super) fn said(robot: &Robot, kinds: &[JointKind], changes: &[Mistake]) -> Vec<Said> {
    let nothing =
        Sample { kinds: kinds.to_vec(), stations: 0, markers: 0, sigma: 0.0, rows: Vec::new() };
    let links =
        |changes: &[Mistake]| Scene::new(&robot.nominal(), robot.tool, &nothing, changes).links;
    let of = |change: &Mistake| match change {
        Mistake::Value(joint, p, _) => {
            let others: Vec<Mistake> = changes.iter().filter(|c| *c != change).cloned().collect();
            let value = |changes: &[Mistake]| {
                let [alpha, a, theta, d, _] = links(changes)[*joint].parameters.to_array();
                let value = match p {
                    LinkParameter::Alpha => alpha,
                    LinkParameter::A => a,
                    LinkParameter::D => d,
                    _ => theta,
                };
                let (unit, size) = link_unit(*p);
                format!("{} {unit}", tidy(value * size))
            };
            let slides = kinds[*joint] == JointKind::Prismatic;
            let what = match p {
                LinkParameter::Theta if !slides => "joint-zero",
                LinkParameter::D if slides => "joint-zero",
                other => other.name(),
            };
            let (from, to) = (value(&others), value(changes));
            Said { what, joint: Some(joint + 1), from, to, rows: None }
        }
        other => of_files(other, kinds),
    };
    changes.iter().map(of).collect()
}

/// Of changes whose words need no number of the robot.
fn of_files(change: &Mistake, kinds: &[JointKind]) -> Said {
    let whole = |what, from: &str, to: &str| Said {
        what,
        joint: None,
        from: from.to_owned(),
        to: to.to_owned(),
        rows: None,
    };
    match change {
        Mistake::Step(step) => {
            let to = if *step < 0 { "before" } else { "after" };
            whole("row-step", "the same row", &format!("the joints stand in the row {to}"))
        }
        Mistake::JointUnit(unit) => whole("joint-unit", unit.name(), "deg"),
        Mistake::SlideUnit(unit) => whole("slide-unit", unit.name(), "mm"),
        Mistake::PointUnit(unit) => whole("point-unit", unit.name(), "mm"),
        Mistake::RobotUnit(unit) => whole("robot-unit", unit.name(), "mm"),
        Mistake::RobotAngles => whole("robot-angle-unit", "rad", "deg"),
        Mistake::Hand => whole("tracker-handedness", "left", "right"),
        Mistake::Order(order) => {
            let list = |of: &mut dyn Iterator<Item = usize>| {
                of.map(|j| (j + 1).to_string()).collect::<Vec<_>>().join(" ")
            };
            // Which joint each column holds: the other way round.
            let column = |c: usize| order.iter().position(|at| *at == c).unwrap_or(c);
            let to = list(&mut (0..order.len()).map(column));
            whole("joint-order", &list(&mut (0..order.len())), &to)
        }
        Mistake::Sense(joint) => {
            let unit = joint_unit(kinds[*joint]);
            Said {
                what: "joint-sense",
                joint: Some(joint + 1),
                from: format!("+q{} {unit}", joint + 1),
                to: format!("-q{} {unit}", joint + 1),
                rows: None,
            }
        }
        Mistake::Convention(Convention::Standard) => {
            whole("dh-convention", "standard DH", "modified DH")
        }
        Mistake::Convention(Convention::Shifted(..)) => {
            whole("dh-convention", "modified DH, shifted by a row", "modified DH")
        }
        Mistake::Value(..) => unreachable!("a number of the robot"),
    }
}

/// A number without the digits that arithmetic left.
pub(super) fn tidy(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}
