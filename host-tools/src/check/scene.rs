//! What a robot and its measurements would be without some mistakes.

use nalgebra::Vector3;
use truearm::{JointKind, Link, LinkParameter};

use super::mistake::{Convention, Mistake, New};
use super::sample::Sample;
use crate::model::Robot;
use crate::units::{DEGREES, joint_from_file, joint_to_file};

/// A row as a hypothesis has it.
#[derive(Debug, Clone)]
pub(super) struct Sight {
    pub q: Vec<f64>,
    pub point: Vector3<f64>,
    pub station: usize,
    pub marker: usize,
}

/// An arm and its points as a hypothesis has them.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    /// Links, about which corrections are small.
    pub links: Vec<Link<f64>>,
    /// The tool as stated, m.
    pub tool: Vector3<f64>,
    /// Numbers that are to be fitted.
    pub fitted: Vec<(usize, LinkParameter)>,
    /// The points.
    pub sights: Vec<Sight>,
    /// How much longer the points are than the file's numbers.
    pub scale: f64,
}

impl Scene {
    /// What a file and a robot would be without some mistakes.
    pub fn new(
        links: &[Link<f64>],
        tool: Vector3<f64>,
        sample: &Sample,
        changes: &[Mistake],
    ) -> Self {
        let step = |c: &Mistake| if let Mistake::Step(step) = c { *step } else { 0 };
        let step: isize = changes.iter().map(step).sum();
        let sights = sample.rows.iter().map(|row| Sight {
            q: row.q[(1 + step.clamp(-1, 1)) as usize].clone(),
            point: row.point,
            station: row.station,
            marker: row.marker,
        });
        let mut scene = Self {
            links: links.to_vec(),
            tool,
            fitted: Vec::new(),
            sights: sights.collect(),
            scale: 1.0,
        };
        // In the order of the list, whatever order they were found in.
        let mut ordered: Vec<&Mistake> = changes.iter().collect();
        ordered.sort_by_key(|change| change.rank());
        ordered.iter().for_each(|change| scene.undo(change, &sample.kinds));
        scene
    }

    fn undo(&mut self, change: &Mistake, kinds: &[JointKind]) {
        match change {
            Mistake::Step(_) => {}
            Mistake::JointUnit(unit) => {
                self.scale_joints(kinds, JointKind::Revolute, unit.degrees())
            }
            Mistake::SlideUnit(unit) => {
                self.scale_joints(kinds, JointKind::Prismatic, unit.millimetres());
            }
            Mistake::PointUnit(unit) => {
                self.scale *= unit.millimetres();
                self.sights.iter_mut().for_each(|s| s.point *= unit.millimetres());
            }
            Mistake::Hand => self.sights.iter_mut().for_each(|s| s.point.z = -s.point.z),
            Mistake::Order(order) => {
                for sight in &mut self.sights {
                    // What the columns say, whatever joint they are of.
                    let files: Vec<f64> =
                        sight.q.iter().zip(kinds).map(|(q, k)| joint_to_file(*k, *q)).collect();
                    let moved =
                        order.iter().zip(kinds).map(|(c, k)| joint_from_file(*k, files[*c]));
                    sight.q = moved.collect();
                }
            }
            Mistake::Sense(joint) => self.sights.iter_mut().for_each(|s| s.q[*joint] *= -1.0),
            Mistake::Convention(to) => {
                convert(&mut self.links, &mut self.tool, *to);
                if matches!(to, Convention::Shifted(..)) {
                    self.fitted.push((self.links.len() - 1, LinkParameter::A));
                }
            }
            Mistake::RobotUnit(unit) => {
                for link in &mut self.links {
                    link.parameters.a *= unit.millimetres();
                    link.parameters.d *= unit.millimetres();
                }
            }
            Mistake::RobotAngles => {
                for link in &mut self.links {
                    link.parameters.alpha *= DEGREES;
                    link.parameters.theta *= DEGREES;
                }
            }
            Mistake::Value(joint, parameter, new) => {
                let value = value_mut(&mut self.links[*joint], *parameter);
                *value = new.of(*value);
                if matches!(new, New::About(_)) {
                    self.fitted.push((*joint, *parameter));
                }
            }
        }
    }

    fn scale_joints(&mut self, kinds: &[JointKind], of: JointKind, factor: f64) {
        for sight in &mut self.sights {
            let joints = sight.q.iter_mut().zip(kinds).filter(|(_, kind)| **kind == of);
            joints.for_each(|(q, _)| *q *= factor);
        }
    }
}

/// A parameter of a link.
pub(super) fn value_mut(link: &mut Link<f64>, parameter: LinkParameter) -> &mut f64 {
    let p = &mut link.parameters;
    match parameter {
        LinkParameter::Alpha => &mut p.alpha,
        LinkParameter::A => &mut p.a,
        LinkParameter::Theta => &mut p.theta,
        LinkParameter::D => &mut p.d,
        LinkParameter::Beta => &mut p.beta,
    }
}

/// Alpha and a of every row to where they belong. What comes before the first
/// axis the base absorbs, what comes after the last the tool does; of a
/// standard table it is known.
pub(super) fn convert(links: &mut [Link<f64>], tool: &mut Vector3<f64>, to: Convention) {
    let n = links.len();
    let of = |link: &Link<f64>| (link.parameters.alpha, link.parameters.a);
    let pairs: Vec<(f64, f64)> = links.iter().map(of).collect();
    let pair = |i: usize| match to {
        Convention::Standard if i == 0 => (0.0, 0.0),
        Convention::Standard => pairs[i - 1],
        Convention::Shifted(alpha, a) if i + 1 == n => (alpha, a),
        Convention::Shifted(..) => pairs[i + 1],
    };
    for (i, link) in links.iter_mut().enumerate() {
        (link.parameters.alpha, link.parameters.a) = pair(i);
    }
    if to == Convention::Standard {
        let (alpha, a) = pairs[n - 1];
        let (sin, cos) = alpha.sin_cos();
        let turned = Vector3::new(tool.x, cos * tool.y - sin * tool.z, sin * tool.y + cos * tool.z);
        *tool = turned + Vector3::x() * a;
    }
}

/// The arm with the mistakes undone.
pub(super) fn undone(robot: &Robot, changes: &[Mistake]) -> Robot {
    let nothing =
        Sample { kinds: Vec::new(), stations: 0, markers: 0, sigma: 0.0, rows: Vec::new() };
    let scene = Scene::new(&robot.nominal(), robot.tool, &nothing, changes);
    let mut robot = robot.clone();
    robot.joints.iter_mut().zip(scene.links).for_each(|(joint, link)| joint.link = link);
    robot.tool = scene.tool;
    robot
}
