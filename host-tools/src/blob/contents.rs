//! What a blob holds as plain numbers, mm and degrees, for reports.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;
use truearm::blob::{Blob, LAYOUT};
use truearm::effects::Curve;
use truearm::{JointKind, LinkParameter, MdhParameters};
use truearm_sized::Parameters;

use super::describe::{parameters, term_columns};
use crate::model::ErrorCurve;
use crate::units::{joint_to_file, link_unit, point_to_mm, to_mm};

/// The fields of a blob.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Contents {
    /// Layout of the bytes.
    pub layout: u16,
    /// Size of the blob.
    pub bytes: usize,
    /// Bytes behind it that are ignored.
    pub ignored_bytes: usize,
    /// Hash of name and serial of the robot, 0x and 16 hexadecimal digits.
    pub robot_id: String,
    /// Sequence number: of two slots the higher one counts.
    pub sequence: u32,
    /// When the model was identified, Unix seconds; none if it is not known.
    pub created_unix_s: Option<u32>,
    /// Whether it carries an authentication tag.
    pub authenticated: bool,
    /// Whether the data determined how the flange is turned.
    pub orientation_identified: bool,
    /// Carries identified tool points onto nominal ones: translation.
    pub base_translation_mm: [f64; 3],
    /// The same: rotation vector.
    pub base_rotation_deg: [f64; 3],
    /// The tool point in the flange frame.
    pub tool_mm: [f64; 3],
    /// RMS error with nominal geometry; none if it is not known.
    pub rms_before_mm: Option<f64>,
    /// Cross-validated RMS error; none if it is not known.
    pub rms_after_mm: Option<f64>,
    /// Temperature that the lengths refer to, degrees Celsius.
    pub reference_temperature_c: f64,
    /// Masses and gravity, if they are given.
    pub masses: Option<BlobMasses>,
    /// Whether terms follow torques of the joints that the controller has to read.
    pub reads_torques: bool,
    /// One a joint.
    pub joints: Vec<BlobJoint>,
    /// Terms beyond geometry.
    pub terms: Vec<BlobTerm>,
    /// Smooth errors of joint angles.
    pub curves: Vec<BlobCurve>,
    /// Parameters of the covariance; none without one.
    pub covariance_parameters: Option<usize>,
}

/// Gravity and what it pulls at.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BlobMasses {
    /// In the frame before joint 1.
    pub gravity_m_s2: [f64; 3],
    /// The payload's centre of mass in the flange frame.
    pub payload_mm: [f64; 3],
    /// Of each link.
    pub mass_kg: Vec<f64>,
    /// Its centre of mass, in its frame.
    pub com_mm: Vec<[f64; 3]>,
}

/// A joint and the link before it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BlobJoint {
    /// `revolute` or `prismatic`.
    pub kind: &'static str,
    /// Nominal parameters.
    pub nominal: BlobLink,
    /// Identified corrections, added to them.
    pub correction: BlobLink,
    /// Joint limits, degrees or mm.
    pub limits: Option<[f64; 2]>,
    /// Range that the identification covered, degrees or mm.
    pub covered: Option<[f64; 2]>,
}

/// Parameters of a link, or corrections to them.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BlobLink {
    /// Link twist.
    pub alpha_deg: f64,
    /// Link length.
    pub a_mm: f64,
    /// Joint offset.
    pub theta_offset_deg: f64,
    /// Link offset.
    pub d_mm: f64,
    /// Hayati's beta.
    pub beta_deg: f64,
}

/// A term of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BlobTerm {
    /// Its effect.
    pub effect: &'static str,
    /// Its joint from 1, `source>target` of a coupling, `all` or `base`.
    pub joint: String,
    /// Its component; empty without.
    pub component: &'static str,
    /// Its order, or friction with its unit; empty without.
    pub order: String,
    /// The coefficient.
    pub coefficient: f64,
    /// Its unit, SI.
    pub unit: &'static str,
}

/// A smooth error of a joint's angle.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BlobCurve {
    /// From 1.
    pub joint: usize,
    /// Nodes over a turn.
    pub nodes: usize,
    /// Largest error.
    pub largest_mrad: f64,
    /// Root mean square over a turn.
    pub rms_mrad: f64,
    /// One standard deviation where it is known.
    pub band_mrad: f64,
    /// Angles between which it is not known.
    pub gaps_deg: Vec<[f64; 2]>,
    /// One standard deviation there; none without gaps.
    pub gap_band_mrad: Option<f64>,
}

/// The fields of a blob; `given` is how many bytes it was found in.
#[must_use]
pub fn contents(blob: &Blob, given: usize) -> Contents {
    let p = &parameters(blob);
    let known = |metres: f64| (metres != 0.0).then(|| to_mm(metres));
    Contents {
        layout: LAYOUT,
        bytes: blob.size(),
        ignored_bytes: given.saturating_sub(blob.size()),
        robot_id: format!("{:#018x}", p.robot_id),
        sequence: p.sequence,
        created_unix_s: (p.created != 0).then_some(p.created),
        authenticated: blob.is_tagged(),
        orientation_identified: p.orientation_identified,
        base_translation_mm: point_to_mm(&p.base_translation),
        base_rotation_deg: degrees(&p.base_rotation),
        tool_mm: point_to_mm(&p.tool),
        rms_before_mm: known(p.rms_before),
        rms_after_mm: known(p.rms_after),
        reference_temperature_c: p.reference_temperature,
        masses: p.masses.as_ref().map(|m| BlobMasses {
            gravity_m_s2: m.gravity.into(),
            payload_mm: point_to_mm(&m.payload_com),
            mass_kg: m.mass.to_vec(),
            com_mm: m.com.iter().map(point_to_mm).collect(),
        }),
        reads_torques: blob.reads_torques(),
        joints: (0..p.nominal.len()).map(|i| joint(p, i)).collect(),
        terms: terms(p),
        curves: p.curves.iter().map(|curve| curve_of(&curve)).collect(),
        covariance_parameters: blob.covariance().map(|c| c.parameters()),
    }
}

fn degrees(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z].map(f64::to_degrees)
}

fn joint(p: &Parameters, i: usize) -> BlobJoint {
    let kind = p.nominal[i].kind;
    let range = |r: Option<[f64; 2]>| r.map(|r| r.map(|q| joint_to_file(kind, q)));
    BlobJoint {
        kind: if kind == JointKind::Revolute { "revolute" } else { "prismatic" },
        nominal: link(&p.nominal[i].parameters),
        correction: link(&p.corrections[i]),
        limits: range(p.limits[i]),
        covered: range(p.covered[i]),
    }
}

fn link(p: &MdhParameters<f64>) -> BlobLink {
    let file = LinkParameter::ALL.map(|parameter| link_unit(parameter).1);
    let [alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg] =
        std::array::from_fn(|k| p.to_array()[k] * file[k]);
    BlobLink { alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg }
}

fn terms(p: &Parameters) -> Vec<BlobTerm> {
    let kinds = p.kinds();
    let term = |t: &truearm::effects::Term<f64>| {
        let (joint, component, order) = term_columns(t, &kinds);
        let (effect, unit) = (t.effect.name(), t.unit(&kinds));
        BlobTerm { effect, joint, component, order, coefficient: t.coefficient, unit }
    };
    p.terms.iter().map(term).collect()
}

fn curve_of(curve: &Curve<'_>) -> BlobCurve {
    let of_model = ErrorCurve::of_blob(curve);
    let [largest_mrad, rms_mrad] = of_model.size().map(|rad| rad * 1e3);
    BlobCurve {
        joint: usize::from(curve.joint()) + 1,
        nodes: curve.nodes().len(),
        largest_mrad,
        rms_mrad,
        band_mrad: of_model.band() * 1e3,
        gaps_deg: of_model.gap_ranges().iter().map(|range| range.map(f64::to_degrees)).collect(),
        gap_band_mrad: of_model.gap_band().map(|band| band * 1e3),
    }
}
