//! A rigid arm and what weighs on it. Nothing here comes from the crate.

use nalgebra::Vector3;
use truearm::JointKind;

use crate::Robot;
use crate::oracle::{self, Matrix};

/// Geometry, masses, and where it stands.
#[derive(Debug, Clone)]
pub struct Body {
    pub kinds: Vec<JointKind>,
    /// alpha, a, theta, d, beta of each joint.
    pub links: Vec<[f64; 5]>,
    pub gear_ratios: Vec<f64>,
    /// Mass and its centre in the link's frame.
    pub masses: Vec<(f64, Vector3<f64>)>,
    /// In the base frame.
    pub gravity: Vector3<f64>,
    /// The base in the tracker's frame.
    pub station: Matrix<f64>,
    pub tool: Vector3<f64>,
}

/// A pose at rest and what was going on.
#[derive(Debug, Clone)]
pub struct Moment {
    pub q: Vec<f64>,
    /// Where the joints last stood.
    pub before: Vec<f64>,
    pub directions: Vec<i8>,
    /// s
    pub time: f64,
    /// Degrees Celsius as it is read.
    pub temperature: f64,
    /// Degrees Celsius that the links have.
    pub links: f64,
    /// kg
    pub payload: f64,
    /// Series B.
    pub later: bool,
}

/// How the parts of an arm stand to each other.
#[derive(Clone)]
pub(crate) struct Shape {
    pub links: Vec<[f64; 5]>,
    pub joints: Vec<f64>,
    /// Rotation of the base about its x and y axes.
    pub tilt: [f64; 2],
    /// Rotation of each joint's axis about x and y, and of the link behind it.
    pub nod: Vec<[f64; 2]>,
    pub bend: Vec<[f64; 2]>,
}

pub fn apply(m: &Matrix<f64>, p: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3])
}

fn tilted(m: &Matrix<f64>, [x, y]: [f64; 2]) -> Matrix<f64> {
    if [x, y] == [0.0, 0.0] {
        return *m;
    }
    oracle::product(m, &oracle::product(&oracle::rotation(0, x), &oracle::rotation(1, y)))
}

/// Step of the difference quotients of the energy, rad or m.
const STEP: f64 = 1e-3;
impl Body {
    pub(crate) fn frames(&self, shape: &Shape) -> Vec<Matrix<f64>> {
        let mut m = tilted(&oracle::identity(), shape.tilt);
        let mut out = Vec::with_capacity(self.kinds.len());
        for (i, kind) in self.kinds.iter().enumerate() {
            let [alpha, a, theta, d, beta] = shape.links[i];
            if shape.nod[i] == [0.0, 0.0] {
                m = oracle::product(&m, &oracle::link(*kind, shape.links[i], shape.joints[i]));
            } else {
                m = oracle::product(&m, &oracle::link(*kind, [alpha, a, 0.0, 0.0, 0.0], 0.0));
                m = tilted(&m, shape.nod[i]);
                let turn = [0.0, 0.0, theta, d, beta];
                m = oracle::product(&m, &oracle::link(*kind, turn, shape.joints[i]));
            }
            m = tilted(&m, shape.bend[i]);
            out.push(m);
        }
        out
    }

    /// Potential energy of all that weighs, J.
    fn energy(&self, shape: &Shape, payload: f64) -> f64 {
        let frames = self.frames(shape);
        let links: f64 = frames
            .iter()
            .zip(&self.masses)
            .map(|(m, (mass, com))| -mass * self.gravity.dot(&apply(m, com)))
            .sum();
        links - payload * self.gravity.dot(&apply(&frames[frames.len() - 1], &self.tool))
    }

    /// Load on a degree of freedom: the energy's fall along it.
    pub(crate) fn load(
        &self,
        shape: &Shape,
        payload: f64,
        freedom: impl Fn(&mut Shape) -> &mut f64,
    ) -> f64 {
        let at = |step: f64| {
            let mut moved = shape.clone();
            *freedom(&mut moved) += step;
            self.energy(&moved, payload)
        };
        (at(-STEP) - at(STEP)) / (2.0 * STEP)
    }

    /// Load across the axis of a joint, about the x and y of the frame it turns in.
    pub(crate) fn across(&self, shape: &Shape, payload: f64, joint: usize) -> [f64; 2] {
        [0, 1].map(|axis| self.load(shape, payload, |s| &mut s.nod[joint][axis]))
    }

    /// Gravity torque on a joint of the undeflected arm, N m.
    pub fn torque(&self, moment: &Moment, joint: usize) -> f64 {
        let shape = self.unloaded(moment);
        self.load(&shape, moment.payload, |s| &mut s.joints[joint])
    }

    pub(crate) fn unloaded(&self, moment: &Moment) -> Shape {
        let n = self.kinds.len();
        Shape {
            links: self.links.clone(),
            joints: moment.q.clone(),
            tilt: [0.0; 2],
            nod: vec![[0.0; 2]; n],
            bend: vec![[0.0; 2]; n],
        }
    }
}

/// Whether gravity loads a joint by design. What a vertical axis carries
/// because floor and axes lean a little no robot file can tell, and a spring
/// there would be in the measurements but not in any model.
pub(crate) fn loaded(joint: usize, robot: &Robot, body: &Body, poses: &[Moment]) -> bool {
    known(robot, body, poses, |body, moment| [body.torque(moment, joint), 0.0])
}

/// The same of what its bearing carries.
pub(crate) fn loaded_across(joint: usize, robot: &Robot, body: &Body, poses: &[Moment]) -> bool {
    known(robot, body, poses, |body, moment| {
        body.across(&body.unloaded(moment), moment.payload, joint)
    })
}

/// Whether a load of the arm as it is stated is that of the arm as it is.
fn known(
    robot: &Robot,
    body: &Body,
    poses: &[Moment],
    load: impl Fn(&Body, &Moment) -> [f64; 2],
) -> bool {
    let stated = Body {
        links: robot.joints.iter().map(|j| j.link).collect(),
        masses: robot.masses.clone(),
        gravity: robot.gravity.unwrap_or_default(),
        tool: robot.tool,
        ..body.clone()
    };
    let (mut all, mut unknown) = (0.0, 0.0);
    for moment in poses {
        let (real, stated) = (load(body, moment), load(&stated, moment));
        all += real[0].powi(2) + real[1].powi(2);
        unknown += (real[0] - stated[0]).powi(2) + (real[1] - stated[1]).powi(2);
    }
    unknown < 0.2_f64.powi(2) * all
}
