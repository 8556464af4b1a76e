//! From a model to the bytes a controller reads.

use nalgebra::Vector3;
use truearm::Curves;
use truearm::blob::{self, DecodeError, EncodeError, Flaw, Key, Record};
use truearm::effects::{MAX_TERMS, Order, Term};
use truearm_sized::{LinkMasses, Parameters};

use crate::error::{Error, ErrorKind, Result};
use crate::model::{JointTables, Model, ModelTerm, Placement, Robot};

/// What the user may choose.
#[derive(Debug, Clone, Copy, Default)]
pub struct PackOptions {
    /// Sequence number; that of the model, by default its creation time in
    /// Unix seconds, if not given.
    pub sequence: Option<u32>,
    /// With the covariance, for the uncertainty of the tool point.
    pub covariance: bool,
    /// With an authentication tag under this key.
    pub key: Option<Key>,
}

/// The blob of a model, without covariance and tag.
///
/// # Errors
/// As for [`pack_with`].
pub fn pack(model: &Model, sequence: Option<u32>) -> Result<Vec<u8>> {
    pack_with(model, &PackOptions { sequence, ..PackOptions::default() })
}

/// The blob of a model.
///
/// # Errors
/// A tool that is one of several markers or that the measurements left open, more terms than a
/// controller takes, a creation time that cannot be read, a
/// covariance that is missing or of another model, or a value that a controller
/// would refuse, by name.
pub fn pack_with(model: &Model, options: &PackOptions) -> Result<Vec<u8>> {
    model.clear_tool()?;
    model.told_tool()?;
    let (sequence, created) = match (options.sequence.or(model.provenance.sequence), created(model))
    {
        (Some(number), created) => (number, created.unwrap_or(0)),
        (None, created) => {
            let created = created?;
            (created, created)
        }
    };
    let terms: Vec<_> = arm_terms(model).collect();
    let terms = heapless::Vec::from_slice(&terms).map_err(|_| {
        Error::data(
            ErrorKind::TooManyTerms,
            format!(
                "{}: {} terms of the arm where a controller takes {MAX_TERMS}",
                model.robot.path.display(),
                terms.len()
            ),
            "`truearm diagnose --most-terms 24` gives the best model of that size",
        )
    })?;
    let joints = model.robot.joints.len();
    let factor = if options.covariance { Some(factor(model, terms.len())?) } else { None };
    let numbers = factor.map_or(0, <[f32]>::len);
    let tables = JointTables::new(&model.curves);
    let curves = tables.curves();
    let size = blob::encoded_len(joints, terms.len()) + 4 * numbers + curves.as_bytes().len();
    let mut bytes = vec![0; size + blob::TAG];
    let written = parameters(model, terms, curves, [sequence, created]).encode(factor, &mut bytes);
    let written = written.and_then(|size| match &options.key {
        Some(key) => blob::sign(&mut bytes, key),
        None => Ok(size),
    });
    let size = written.map_err(|e| {
        let help = match e {
            EncodeError::Refused(DecodeError::Field(_, Flaw::NeedsMasses)) => {
                "give gravity_m_s2 and [[links]] in robot.toml and identify again"
            }
            EncodeError::Refused(DecodeError::Field(name, _))
                if matches!(name.record, Record::Term(_)) =>
            {
                "the layout in src/blob/FORMAT.md says what a term may be; leave this one out"
            }
            EncodeError::LastSequence => "give a lower --sequence",
            _ => "corrections of this size point to a wrong nominal geometry or a wrong unit",
        };
        Error::data(ErrorKind::Refused, format!("{}: {e}", model.robot.path.display()), help)
    })?;
    bytes.truncate(size);
    Ok(bytes)
}

/// The model's covariance, if it is one of so many terms.
fn factor(model: &Model, terms: usize) -> Result<&[f32]> {
    let path = model.robot.path.display();
    if model.changed {
        return Err(Error::data(
            ErrorKind::NoCovariance,
            format!("{path}: [covariance] is not that of these corrections and terms"),
            "they were changed by hand: identify again, or pack without --covariance",
        ));
    }
    let factor = model.covariance.as_deref().ok_or_else(|| {
        Error::data(
            ErrorKind::NoCovariance,
            format!("{path}: no [covariance]"),
            "identify again with this version, or pack without --covariance",
        )
    })?;
    let needed = blob::factor_len(model.robot.joints.len(), terms);
    if factor.len() != needed {
        return Err(Error::data(
            ErrorKind::NoCovariance,
            format!(
                "{path}: [covariance] has {} numbers where joints and terms need {needed}",
                factor.len()
            ),
            "terms were changed by hand: identify again, or pack without --covariance",
        ));
    }
    Ok(factor)
}

/// The terms that belong to the arm, in the order of the blob.
pub(crate) fn arm_terms(model: &Model) -> impl Iterator<Item = Term<f64>> {
    model.terms.iter().filter_map(|term| match term {
        ModelTerm::Arm(term) => Some(*term),
        _ => None,
    })
}

/// What the blob does not hold as the model has it, a line each: terms of the
/// measurement, an accuracy that is not the model's, and orders that the blob's
/// steps change.
#[must_use]
pub fn notes(model: &Model) -> Vec<String> {
    let mut out = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    for term in model.terms.iter().filter(|term| !matches!(term, ModelTerm::Arm(_))) {
        if !names.contains(&term.effect_name()) {
            names.push(term.effect_name());
        }
    }
    if !names.is_empty() {
        out.push(format!("left out, of the measurement and not of the arm: {}", names.join(", ")));
    }
    if model.robot.base != Placement::default() {
        out.push(
            "[base] stays on the host: the controller's commanded frame is the one before joint 1"
                .to_owned(),
        );
    }
    if model.robot.tool_rpy != Vector3::zeros() {
        out.push(
            "[tool] rpy_deg stays on the host: the controller is given its tool `with_tool`"
                .to_owned(),
        );
    }
    if masses(&model.robot).is_none() && arm_terms(model).any(|term| term.needs_torque()) {
        out.push(format!(
            "no masses: the controller has to read torques, State::torque, {}, and refuses to \
             compensate without",
            match model.robot.gravity {
                Some(_) => "what gravity pulls each joint by, the opposite of what it holds",
                None =>
                    "the opposite of the columns torque1_nm.. that the model was identified from",
            }
        ));
    }
    if model.changed {
        out.push(
            "warning: joints, corrections, terms or frame were changed since the identification: \
             the accuracy is not known, and the blob says so; `truearm evaluate` measures it"
                .to_owned(),
        );
    }
    out.extend(rounded(model));
    out
}

/// Orders, time constants and frictions that the blob's steps change.
fn rounded(model: &Model) -> Vec<String> {
    let mut out = Vec::new();
    for (i, term) in arm_terms(model).enumerate() {
        let order = term.effect.order();
        let what = match order {
            Order::TimeConstant => "time constant",
            order if order.is_cycles() => "order",
            _ => "friction",
        };
        let step = order.step(term.order);
        let rounded = (term.order / step).round() * step;
        // What was written as the nearest number to one that a blob holds is that one.
        if (rounded - term.order).abs() > 1e-9 * term.order {
            out.push(format!(
                "warning: {what} of term {} ({}) rounded from {} to {rounded}",
                i + 1,
                match term.own_joint() {
                    Some(joint) => format!("{} of joint {}", term.effect.name(), joint + 1),
                    None => term.effect.name().to_owned(),
                },
                term.order
            ));
        }
    }
    out
}

fn created(model: &Model) -> Result<u32> {
    let text = &model.provenance.created;
    let seconds = humantime::parse_rfc3339_weak(text)
        .ok()
        .and_then(|t| t.duration_since(std::time::UNIX_EPOCH).ok())
        .and_then(|d| u32::try_from(d.as_secs()).ok());
    seconds.ok_or_else(|| {
        Error::data(
            ErrorKind::Refused,
            format!("{}: creation time \"{text}\"", model.robot.path.display()),
            "give a sequence number with --sequence",
        )
    })
}

fn masses(robot: &Robot) -> Option<LinkMasses> {
    let gravity = robot.gravity.filter(|_| robot.links.len() == robot.joints.len())?;
    Some(LinkMasses {
        gravity,
        mass: robot.links.iter().map(|l| l.mass).collect(),
        com: robot.links.iter().map(|l| l.com).collect(),
        payload_com: robot.payload,
    })
}

/// What a controller has to know of a model's arm, before any rounding.
pub(crate) fn parameters<'t>(
    model: &Model,
    terms: heapless::Vec<Term<f64>, MAX_TERMS>,
    curves: Curves<'t>,
    [sequence, created]: [u32; 2],
) -> Parameters<'t> {
    let robot = &model.robot;
    Parameters {
        robot_id: model.robot_id.unwrap_or_else(|| blob::robot_id(&robot.name, &robot.serial)),
        sequence,
        created,
        nominal: robot.joints.iter().map(|j| j.link).collect(),
        corrections: model.corrections.clone(),
        base_translation: model.frame_translation,
        base_rotation: model.frame_rotation,
        // The marker is where the tracker's target sat; the tool of the robot
        // file is only where it was meant to be.
        tool: model.tool(),
        terms,
        curves,
        masses: masses(robot),
        reference_temperature: robot.reference_temperature,
        limits: robot.joints.iter().map(|j| j.limits).collect(),
        covered: model.covered.clone(),
        rms_before: model.provenance.nominal_rms_mm * 1e-3,
        // 0: not known.
        rms_after: if model.changed { 0.0 } else { model.provenance.cross_validated_rms_mm * 1e-3 },
        orientation_identified: model.orientation_identified,
    }
}
