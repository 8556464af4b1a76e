//! From a model to the bytes a controller reads.

use nalgebra::Vector3;
use truearm::ArmParameters;
use truearm::blob::{self, Blob};

use crate::chain::{fixed, with_joints};
use crate::error::{Error, Result};
use crate::files::Model;

/// The blob of a model. The sequence number is the model's creation time in
/// Unix seconds unless given.
///
/// # Errors
/// A creation time that cannot be read, or a value that a controller would
/// refuse, by name.
pub fn pack(model: &Model, sequence: Option<u32>) -> Result<Vec<u8>> {
    let sequence = match sequence {
        Some(number) => number,
        None => created(model)?,
    };
    let mut bytes = vec![0; blob::encoded_len(model.robot.joints.len())];
    let written = with_joints!(model.robot.joints.len(), N => {
        blob::encode(&parameters::<N>(model, sequence), &mut bytes)
    });
    written.map_err(|e| {
        Error::data(
            format!("{}: {e}", model.robot.path.display()),
            "corrections of this size point to a wrong nominal geometry or a wrong unit",
        )
    })?;
    Ok(bytes)
}

fn created(model: &Model) -> Result<u32> {
    let text = &model.provenance.created;
    let seconds = humantime::parse_rfc3339_weak(text)
        .ok()
        .and_then(|t| t.duration_since(std::time::UNIX_EPOCH).ok())
        .and_then(|d| u32::try_from(d.as_secs()).ok());
    seconds.ok_or_else(|| {
        Error::data(
            format!("{}: creation time \"{text}\"", model.robot.path.display()),
            "give a sequence number with --sequence",
        )
    })
}

fn parameters<const N: usize>(model: &Model, sequence: u32) -> ArmParameters<f64, N> {
    let robot = &model.robot;
    let joints: [_; N] = fixed(&robot.joints);
    let covered: [_; N] = fixed(&model.covered);
    ArmParameters {
        robot_id: blob::robot_id(&robot.name, &robot.serial),
        sequence,
        nominal: joints.map(|j| j.link),
        corrections: fixed(&model.corrections),
        base_translation: model.frame_translation,
        base_rotation: model.frame_rotation,
        // The marker is where the tracker's target sat; the tool of the robot
        // file is only where it was meant to be.
        tool: model.markers.first().map_or_else(Vector3::zeros, |m| m.1),
        limits: joints.map(|j| j.limits),
        covered: covered.map(Some),
        rms_before: model.provenance.nominal_rms_mm * 1e-3,
        rms_after: model.provenance.cross_validated_rms_mm * 1e-3,
        // Points say nothing of how the flange is turned about them.
        orientation_identified: false,
    }
}

/// A blob in words, every field with its unit.
///
/// # Errors
/// Why a controller would refuse it.
pub fn describe(bytes: &[u8]) -> std::result::Result<String, blob::DecodeError> {
    let blob = Blob::check(bytes)?;
    let mut text = format!(
        "truearm parameter blob, layout {}, {} bytes, checksum good\n",
        blob::LAYOUT,
        blob.size()
    );
    if bytes.len() > blob.size() {
        text += &format!("{} bytes behind the blob are ignored\n", bytes.len() - blob.size());
    }
    with_joints!(blob.joints(), N => text += &fields(&blob.parameters::<f64, N>()?));
    Ok(text)
}

fn fields<const N: usize>(p: &ArmParameters<f64, N>) -> String {
    let when = std::time::UNIX_EPOCH + std::time::Duration::from_secs(u64::from(p.sequence));
    let vector = |v: &Vector3<f64>, factor: f64| {
        let [x, y, z] = [v.x, v.y, v.z].map(|x| shown(x * factor));
        format!("{x:.4} {y:.4} {z:.4}")
    };
    let orientation =
        if p.orientation_identified { "identified" } else { "not identified (nominal)" };
    let mut text = format!(
        "robot id              {:#018x}\n\
         sequence              {} ({} if it is a time)\n\
         base translation mm   {}\n\
         base rotation deg     {}\n\
         tool mm               {}\n\
         flange orientation    {orientation}\n\
         RMS error mm          {:.4} before, {:.4} after (cross-validated)\n\n\
         joint     alpha deg       a mm  theta deg       d mm   beta deg   limits          covered\n",
        p.robot_id,
        p.sequence,
        humantime::format_rfc3339_seconds(when),
        vector(&p.base_translation, 1e3),
        vector(&p.base_rotation, 1_f64.to_degrees()),
        vector(&p.tool, 1e3),
        p.rms_before * 1e3,
        p.rms_after * 1e3,
    );
    for i in 0..N {
        let revolute = p.nominal[i].kind == truearm::JointKind::Revolute;
        let factor = if revolute { 1_f64.to_degrees() } else { 1e3 };
        let range = |r: &Option<[f64; 2]>| match r {
            Some([low, high]) => format!("{:.1}..{:.1}", low * factor, high * factor),
            None => "-".to_owned(),
        };
        for (what, q) in [("", p.nominal[i].parameters), ("+", p.corrections[i])] {
            let name = if what.is_empty() {
                format!("{} {}", i + 1, if revolute { "rot" } else { "lin" })
            } else {
                "      +".to_owned()
            };
            text += &format!(
                "{name:7} {:>10.4} {:>10.4} {:>10.4} {:>10.4} {:>10.4}",
                shown(q.alpha.to_degrees()),
                shown(q.a * 1e3),
                shown(q.theta.to_degrees()),
                shown(q.d * 1e3),
                shown(q.beta.to_degrees()),
            );
            if what.is_empty() {
                text += &format!("   {:15} {}", range(&p.limits[i]), range(&p.covered[i]));
            }
            text.push('\n');
        }
    }
    text + "\nRows marked + are the identified corrections, added to the nominal values above them.\n"
}

/// Four decimals without a minus zero.
fn shown(x: f64) -> f64 {
    (x * 1e4).round() / 1e4 + 0.0
}
