//! The arm of a cell: springs and gears of the simulator behind a robot file.

use nalgebra::Vector3;
use rand::Rng;
use truearm::{MdhParameters, Pose};
use truearm_host::identify::State;
use truearm_host::model::Robot;
use truearm_simulate::arm::Arm as Simulated;
use truearm_simulate::body::Body;
use truearm_simulate::effects::{Defect, DefectKind};
use truearm_simulate::{at_rest, normal, oracle};

/// What a real joint does beyond geometry.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointDefect {
    /// rad per N m
    pub compliance: f64,
    /// Amplitude at twice an input turn, rad; a quarter of it at four times.
    pub gear: f64,
    /// Its phase, rad.
    pub phase: f64,
}

/// A true arm in front of a tracker.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Its nominal description.
    pub robot: Robot,
    /// True links, base in the tracker's frame, and target.
    pub truth: State,
    /// One entry a joint.
    pub defects: Vec<JointDefect>,
}

impl Arm {
    /// Geometric errors of so many manufacturing tolerances (1 mm, 1 mrad) a
    /// parameter, given as a draw of standard normals, five a link.
    #[must_use]
    pub fn new(robot: &Robot, base: Pose<f64>, errors: &[f64], scale: f64) -> Self {
        let mut links = robot.nominal();
        for (link, draw) in links.iter_mut().zip(errors.chunks_exact(5)) {
            let error = core::array::from_fn(|k| draw[k] * 1e-3 * scale);
            *link = link.corrected(&MdhParameters::from_array(error));
        }
        let truth = State {
            bases: vec![base],
            markers: vec![robot.tool],
            instruments: Vec::new(),
            links,
            terms: Vec::new(),
        };
        Self {
            robot: robot.clone(),
            truth,
            defects: vec![JointDefect::default(); robot.joints.len()],
        }
    }

    /// The same arm in the simulator.
    fn simulated(&self) -> Simulated {
        let base = &self.truth.bases[0];
        let mut station = oracle::identity();
        for i in 0..3 {
            (0..3).for_each(|j| station[i][j] = base.rotation[(i, j)]);
            station[i][3] = base.translation[i];
        }
        let defects = self.defects.iter().enumerate().flat_map(|(joint, d)| {
            let spring = Defect { kind: DefectKind::JointCompliance { joint }, size: d.compliance };
            let phases = [d.phase, 0.0];
            let gear =
                Defect { kind: DefectKind::GearTransmissionError { joint, phases }, size: d.gear };
            [spring, gear].into_iter().filter(|defect| defect.size != 0.0)
        });
        let robot = &self.robot;
        Simulated {
            body: Body {
                kinds: robot.joints.iter().map(|j| j.link.kind).collect(),
                links: self.truth.links.iter().map(|l| l.parameters.to_array()).collect(),
                gear_ratios: robot.joints.iter().map(|j| j.gear_ratio.unwrap_or(1.0)).collect(),
                masses: robot.links.iter().map(|l| (l.mass, l.com)).collect(),
                gravity: robot.gravity.unwrap_or_default(),
                station,
                tool: self.truth.markers[0],
            },
            defects: defects.collect(),
        }
    }

    /// Where the tracker sees the target at these joint values, m, `noise` (m)
    /// added.
    #[must_use]
    pub fn seen(&self, poses: &[Vec<f64>], noise: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let arm = self.simulated();
        poses.iter().zip(noise).map(|(q, e)| arm.point(&at_rest(q)) + e).collect()
    }
}

/// Standard normals for a draw of geometric errors.
pub fn draw_errors(joints: usize, rng: &mut impl Rng) -> Vec<f64> {
    (0..5 * joints).map(|_| normal(rng)).collect()
}
