use schemars::JsonSchema;
use serde::Serialize;
use truearm::{JointKind, LinkParameter};

use crate::convert::{Identified, LeftOut};
use crate::model::{Model, Placement};
use crate::units::{joint_to_file, link_unit, point_to_mm, to_mm};

/// What `export --json` writes: an identified arm's geometry, mm and degrees.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ExportReport {
    /// The schema.
    #[schemars(extend("const" = ExportReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "export"))]
    pub command: &'static str,
    /// The model file.
    pub model: String,
    /// Name of the robot.
    pub robot: String,
    /// The frame before joint 1 in the coordinates of the files.
    pub base: ExportFrame,
    /// The measured target in the last frame.
    pub tool: ExportFrame,
    /// Label of that target.
    pub marker: String,
    /// The links, `Rx(alpha) Tx(a) Rz(theta_offset + q) Tz(d) Ry(beta)`.
    pub joints: Vec<ExportJoint>,
    /// Effects of the model that geometry does not carry.
    pub left_out: Vec<ExportLeftOut>,
    /// Remarks.
    pub warnings: Vec<String>,
}

/// A frame: `R = Rz Ry Rx`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ExportFrame {
    /// Its origin.
    pub xyz_mm: [f64; 3],
    /// Turns about the fixed axes x, then y, then z.
    pub rpy_deg: [f64; 3],
}

/// A joint and the link before it, identified.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ExportJoint {
    /// `revolute` or `prismatic`.
    pub kind: &'static str,
    /// Link twist.
    pub alpha_deg: f64,
    /// Link length.
    pub a_mm: f64,
    /// Joint offset; the fixed angle of a prismatic joint.
    pub theta_offset_deg: f64,
    /// Link offset; a prismatic joint's value adds to it.
    pub d_mm: f64,
    /// Hayati's beta.
    pub beta_deg: f64,
    /// Range that the identification covered, degrees or mm.
    pub covered: Option<[f64; 2]>,
}

/// What an effect moves, within the covered ranges.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ExportLeftOut {
    /// Its name; `all` for all together.
    pub effect: &'static str,
    /// Its joints, counted from 1.
    pub joints: Vec<usize>,
    /// Root mean square distance of the tool point.
    pub rms_mm: f64,
    /// Largest distance.
    pub largest_mm: f64,
}

impl ExportReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-export-1";

    /// Of a model, its geometry and what that leaves out.
    #[must_use]
    pub fn new(
        path: String,
        model: &Model,
        arm: &Identified,
        left_out: &[LeftOut],
        warnings: Vec<String>,
    ) -> Self {
        let joints = arm.links.iter().zip(&model.covered).map(|(link, covered)| {
            let values: Vec<f64> = LinkParameter::ALL
                .into_iter()
                .zip(link.parameters.to_array())
                .map(|(parameter, value)| value * link_unit(parameter).1)
                .collect();
            ExportJoint {
                kind: if link.kind == JointKind::Revolute { "revolute" } else { "prismatic" },
                alpha_deg: values[0],
                a_mm: values[1],
                theta_offset_deg: values[2],
                d_mm: values[3],
                beta_deg: values[4],
                covered: covered.map(|range| range.map(|q| joint_to_file(link.kind, q))),
            }
        });
        let left_out = left_out.iter().map(|left| ExportLeftOut {
            effect: if left.effect.is_empty() { "all" } else { left.effect },
            joints: left.joints.clone(),
            rms_mm: to_mm(left.rms),
            largest_mm: to_mm(left.largest),
        });
        Self {
            schema: Self::SCHEMA,
            command: "export",
            model: path,
            robot: model.robot.name.clone(),
            base: frame(&Placement::of(&arm.base)),
            tool: frame(&Placement::of(&arm.tool)),
            marker: arm.marker.clone(),
            joints: joints.collect(),
            left_out: left_out.collect(),
            warnings,
        }
    }
}

fn frame(placement: &Placement) -> ExportFrame {
    let rpy: [f64; 3] = placement.rpy.into();
    ExportFrame { xyz_mm: point_to_mm(&placement.xyz), rpy_deg: rpy.map(f64::to_degrees) }
}
