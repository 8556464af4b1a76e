//! A real arm: its springs in equilibrium with the deflected arm's potential
//! energy. Nothing here comes from the crate.

use nalgebra::{Rotation3, Vector3};
use truearm::JointKind;

use crate::effects::{Defect, Kind};
use crate::oracle::{self, Matrix};

/// A real arm.
#[derive(Debug, Clone)]
pub struct Arm {
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
    pub defects: Vec<Defect>,
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
    /// Degrees Celsius.
    pub temperature: f64,
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

fn apply(m: &Matrix<f64>, p: &Vector3<f64>) -> Vector3<f64> {
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
/// A deflection that moves less than this has settled, rad.
const SETTLED: f64 = 1e-12;

impl Arm {
    /// Where the tracker sees the target, without noise.
    pub fn point(&self, moment: &Moment) -> Vector3<f64> {
        let shape = self.at_rest(moment);
        let mut target = self.tool;
        for defect in &self.defects {
            if let (Kind::ToolRemount { direction }, true) = (&defect.kind, moment.later) {
                target += direction * defect.size;
            }
        }
        let frames = self.frames(&shape);
        let mut seen = apply(&self.station, &apply(&frames[frames.len() - 1], &target));
        for defect in &self.defects {
            if let Kind::MeasurementDrift { shift, turn } = &defect.kind {
                let way = defect.size * moment.time / 3600.0;
                seen = Rotation3::from_scaled_axis(turn * (way / 6.0)) * seen + shift * way;
            }
        }
        seen
    }

    fn frames(&self, shape: &Shape) -> Vec<Matrix<f64>> {
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

    /// Gravity torque on a joint of the undeflected arm, N m.
    pub fn torque(&self, moment: &Moment, joint: usize) -> f64 {
        let shape = self.unloaded(moment);
        self.load(&shape, moment.payload, |s| &mut s.joints[joint])
    }

    fn unloaded(&self, moment: &Moment) -> Shape {
        let n = self.kinds.len();
        Shape {
            links: self.links.clone(),
            joints: moment.q.clone(),
            tilt: [0.0; 2],
            nod: vec![[0.0; 2]; n],
            bend: vec![[0.0; 2]; n],
        }
    }

    /// Everything that does not yield to a load, then equilibrium.
    fn at_rest(&self, moment: &Moment) -> Shape {
        let mut stiff = self.unloaded(moment);
        for defect in &self.defects {
            defect.displace(&mut stiff, self, moment);
        }
        let mut shape = stiff.clone();
        for _ in 0..60 {
            let mut next = stiff.clone();
            for defect in &self.defects {
                defect.yield_to_load(&mut next, &shape, self, moment);
            }
            let moved = |a: &Shape, b: &Shape| {
                let all = |s: &Shape| {
                    let pairs = s.bend.iter().chain([&s.tilt]).flatten().copied();
                    pairs.chain(s.joints.iter().copied()).collect::<Vec<_>>()
                };
                all(a).iter().zip(&all(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            let change = moved(&next, &shape);
            shape = next;
            if change < SETTLED {
                break;
            }
        }
        shape
    }
}
