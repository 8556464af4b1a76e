//! What arms do beyond rigid geometry: which effects, where, how large, and each
//! by its exact construction: springs, an eccentric disc, a play that gravity or
//! the approach takes up. Nothing here is linear in a coefficient by definition.

mod drawn;
mod outside;

use nalgebra::Vector3;

use crate::body::{Body, Moment, Shape};
pub use drawn::drawn;
pub use outside::Outside;

/// An effect and how large it is, in the unit of its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Defect {
    pub kind: DefectKind,
    pub size: f64,
}

/// Where and how; joints are counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum DefectKind {
    /// A spring: rad per N m.
    JointCompliance { joint: usize },
    /// A spring that is not linear: rad per (N m)^2, with the torque's sign.
    JointStiffening { joint: usize },
    /// A bearing that gives way across its axis, as far in either direction: rad per N m.
    LateralCompliance { joint: usize },
    /// Two springs: rad per N m about x; about y `ratio` times as much.
    BaseCompliance { ratio: f64 },
    /// The disc's centre off the axis, in radii.
    EncoderEccentricity { joint: usize, phase: f64 },
    /// Strain-wave: twice an input turn, and a quarter of it four times: rad.
    GearTransmissionError { joint: usize, phases: [f64; 2] },
    /// rad
    JointPeriodicError { joint: usize, order: f64, phase: f64 },
    /// rad per rad
    JointGain { joint: usize },
    /// rad per rad
    JointCoupling { source: usize, joint: usize },
    /// Half the gap, rad. Beyond `friction` N m gravity takes up the gap.
    Backlash { joint: usize, friction: f64 },
    /// What is read lags behind the motion: rad.
    ReadoutLag { joint: usize },
    /// Relative growth per K at the reference temperature; 0.2 % more each K.
    ThermalExpansion,
    /// The target re-seated before series B: m along `direction`.
    ToolRemount { direction: Vector3<f64> },
    /// The tracker's frame moves: m per hour, turning about `turn` as much as
    /// moves a point 3 m away by half of that.
    MeasurementDrift { shift: Vector3<f64>, turn: Vector3<f64> },
    /// What the tracker stands on settles: m, and turning about `turn` as much as moves a
    /// point 3 m away by half of that, in so many hours.
    MeasurementSettling { shift: Vector3<f64>, turn: Vector3<f64>, hours: f64 },
    /// Gross errors in so many rows out of a hundred.
    Outliers,
    /// Unlisted: the axis nods `order` times a turn, rad.
    BearingWobble { joint: usize, order: f64, phase: f64 },
    /// Unlisted: the link behind the joint bends about its own `axis` (0 or 1:
    /// across the joint's) with the square of the load: rad per (N m)^2.
    LinkBending { joint: usize, axis: usize },
    /// Unlisted: the joint creeps back to where it last stood: rad per rad.
    Memory { joint: usize },
    /// Unlisted: a part goes with what has nothing to do with it.
    Outside(Outside),
}

impl DefectKind {
    /// Name in reports; of unlisted kinds the one in the tables of the study.
    pub fn name(&self) -> &'static str {
        match self {
            Self::JointCompliance { .. } => "joint-compliance",
            Self::JointStiffening { .. } => "joint-stiffening",
            Self::LateralCompliance { .. } => "lateral-compliance",
            Self::BaseCompliance { .. } => "base-compliance",
            Self::EncoderEccentricity { .. } => "encoder-eccentricity",
            Self::GearTransmissionError { .. } => "gear-transmission-error",
            Self::JointPeriodicError { .. } => "joint-periodic-error",
            Self::JointGain { .. } => "joint-gain",
            Self::JointCoupling { .. } => "joint-coupling",
            Self::Backlash { .. } => "backlash",
            Self::ReadoutLag { .. } => "readout-lag",
            Self::ThermalExpansion => "thermal-expansion",
            Self::ToolRemount { .. } => "tool-remount",
            Self::MeasurementDrift { .. } | Self::MeasurementSettling { .. } => "measurement-drift",
            Self::Outliers => "outliers",
            Self::BearingWobble { .. } => "bearing wobble",
            Self::LinkBending { .. } => "quadratic link bending",
            Self::Memory { .. } => "memory of the last pose",
            Self::Outside(Outside::Hose { .. }) => "hose from joint to joint",
            Self::Outside(Outside::Pedestal { .. }) => "leaning pedestal",
            Self::Outside(Outside::Holder { .. }) => "yielding target holder",
            Self::Outside(Outside::Azimuth { .. }) => "tracker's azimuth",
            Self::Outside(Outside::Distance { .. }) => "tracker's distance",
            Self::Outside(Outside::Warm { .. }) => "warm encoder",
        }
    }

    /// As in reports: counted from 1, coupling is source, target.
    pub fn joints(&self) -> Vec<usize> {
        match self {
            Self::JointCoupling { source, joint } => vec![source + 1, joint + 1],
            Self::JointCompliance { joint }
            | Self::JointStiffening { joint }
            | Self::LateralCompliance { joint }
            | Self::EncoderEccentricity { joint, .. }
            | Self::GearTransmissionError { joint, .. }
            | Self::JointPeriodicError { joint, .. }
            | Self::JointGain { joint }
            | Self::Backlash { joint, .. }
            | Self::ReadoutLag { joint }
            | Self::BearingWobble { joint, .. }
            | Self::LinkBending { joint, .. }
            | Self::Memory { joint } => vec![joint + 1],
            _ => Vec::new(),
        }
    }

    /// Cycles a turn of its waves in an arm of these gears; the friction of a gap,
    /// N m; otherwise 0 once.
    pub fn orders(&self, gear_ratios: &[f64]) -> Vec<f64> {
        match *self {
            Self::EncoderEccentricity { .. } => vec![1.0],
            Self::GearTransmissionError { joint, .. } => {
                [2.0, 4.0].map(|k| k * gear_ratios[joint]).to_vec()
            }
            Self::JointPeriodicError { order, .. } => vec![order],
            Self::Backlash { friction, .. } => vec![friction],
            _ => vec![0.0],
        }
    }

    /// A larger one would be seen without any tool.
    pub fn largest(&self) -> f64 {
        match self {
            Self::JointCompliance { .. } | Self::LateralCompliance { .. } => 2e-4,
            Self::JointStiffening { .. } => 5e-6,
            Self::BaseCompliance { .. } => 5e-5,
            Self::EncoderEccentricity { .. } => 4e-3,
            Self::GearTransmissionError { .. } | Self::JointPeriodicError { .. } => 3e-3,
            Self::JointGain { .. } | Self::JointCoupling { .. } => 5e-3,
            Self::Backlash { .. } | Self::ReadoutLag { .. } | Self::BearingWobble { .. } => 3e-3,
            Self::ThermalExpansion => 4e-5,
            Self::ToolRemount { .. }
            | Self::MeasurementDrift { .. }
            | Self::MeasurementSettling { .. } => 2e-3,
            Self::Outliers => 3.0,
            Self::LinkBending { .. } => 1e-4,
            Self::Memory { .. } | Self::Outside(_) => 2e-3,
        }
    }
}

impl Defect {
    /// What it does to an arm that no load bends.
    pub(crate) fn displace(&self, shape: &mut Shape, body: &Body, moment: &Moment) {
        let size = self.size;
        let q = |j: usize| moment.q[j];
        match self.kind {
            DefectKind::EncoderEccentricity { joint, phase } => {
                // The mark at angle q of the disc, seen from off its centre.
                let (sin, cos) = (q(joint) - phase).sin_cos();
                shape.joints[joint] += (size * sin).atan2(1.0 - size * cos);
            }
            DefectKind::GearTransmissionError { joint, phases } => {
                let input = body.gear_ratios[joint] * q(joint);
                let wave = (2.0 * input + phases[0]).sin() + 0.25 * (4.0 * input + phases[1]).sin();
                shape.joints[joint] += size * wave;
            }
            DefectKind::JointPeriodicError { joint, order, phase } => {
                shape.joints[joint] += size * (order * q(joint) + phase).sin();
            }
            DefectKind::ReadoutLag { joint } => {
                shape.joints[joint] += size * f64::from(moment.directions[joint]);
            }
            DefectKind::JointGain { joint } => shape.joints[joint] += size * q(joint),
            DefectKind::JointCoupling { source, joint } => shape.joints[joint] += size * q(source),
            DefectKind::ThermalExpansion => {
                // The coefficient itself grows; integrated from 20 degrees.
                let warmth = moment.links - 20.0;
                let growth = (size * (warmth + 0.001 * warmth * warmth)).exp();
                for link in &mut shape.links {
                    link[1] *= growth;
                    link[3] *= growth;
                }
            }
            DefectKind::BearingWobble { joint, order, phase } => {
                let (sin, cos) = (order * q(joint) + phase).sin_cos();
                shape.nod[joint] = [size * cos, size * sin];
            }
            DefectKind::Memory { joint } => {
                shape.joints[joint] += size * (moment.before[joint] - q(joint))
            }
            DefectKind::Outside(outside) => outside.displace(size, shape, moment),
            _ => {}
        }
    }

    /// How it gives way to the loads on the arm as it stands now.
    pub(crate) fn yield_to_load(
        &self,
        next: &mut Shape,
        now: &Shape,
        body: &Body,
        moment: &Moment,
    ) {
        let size = self.size;
        match self.kind {
            DefectKind::JointCompliance { joint } => {
                next.joints[joint] +=
                    size * body.load(now, moment.payload, |s| &mut s.joints[joint]);
            }
            DefectKind::JointStiffening { joint } => {
                let load = body.load(now, moment.payload, |s| &mut s.joints[joint]);
                next.joints[joint] += size * load * load.abs();
            }
            DefectKind::LateralCompliance { joint } => {
                for (axis, moment) in body.across(now, moment.payload, joint).iter().enumerate() {
                    next.nod[joint][axis] += size * moment;
                }
            }
            DefectKind::BaseCompliance { ratio } => {
                for (axis, size) in [size, size * ratio].into_iter().enumerate() {
                    next.tilt[axis] += size * body.load(now, moment.payload, |s| &mut s.tilt[axis]);
                }
            }
            DefectKind::Backlash { joint, friction } => {
                let torque = body.torque(moment, joint);
                // Gravity pulls the link through the gap if it can; otherwise
                // the link lags behind the motion.
                let side = if torque.abs() > friction {
                    torque.signum()
                } else {
                    -f64::from(moment.directions[joint])
                };
                next.joints[joint] += size * side;
            }
            DefectKind::LinkBending { joint, axis } => {
                let load = body.load(now, moment.payload, |s| &mut s.bend[joint][axis]);
                next.bend[joint][axis] = size * load * load.abs();
            }
            _ => {}
        }
    }
}
