//! A real arm: its springs in equilibrium with the deflected arm's potential
//! energy. Nothing here comes from the crate.

use std::ops::{Deref, DerefMut};

use nalgebra::{Rotation3, Vector3};

use crate::body::{Body, Moment, Shape, apply};
use crate::effects::{Defect, DefectKind};
use crate::oracle::Matrix;

/// A real arm: a body and what it does beyond rigid geometry.
#[derive(Debug, Clone)]
pub struct Arm {
    pub body: Body,
    pub defects: Vec<Defect>,
}

impl Deref for Arm {
    type Target = Body;

    fn deref(&self) -> &Body {
        &self.body
    }
}

impl DerefMut for Arm {
    fn deref_mut(&mut self) -> &mut Body {
        &mut self.body
    }
}

/// A deflection that moves less than this has settled, rad.
const SETTLED: f64 = 1e-12;

impl Arm {
    /// Where the tracker sees the target, without noise.
    pub fn point(&self, moment: &Moment) -> Vector3<f64> {
        let shape = self.at_rest(moment);
        let mut target = self.tool;
        for defect in &self.defects {
            if let (DefectKind::ToolRemount { direction }, true) = (&defect.kind, moment.later) {
                target += direction * defect.size;
            }
            if let DefectKind::Outside(outside) = &defect.kind {
                target += outside.carried(defect.size, moment);
            }
        }
        let frames = self.frames(&shape);
        let mut seen = apply(&self.station, &apply(&frames[frames.len() - 1], &target));
        for defect in &self.defects {
            let passed = moment.time / 3600.0;
            let (shift, turn, way) = match &defect.kind {
                DefectKind::MeasurementDrift { shift, turn } => (shift, turn, passed),
                DefectKind::MeasurementSettling { shift, turn, hours } => {
                    (shift, turn, 1.0 - (-passed / hours).exp())
                }
                _ => continue,
            };
            let way = defect.size * way;
            seen = Rotation3::from_scaled_axis(turn * (way / 6.0)) * seen + shift * way;
        }
        for defect in &self.defects {
            if let DefectKind::Outside(outside) = &defect.kind {
                seen = outside.seen(defect.size, seen);
            }
        }
        seen
    }

    /// The last frame in that before the first joint.
    pub fn last_frame(&self, moment: &Moment) -> Matrix<f64> {
        let frames = self.frames(&self.at_rest(moment));
        frames[frames.len() - 1]
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
                    let pairs = s.bend.iter().chain(&s.nod).chain([&s.tilt]).flatten().copied();
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
