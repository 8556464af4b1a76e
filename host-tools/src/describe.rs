//! A blob in words, for `truearm inspect`.

use nalgebra::Vector3;
use truearm::blob::{self, Blob};
use truearm::effects::{Effect, Term};
use truearm::{ArmParameters, JointKind};

use crate::chain::with_joints;

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
         RMS error mm          {:.4} before, {:.4} after (cross-validated)\n\
         reference temp. C     {:.2}\n\
         {}\n\
         joint     alpha deg       a mm  theta deg       d mm   beta deg   limits          covered\n",
        p.robot_id,
        p.sequence,
        humantime::format_rfc3339_seconds(when),
        vector(&p.base_translation, 1e3),
        vector(&p.base_rotation, 1_f64.to_degrees()),
        vector(&p.tool, 1e3),
        p.rms_before * 1e3,
        p.rms_after * 1e3,
        p.reference_temperature,
        match &p.masses {
            None => "masses                not given\n".to_owned(),
            Some(m) => format!(
                "gravity m/s^2         {}\npayload point mm      {}\n",
                vector(&m.gravity, 1.0),
                vector(&m.payload_com, 1e3)
            ),
        }
    );
    for i in 0..N {
        let revolute = p.nominal[i].kind == JointKind::Revolute;
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
    text +=
        "\nRows marked + are the identified corrections, added to the nominal values above them.\n";
    if let Some(m) = &p.masses {
        text += "\nlink     mass kg   centre of mass mm\n";
        for (i, (mass, com)) in m.mass.iter().zip(&m.com).enumerate() {
            text += &format!("{:<4} {:>11.4}   {}\n", i + 1, shown(*mass), vector(com, 1e3));
        }
    }
    if !p.terms.is_empty() {
        text += "\nterm  effect                   joint  component     order    coefficient (SI)\n";
    }
    for (i, t) in p.terms.iter().enumerate() {
        let (joint, component, order) = term_columns(t);
        let (name, coefficient) = (t.effect.name(), t.coefficient);
        let line = format!(
            "{:<5} {name:24} {joint:6} {component:10} {order:>8} {coefficient:>16.6e}",
            i + 1
        );
        text += &line;
        text.push('\n');
    }
    text
}

/// Joint, component and order of a term as a reader of reports knows them.
fn term_columns(term: &Term<f64>) -> (String, &'static str, String) {
    let number = |joint: u8| (u16::from(joint) + 1).to_string();
    let joint = match term.effect {
        Effect::BaseCompliance => "base".to_owned(),
        Effect::ThermalExpansion if term.joint == Term::<f64>::ALL => "all".to_owned(),
        Effect::JointCoupling => format!("{}>{}", number(term.source), number(term.joint)),
        _ => number(term.joint),
    };
    let second = term.component != 0;
    let component = match term.effect {
        Effect::BaseCompliance => ["x", "y"][usize::from(second)],
        effect if effect.is_periodic() => ["cos", "sin"][usize::from(second)],
        _ => "",
    };
    let order = match term.effect {
        Effect::Backlash if term.order > 0.0 => format!("{} N m", term.order),
        effect if effect.is_periodic() => term.order.to_string(),
        _ => String::new(),
    };
    (joint, component, order)
}

/// Four decimals without a minus zero.
fn shown(x: f64) -> f64 {
    (x * 1e4).round() / 1e4 + 0.0
}
