//! A simulated arm whose truth is known, for studies: exact kinematics of the
//! true links, springs in equilibrium with the deflected arm, a gear whose
//! waves follow its input. What identification linearises is exact here.

use nalgebra::Vector3;
use rand::{Rng, RngExt};
use truearm::{JointKind, MdhParameters, Pose};

use crate::chain::{ArmMasses, RowInputs, chain};
use crate::error::Result;
use crate::files::{Measurements, Robot};
use crate::identify::State;

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

/// Standard normal (Box-Muller).
pub fn normal(rng: &mut impl Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random_range(0.0..1.0));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Three of them.
pub fn normal_vector(rng: &mut impl Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| normal(rng))
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
        let truth =
            State { bases: vec![base], markers: vec![robot.tool], links, terms: Vec::new() };
        Self {
            robot: robot.clone(),
            truth,
            defects: vec![JointDefect::default(); robot.joints.len()],
        }
    }

    /// Where the joints really are when the encoders read `q`.
    fn settled(&self, q: &[f64]) -> Vec<f64> {
        let mut stiff = q.to_vec();
        for (j, defect) in self.defects.iter().enumerate() {
            let input = self.robot.joints[j].gear_ratio.unwrap_or(1.0) * q[j];
            let wave = (2.0 * input + defect.phase).sin() + 0.25 * (4.0 * input).sin();
            stiff[j] += defect.gear * wave;
        }
        let Some(gravity) = self.robot.gravity.filter(|_| !self.robot.links.is_empty()) else {
            return stiff;
        };
        if self.defects.iter().all(|d| d.compliance == 0.0) {
            return stiff;
        }
        let masses = ArmMasses {
            gravity,
            links: self.robot.links.iter().map(|l| (l.mass, l.com)).collect(),
            payload: self.robot.payload,
        };
        let arm = chain(&self.truth.links, Pose::identity(), Vector3::zeros());
        let mut q = stiff.clone();
        // Each round is smaller by the share that a deflection changes a torque.
        for _ in 0..20 {
            let torque = arm.load(&masses, &q, 0.0).0;
            for (j, defect) in self.defects.iter().enumerate() {
                q[j] = stiff[j] + defect.compliance * torque[j];
            }
        }
        q
    }

    /// Where the tracker sees the target, m.
    #[must_use]
    pub fn point(&self, q: &[f64]) -> Vector3<f64> {
        let arm = chain(&self.truth.links, self.truth.bases[0], self.truth.markers[0]);
        arm.bent(&self.settled(q), &[], &RowInputs::default()).translation
    }

    /// The points at these joint values, `noise` (m) added.
    #[must_use]
    pub fn seen(&self, poses: &[Vec<f64>], noise: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        poses.iter().zip(noise).map(|(q, e)| self.point(q) + e).collect()
    }
}

/// A `measurements.csv` of points.
#[must_use]
pub fn csv_of(robot: &Robot, poses: &[Vec<f64>], points: &[Vector3<f64>]) -> String {
    // Degrees, and millimetres of a prismatic joint.
    let units = robot.joints.iter().map(|j| match j.link.kind {
        JointKind::Revolute => ("deg", 1_f64.to_degrees()),
        JointKind::Prismatic => ("mm", 1e3),
    });
    let units: Vec<_> = units.collect();
    let names = units.iter().enumerate().map(|(j, (unit, _))| format!("q{}_{unit},", j + 1));
    let mut text: String = names.collect();
    text += "x_mm,y_mm,z_mm\n";
    for (q, p) in poses.iter().zip(points) {
        q.iter().zip(&units).for_each(|(q, (_, in_si))| text += &format!("{:.4},", q * in_si));
        text += &format!("{:.7},{:.7},{:.7}\n", p.x * 1e3, p.y * 1e3, p.z * 1e3);
    }
    text
}

/// The same, as read from a file of this name.
///
/// # Errors
/// As for [`Measurements::parse`].
pub fn measured(
    robot: &Robot,
    name: &str,
    poses: &[Vec<f64>],
    points: &[Vector3<f64>],
) -> Result<Measurements> {
    Measurements::parse(std::path::Path::new(name), &csv_of(robot, poses, points), robot)
}

/// Standard normals for a draw of geometric errors.
pub fn draw_errors(joints: usize, rng: &mut impl Rng) -> Vec<f64> {
    (0..5 * joints).map(|_| normal(rng)).collect()
}
