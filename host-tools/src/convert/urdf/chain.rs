use std::collections::HashMap;

use nalgebra::Vector3;
use truearm::{JointKind, Pose};
use urdf_rs::JointType;

use super::{Document, origin};
use crate::convert::axes::{Axes, Axis};
use crate::error::Result;

/// Which links a chain begins and ends at, as a user says it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ends {
    /// Where it begins; the one link that no joint leads to if not said.
    pub base: Option<String>,
    /// Where it ends; the only end there is if not said.
    pub tip: Option<String>,
}

/// The moving joints between two links, and where they are at joint values zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Serial {
    /// The link that the coordinates are of.
    pub base: String,
    /// The last link.
    pub tip: String,
    /// From base to tip.
    pub joints: Vec<Moving>,
    /// The tip in the base, at joint values zero.
    pub tip_pose: Pose<f64>,
}

/// A joint that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Moving {
    /// Its name.
    pub name: String,
    /// The link behind it.
    pub child: String,
    /// Turns or slides.
    pub kind: JointKind,
    /// Its frame in the base at joint values zero.
    pub frame: Pose<f64>,
    /// The fixed way from the frame of the moving joint before, or the base, to
    /// the joint's parent: what stands before its own origin.
    pub before: Pose<f64>,
    /// Its axis in its own frame, of length one.
    pub axis: Vector3<f64>,
    /// Limits, rad or m.
    pub limits: Option<[f64; 2]>,
}

impl Serial {
    /// The axes and the tip.
    #[must_use]
    pub fn axes(&self) -> Axes {
        let joints = self.joints.iter().map(|joint| Axis {
            kind: joint.kind,
            point: joint.frame.translation,
            direction: joint.frame.rotation * joint.axis,
        });
        Axes { joints: joints.collect(), tip: self.tip_pose }
    }

    /// The tip at joint values `q`, by the joints of the URDF themselves.
    #[must_use]
    pub fn pose(&self, q: &[f64]) -> Pose<f64> {
        let mut moved = Pose::identity();
        for (joint, q) in self.joints.iter().zip(q) {
            let along = match joint.kind {
                JointKind::Revolute => {
                    Pose::from_rotation_vector(Vector3::zeros(), joint.axis * *q)
                }
                JointKind::Prismatic => Pose { translation: joint.axis * *q, ..Pose::identity() },
            };
            let about = joint.frame.compose(&along).compose(&joint.frame.inverse());
            moved = moved.compose(&about);
        }
        moved.compose(&self.tip_pose)
    }

    /// The chain of a URDF between two links.
    ///
    /// # Errors
    /// Links that are not there, several chains where none was chosen, joints
    /// that are neither revolute nor prismatic, and limits that are none.
    pub fn of(document: &Document, ends: &Ends) -> Result<Self> {
        let tree = Tree::new(document)?;
        let base = tree.base(ends.base.as_deref())?;
        let tip = tree.tip(&base, ends.tip.as_deref())?;
        let mut chain = Self { base, tip, joints: Vec::new(), tip_pose: Pose::identity() };
        let mut before = Pose::identity();
        for joint in tree.path(&chain.base, &chain.tip)? {
            let frame = chain.tip_pose.compose(&origin(&joint.origin));
            match kind(document, joint)? {
                Some(kind) => {
                    chain.joints.push(Moving {
                        name: joint.name.clone(),
                        child: joint.child.link.clone(),
                        kind,
                        frame,
                        before,
                        axis: axis(document, joint)?,
                        limits: limits(document, joint)?,
                    });
                    before = Pose::identity();
                }
                None => before = before.compose(&origin(&joint.origin)),
            }
            chain.tip_pose = frame;
        }
        let most = truearm::MAX_JOINTS;
        match chain.joints.len() {
            0 => Err(document.whole(
                format!("no joint moves between \"{}\" and \"{}\"", chain.base, chain.tip),
                "give other links as --base-link and --tip-link",
            )),
            n if n > most => Err(document.whole(
                format!("{n} joints move between \"{}\" and \"{}\"", chain.base, chain.tip),
                format!("truearm handles up to {most}; give links nearer to each other"),
            )),
            _ => Ok(chain),
        }
    }
}

/// What moves; `None` where nothing does.
fn kind(document: &Document, joint: &urdf_rs::Joint) -> Result<Option<JointKind>> {
    let fail = |message: &str, help: &str| Err(document.at("joint", &joint.name, message, help));
    let help = "truearm takes chains of revolute, continuous, prismatic and fixed joints; leave it \
                out with --base-link and --tip-link";
    if let (Some(mimic), false) = (&joint.mimic, joint.joint_type == JointType::Fixed) {
        let message = format!("mimics \"{}\": it has no value of its own", mimic.joint);
        return fail(&message, help);
    }
    match joint.joint_type {
        JointType::Fixed => Ok(None),
        JointType::Revolute | JointType::Continuous => Ok(Some(JointKind::Revolute)),
        JointType::Prismatic => Ok(Some(JointKind::Prismatic)),
        JointType::Floating => fail("is floating: it has six values, not one", help),
        JointType::Planar => fail("is planar: it has three values, not one", help),
        JointType::Spherical => fail("is spherical: it has three values, not one", help),
    }
}

fn axis(document: &Document, joint: &urdf_rs::Joint) -> Result<Vector3<f64>> {
    let axis = Vector3::from(*joint.axis.xyz);
    axis.try_normalize(1e-6).ok_or_else(|| {
        let help = "give the direction of the axis, such as 0 0 1";
        document.at("joint", &joint.name, "has an axis without direction", help)
    })
}

fn limits(document: &Document, joint: &urdf_rs::Joint) -> Result<Option<[f64; 2]>> {
    let [low, high] = [joint.limit.lower, joint.limit.upper];
    let fail = |message: &str, help: &str| Err(document.at("joint", &joint.name, message, help));
    if joint.joint_type == JointType::Continuous || (low == high && low == 0.0) {
        return Ok(None);
    }
    if low.is_nan() || high.is_nan() {
        return fail("has a limit that is no number", "give lower and upper in rad or m");
    }
    if low > high {
        return fail(&format!("has limits from {low} to {high}"), "give the lower limit first");
    }
    Ok((low.is_finite() && high.is_finite()).then_some([low, high]))
}

/// The links and what leads to each.
struct Tree<'a> {
    document: &'a Document,
    /// The joint that leads to a link.
    above: HashMap<&'a str, &'a urdf_rs::Joint>,
}

impl<'a> Tree<'a> {
    fn new(document: &'a Document) -> Result<Self> {
        let mut above = HashMap::new();
        for joint in &document.robot.joints {
            if let Some(other) = above.insert(joint.child.link.as_str(), joint) {
                let message = format!(
                    "and joint \"{}\" both lead to link \"{}\"",
                    other.name, joint.child.link
                );
                let help = "a closed chain has no parameters of its own; cut it in the file";
                return Err(document.at("joint", &joint.name, &message, help));
            }
        }
        Ok(Self { document, above })
    }

    fn names(&self) -> impl Iterator<Item = &'a str> {
        self.document.robot.links.iter().map(|link| link.name.as_str())
    }

    fn known(&self, option: &str, name: &str) -> Result<String> {
        if self.names().any(|n| n == name) {
            return Ok(name.to_owned());
        }
        let message = format!("no link \"{name}\", given as {option}");
        Err(self.document.whole(message, format!("its links are {}", list(self.names()))))
    }

    fn base(&self, asked: Option<&str>) -> Result<String> {
        if let Some(name) = asked {
            return self.known("--base-link", name);
        }
        let roots: Vec<&str> = self.names().filter(|n| !self.above.contains_key(n)).collect();
        match roots.as_slice() {
            [root] => Ok((*root).to_owned()),
            [] => Err(self
                .document
                .whole("every link hangs on another", "it is a ring; cut it in the file")),
            many => Err(self.document.whole(
                format!("{} links hang on nothing: {}", many.len(), list(many.iter().copied())),
                "say which it is: --base-link LINK",
            )),
        }
    }

    /// The joints from a link down to another, in this order.
    fn path(&self, base: &str, tip: &str) -> Result<Vec<&'a urdf_rs::Joint>> {
        let mut path = Vec::new();
        let mut at = tip;
        while at != base {
            match self.above.get(at) {
                Some(joint) if path.len() < self.document.robot.joints.len() => {
                    path.push(*joint);
                    at = &joint.parent.link;
                }
                _ => {
                    let message = format!("link \"{tip}\" does not hang on \"{base}\"");
                    return Err(self
                        .document
                        .whole(message, "give other links as --base-link and --tip-link"));
                }
            }
        }
        path.reverse();
        Ok(path)
    }

    /// The one end behind all joints that move.
    fn tip(&self, base: &str, asked: Option<&str>) -> Result<String> {
        if let Some(name) = asked {
            return self.known("--tip-link", name);
        }
        let parents: Vec<&str> =
            self.document.robot.joints.iter().map(|j| j.parent.link.as_str()).collect();
        let ends = self.names().filter(|name| !parents.contains(name));
        let moving = |path: Vec<&'a urdf_rs::Joint>| -> Vec<&'a str> {
            let moves = path.into_iter().filter(|j| j.joint_type != JointType::Fixed);
            moves.map(|j| j.name.as_str()).collect()
        };
        let ends: Vec<(&str, Vec<&str>)> =
            ends.filter_map(|end| Some((end, moving(self.path(base, end).ok()?)))).collect();
        let most = ends.iter().max_by_key(|(_, joints)| joints.len());
        let longest = most.map(|(_, joints)| joints.clone()).unwrap_or_default();
        let apart = ends.iter().any(|(_, joints)| !longest.starts_with(joints));
        let last: Vec<&str> =
            ends.iter().filter(|(_, joints)| *joints == longest).map(|(end, _)| *end).collect();
        match (apart, last.as_slice()) {
            (false, [tip]) => Ok((*tip).to_owned()),
            (false, []) => Err(self.document.whole("no end of a chain", "give --tip-link LINK")),
            (false, many) => Err(self.document.whole(
                format!("{} links end the chain: {}", many.len(), list(many.iter().copied())),
                "say where the measured point's frame is: --tip-link LINK",
            )),
            (true, _) => {
                let said =
                    ends.iter().map(|(end, joints)| format!("{end} ({} joints)", joints.len()));
                Err(self.document.whole(
                    format!("several chains, which end at {}", said.collect::<Vec<_>>().join(", ")),
                    "say which: --tip-link LINK, any link on the way to these ends",
                ))
            }
        }
    }
}

/// The first names of many.
fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    let shown = names.iter().take(12).copied().collect::<Vec<_>>().join(", ");
    if names.len() > 12 { format!("{shown} and {} more", names.len() - 12) } else { shown }
}
