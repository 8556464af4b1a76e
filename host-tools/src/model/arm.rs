//! The crate's kinematics for a joint count known only at run time: the same
//! `Chain<f64, N>` that the controller links, chosen by N.

use nalgebra::Vector3;
use truearm::effects::{Load, Masses, Term};
use truearm::kinematics::LinkTurns;
use truearm::{Chain, Link, Pose};
use truearm_sized::{fixed, with_joints};

pub use super::derivatives::Derivatives;
pub use super::row_inputs::RowInputs;

/// An arm of any number of joints, seen from a station.
pub trait Kinematics: Send + Sync {
    /// Tool pose at joint values `q`.
    fn pose(&self, q: &[f64]) -> Pose<f64>;
    /// How the tool moves with each joint, as [`truearm::kinematics::Jacobian`]
    /// has it: its point, m per rad or m, and its turn, rad per rad or m.
    fn jacobian(&self, q: &[f64]) -> Vec<[Vector3<f64>; 2]>;
    /// Tool pose with the arm bent by `terms`.
    fn bent(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Pose<f64>;
    /// Tool point of the bent arm, and its derivatives.
    fn derivatives(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Derivatives;
    /// Those to the coefficients of terms, by derivatives of this arm at `q`.
    fn columns(
        &self,
        of: &Derivatives,
        q: &[f64],
        terms: &[Term<f64>],
        inputs: &RowInputs,
    ) -> Vec<Vector3<f64>>;
    /// What gravity does, and nothing else that terms depend on; the base must be the
    /// frame of gravity.
    fn load(&self, masses: &ArmMasses, q: &[f64], payload: f64) -> RowInputs;
}

/// Masses for any number of joints.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmMasses {
    /// Gravity in the base frame, m/s^2.
    pub gravity: Vector3<f64>,
    /// Mass and centre of mass of each link, kg and m.
    pub links: Vec<(f64, Vector3<f64>)>,
    /// Payload point in the last frame, m.
    pub payload: Vector3<f64>,
}

struct SizedArm<const N: usize> {
    links: [Link<f64>; N],
    chain: Chain<f64, N>,
    /// Taken once: every row of an identification needs them.
    turns: [LinkTurns<f64>; N],
}

impl<const N: usize> Kinematics for SizedArm<N> {
    fn pose(&self, q: &[f64]) -> Pose<f64> {
        self.chain.forward(&fixed(q))
    }

    fn jacobian(&self, q: &[f64]) -> Vec<[Vector3<f64>; 2]> {
        self.chain.jacobian(&fixed(q)).columns.map(|c| [c.linear, c.angular]).to_vec()
    }

    fn bent(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Pose<f64> {
        let deflection = inputs.deflection(terms, &inputs.fixed::<N>(q));
        self.chain.forward_deflected(&fixed(q), &deflection)
    }

    fn derivatives(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Derivatives {
        let row = inputs;
        let inputs = row.fixed::<N>(q);
        let deflection = row.deflection(terms, &inputs);
        let j =
            self.chain.identification_jacobian_with(&self.turns, &deflection.deflected(&inputs.q));
        // Base compliance turns about the axes of the robot, not the tracker.
        let r = &self.chain.base().rotation;
        let turn = |k: usize| {
            j.base_rotation[0] * r[(0, k)]
                + j.base_rotation[1] * r[(1, k)]
                + j.base_rotation[2] * r[(2, k)]
        };
        let [rx, ry, rz] = j.base_rotation;
        let [tx, ty, tz] = j.base_translation;
        // What only joints do, they do to the derivatives' arm as well.
        let rigid = terms.is_empty();
        let bent = || self.chain.forward_deflected(&inputs.q, &deflection).translation;
        Derivatives {
            point: if rigid { j.point } else { bent() },
            base: [rx, ry, rz, tx, ty, tz],
            about: [turn(0), turn(1), turn(2)],
            axes: [0, 1, 2].map(|k| r.column(k).into_owned()),
            tool: j.tool,
            links: j.links.to_vec(),
            tilts: None,
        }
    }

    fn columns(
        &self,
        of: &Derivatives,
        q: &[f64],
        terms: &[Term<f64>],
        inputs: &RowInputs,
    ) -> Vec<Vector3<f64>> {
        of.columns(terms, inputs, q, &self.links)
    }

    fn load(&self, masses: &ArmMasses, q: &[f64], payload: f64) -> RowInputs {
        let links: [(f64, Vector3<f64>); N] = fixed(&masses.links);
        let masses = Masses {
            gravity: masses.gravity,
            mass: links.map(|l| l.0),
            com: links.map(|l| l.1),
            payload_com: masses.payload,
        };
        let Load { torque, moment, across } = masses.load(&self.chain, &fixed(q), payload);
        let across = across.map_or_else(Vec::new, Vec::from);
        RowInputs { torque: torque.to_vec(), moment, across, ..RowInputs::default() }
    }
}

/// The arm of these links with this base and tool point.
#[must_use]
pub fn chain(links: &[Link<f64>], base: Pose<f64>, tool: Vector3<f64>) -> Box<dyn Kinematics> {
    let tool = Pose { translation: tool, ..Pose::identity() };
    with_joints!(links.len(), N => {
        let links: [Link<f64>; N] = fixed(links);
        let chain = Chain::new(&links, base, tool);
        Box::new(SizedArm { turns: chain.link_turns(), chain, links })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What curves do to joints of either kind is in the tool point, with and without terms.
    #[test]
    fn the_point_of_derivatives_is_that_of_the_bent_arm() {
        let links = [
            Link::revolute(0.0, 0.2, 0.3, 0.1, 0.02),
            Link::prismatic(1.5, 0.1, -0.2, 0.3, 0.0),
            Link::revolute(-1.5, 0.2, 0.1, 0.1, -0.01),
        ];
        let base =
            Pose::from_rotation_vector(Vector3::new(1.0, -0.5, 0.2), Vector3::new(0.1, 0.2, 0.3));
        let arm = chain(&links, base, Vector3::new(0.05, -0.02, 0.1));
        let inputs = RowInputs { curves: vec![1e-3, -2e-3, 5e-4], ..RowInputs::default() };
        let gain = Term {
            effect: truearm::effects::Effect::JointGain,
            joint: 0,
            source: 0,
            component: 0,
            order: 0.0,
            coefficient: 1e-3,
        };
        for terms in [&[][..], &[gain]] {
            let q = [0.4, 0.7, -1.1];
            let apart = arm.derivatives(&q, terms, &inputs).point
                - arm.bent(&q, terms, &inputs).translation;
            assert!(apart.norm() < 1e-14, "{} terms: {apart}", terms.len());
        }
    }

    /// On another base derivatives are those of the arm there.
    #[test]
    fn rebased() {
        let links = [
            Link::revolute(0.0, 0.2, 0.3, 0.1, 0.02),
            Link::prismatic(1.5, 0.1, -0.2, 0.3, 0.0),
            Link::revolute(-1.5, 0.2, 0.1, 0.1, -0.01),
        ];
        let pose = |a: f64, b: f64| {
            Pose::from_rotation_vector(Vector3::new(a, -b, a * b), Vector3::new(b, a, a - b))
        };
        for (a, b) in [(0.3, 1.2), (-2.0, 0.4), (1e3, -0.9)] {
            let (own, other) = (pose(a, b), pose(b, 0.1 * a));
            let tool = Vector3::new(0.05, -0.02, 0.1);
            let of = |base| {
                let q = [0.4, 0.7, -1.1];
                chain(&links, base, tool).derivatives(&q, &[], &RowInputs::default())
            };
            let (there, moved) = (of(other), of(own).rebased(&own, &other));
            let numbers = |d: &Derivatives| -> Vec<f64> {
                let links = d.links.iter().flat_map(|l| l.to_array());
                let all = d.base.into_iter().chain(d.about).chain(d.axes).chain(d.tool);
                all.chain([d.point]).chain(links).flat_map(|v| [v.x, v.y, v.z]).collect()
            };
            for (a, b) in numbers(&there).iter().zip(numbers(&moved)) {
                assert!((a - b).abs() < 1e-11 * (1.0 + own.translation.norm()), "{a} {b}");
            }
        }
    }
}
