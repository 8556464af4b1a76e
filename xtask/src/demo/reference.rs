//! What the host makes of the same ten points: the parameters that did move,
//! by Gauss-Newton with difference quotients and a singular value decomposition,
//! and joints that put the tool on its target. Kinematics of 4x4 matrices in
//! `f64`; nothing is the crate's but the blob it begins with.

use nalgebra::{DVector, Vector3};
use truearm::ArmParameters;

use super::cell::{Cell, Event, Joints};
use crate::least_squares::least_squares;
use truearm_simulate::arm::Arm;
use truearm_simulate::oracle::{self, Matrix};
use truearm_simulate::{at_rest, rigid};

/// A model of the arm, in the commanded frame.
pub struct Reference(Arm);

impl Reference {
    /// What a blob says.
    pub fn new(parameters: &ArmParameters<f64, 6>, like: &Cell) -> Self {
        let p = parameters;
        let links = p.nominal.iter().zip(&p.corrections);
        let sum = |(link, correction): (&truearm::Link<f64>, _)| {
            link.corrected(correction).parameters.to_array()
        };
        Self(like.arm_with(
            links.map(sum).collect(),
            rigid(&p.base_rotation, &p.base_translation),
            p.tool,
        ))
    }

    fn point(&self, joints: &Joints) -> Vector3<f64> {
        self.0.point(&at_rest(joints))
    }

    /// The model with what an event moves changed by `x`.
    fn changed(&self, event: &Event, x: &[f64]) -> Self {
        let mut arm = self.0.clone();
        match event {
            Event::Crash(slipped) => {
                for ((joint, _), x) in slipped.iter().zip(x) {
                    arm.links[*joint][2] += x;
                }
            }
            Event::Loosened(..) => {
                let (turn, shift) = (Vector3::from_column_slice(&x[..3]), &x[3..]);
                let motion: Matrix<f64> = rigid(&turn, &Vector3::from_column_slice(shift));
                arm.station = oracle::product(&motion, &arm.station);
            }
        }
        Self(arm)
    }

    /// Re-identified from points: encoder readings, point in the commanded frame.
    pub fn reidentified(&self, event: &Event, points: &[(Joints, Vector3<f64>)]) -> Self {
        let unknowns = match event {
            Event::Crash(slipped) => slipped.len(),
            Event::Loosened(..) => 6,
        };
        let predicted = |x: &[f64]| {
            let model = self.changed(event, x);
            let all = points.iter().flat_map(|(q, _)| model.point(q).data.0[0]);
            DVector::from_iterator(3 * points.len(), all)
        };
        let measured = points.iter().flat_map(|(_, point)| point.data.0[0]);
        let measured = DVector::from_iterator(3 * points.len(), measured);
        let x = least_squares(unknowns, |x| &measured - predicted(x));
        self.changed(event, x.as_slice())
    }

    /// The joints nearest to a command at which this model has the tool on the
    /// target.
    pub fn compensated(&self, command: &Joints, target: &Vector3<f64>) -> Joints {
        let at = |x: &[f64]| core::array::from_fn(|k| command[k] + x[k]);
        let x = least_squares(6, |x| {
            let error = target - self.point(&at(x));
            DVector::from_column_slice(error.as_slice())
        });
        at(x.as_slice())
    }
}
