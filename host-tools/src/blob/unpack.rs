//! From a blob back to a model.

use std::path::Path;

use nalgebra::Vector3;
use truearm::blob::{Blob, robot_id};
use truearm_sized::Parameters;

use crate::error::{Error, ErrorKind, Result};
use crate::files::USUAL_SIGMA_MM;
use crate::model::{
    ErrorCurve, Joint, LinkMass, LinkPrior, Model, ModelTerm, Placement, Provenance, Robot,
};
use crate::units::from_mm;

/// Whose blob it is: what the robot id is the hash of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// Model name.
    pub name: String,
    /// Serial number.
    pub serial: String,
}

/// The model that packs to this blob. `path` is named in messages.
///
/// # Errors
/// Why a controller would refuse the blob, or a name that is not its robot's.
pub fn unpack(bytes: &[u8], path: &Path, name: Option<Name>) -> Result<Model> {
    let blob = Blob::check(bytes).map_err(|e| {
        Error::data(ErrorKind::Refused, format!("{}: {e}", path.display()), "see `truearm inspect`")
    })?;
    let id = blob.robot_id();
    if let Some(Name { name, serial }) = &name
        && robot_id(name, serial) != id
    {
        return Err(Error::data(
            ErrorKind::OtherArm,
            format!(
                "{}: robot id {id:#018x} is not that of \"{name}\" \"{serial}\"",
                path.display()
            ),
            "give name and serial as robot.toml had them, or neither",
        ));
    }
    let parameters = Parameters::read(&blob);
    let parameters = parameters.map_err(|e| {
        Error::data(ErrorKind::Refused, format!("{}: {e}", path.display()), "see `truearm inspect`")
    })?;
    let mut model = model(&parameters, path, name);
    model.covariance = blob.covariance().map(|covariance| covariance.factor().collect());
    Ok(model)
}

fn model(p: &Parameters, path: &Path, name: Option<Name>) -> Model {
    let created = std::time::Duration::from_secs(u64::from(p.created));
    let known = name.is_some();
    Model {
        robot: robot(p, path, name),
        corrections: p.corrections.clone(),
        uncertainties: Vec::new(),
        covered: p.covered.clone(),
        terms: p.terms.iter().copied().map(ModelTerm::Arm).collect(),
        curves: p.curves.iter().map(|curve| ErrorCurve::of_blob(&curve)).collect(),
        stations: Vec::new(),
        markers: vec![(String::new(), p.tool)],
        not_measured: Vec::new(),
        instruments: Vec::new(),
        frame_translation: p.base_translation,
        frame_rotation: p.base_rotation,
        provenance: Provenance {
            tool_point_mm: None,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            created: humantime::format_rfc3339_seconds(std::time::UNIX_EPOCH + created).to_string(),
            sequence: (p.sequence != p.created).then_some(p.sequence),
            data: format!("unpacked from {}", path.display()),
            nominal_rms_mm: p.rms_before * 1e3,
            cross_validated_rms_mm: p.rms_after * 1e3,
            ..Provenance::default()
        },
        unidentifiable: Vec::new(),
        orientation_identified: p.orientation_identified,
        robot_id: (!known).then_some(p.robot_id),
        covariance: None,
        gram: None,
        changed: false,
    }
}

/// The nominal arm.
fn robot(p: &Parameters, path: &Path, name: Option<Name>) -> Robot {
    let Name { name, serial } = name.unwrap_or_else(|| Name {
        name: format!("robot {:#018x}", p.robot_id),
        serial: String::new(),
    });
    let joints = p.nominal.iter().zip(&p.limits);
    let links = p.masses.iter().flat_map(|m| m.mass.iter().zip(&m.com));
    Robot {
        path: path.to_owned(),
        name,
        serial,
        // As for a robot.toml that does not give it.
        sigma: from_mm(USUAL_SIGMA_MM),
        sigma_angle: None,
        gravity: p.masses.as_ref().map(|m| m.gravity),
        reference_temperature: p.reference_temperature,
        joints: joints
            .map(|(link, limits)| Joint {
                link: *link,
                limits: *limits,
                gear_ratio: None,
                prior: LinkPrior::default(),
            })
            .collect(),
        base: Placement::default(),
        tool: p.tool,
        tool_rpy: Vector3::zeros(),
        links: links.map(|(mass, com)| LinkMass { mass: *mass, com: *com }).collect(),
        payload: p.masses.as_ref().map_or_else(Vector3::zeros, |m| m.payload_com),
        warnings: Vec::new(),
    }
}

/// What a model has and a blob does not, a line each.
#[must_use]
pub fn not_carried(model: &Model, bytes: &[u8]) -> Vec<String> {
    let tagged = Blob::check(bytes).is_ok_and(|blob| blob.is_tagged());
    let sigma = format!("measurement_sigma_mm: {USUAL_SIGMA_MM} is assumed");
    let lines = [
        (
            model.robot_id.is_some(),
            "name and serial of the robot: its id is kept instead; --name and --serial give them back",
        ),
        (tagged, "the key of the authentication tag: give it to pack with --key"),
        (true, "tracker stations: `evaluate` needs --reregister base"),
        (true, "labels of the reflectors and reflectors beyond the first, which is the tool"),
        (true, "terms of the measurement (drift, re-mounted tool)"),
        (
            true,
            "[base] of the robot file: what is commanded is in the frame before joint 1, and \
             [base] is to be added again where the file had one",
        ),
        (
            true,
            "[tool] of the robot file: it is the target now that was identified, and not turned",
        ),
        (true, sigma.as_str()),
        (true, "gear ratios"),
        (model.robot.links.is_empty(), "link masses and gravity: this blob has none"),
        (model.covariance.is_none(), "uncertainties: this blob has no covariance"),
        (
            true,
            "which directions the data left open, and the provenance but for time and RMS errors",
        ),
    ];
    lines.into_iter().filter(|(applies, _)| *applies).map(|(_, line)| line.to_owned()).collect()
}
