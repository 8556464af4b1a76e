//! What arms do beyond rigid geometry: which effects, where, how large. How they
//! act is in `arm.rs`.

use nalgebra::Vector3;

/// An effect and how large it is, in the unit of its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Defect {
    pub kind: Kind,
    pub size: f64,
}

/// Where and how; joints are counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// A spring: rad per N m.
    JointCompliance { joint: usize },
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
    /// Relative growth per K at the reference temperature; 0.2 % more each K.
    ThermalExpansion,
    /// The target re-seated before series B: m along `direction`.
    ToolRemount { direction: Vector3<f64> },
    /// The tracker's frame moves: m per hour, turning about `turn` as much as
    /// moves a point 3 m away by half of that.
    MeasurementDrift { shift: Vector3<f64>, turn: Vector3<f64> },
    /// Gross errors in so many rows out of a hundred.
    Outliers,
    /// Unlisted: the axis nods `order` times a turn, rad.
    BearingWobble { joint: usize, order: f64, phase: f64 },
    /// Unlisted: the link behind the joint bends about its own `axis` (0 or 1:
    /// across the joint's) with the square of the load: rad per (N m)^2.
    LinkBending { joint: usize, axis: usize },
    /// Unlisted: the joint creeps back to where it last stood: rad per rad.
    Memory { joint: usize },
}

impl Kind {
    /// Name in reports; of unlisted kinds the one in the tables of the study.
    pub fn name(&self) -> &'static str {
        match self {
            Self::JointCompliance { .. } => "joint-compliance",
            Self::BaseCompliance { .. } => "base-compliance",
            Self::EncoderEccentricity { .. } => "encoder-eccentricity",
            Self::GearTransmissionError { .. } => "gear-transmission-error",
            Self::JointPeriodicError { .. } => "joint-periodic-error",
            Self::JointGain { .. } => "joint-gain",
            Self::JointCoupling { .. } => "joint-coupling",
            Self::Backlash { .. } => "backlash",
            Self::ThermalExpansion => "thermal-expansion",
            Self::ToolRemount { .. } => "tool-remount",
            Self::MeasurementDrift { .. } => "measurement-drift",
            Self::Outliers => "outliers",
            Self::BearingWobble { .. } => "bearing wobble",
            Self::LinkBending { .. } => "quadratic link bending",
            Self::Memory { .. } => "memory of the last pose",
        }
    }

    /// As in reports: counted from 1, coupling is source, target.
    pub fn joints(&self) -> Vec<usize> {
        match self {
            Self::JointCoupling { source, joint } => vec![source + 1, joint + 1],
            Self::JointCompliance { joint }
            | Self::EncoderEccentricity { joint, .. }
            | Self::GearTransmissionError { joint, .. }
            | Self::JointPeriodicError { joint, .. }
            | Self::JointGain { joint }
            | Self::Backlash { joint, .. }
            | Self::BearingWobble { joint, .. }
            | Self::LinkBending { joint, .. }
            | Self::Memory { joint } => vec![joint + 1],
            _ => Vec::new(),
        }
    }

    /// A larger one would be seen without any tool.
    pub fn largest(&self) -> f64 {
        match self {
            Self::JointCompliance { .. } => 2e-4,
            Self::BaseCompliance { .. } => 5e-5,
            Self::EncoderEccentricity { .. } => 4e-3,
            Self::GearTransmissionError { .. } | Self::JointPeriodicError { .. } => 3e-3,
            Self::JointGain { .. } | Self::JointCoupling { .. } => 5e-3,
            Self::Backlash { .. } | Self::BearingWobble { .. } => 3e-3,
            Self::ThermalExpansion => 4e-5,
            Self::ToolRemount { .. } | Self::MeasurementDrift { .. } => 2e-3,
            Self::Outliers => 3.0,
            Self::LinkBending { .. } => 1e-4,
            Self::Memory { .. } => 2e-3,
        }
    }
}
