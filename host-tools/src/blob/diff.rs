//! Two blobs side by side: which parameters moved, and the tool with them.

use nalgebra::{Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;
use truearm::effects::{Curve, Term};
use truearm::{Approach, Arm, ArmParameters, Curves, JointKind, LinkParameter, State};

use super::describe::{rms, term_columns};
use crate::error::{Error, Kind, Result};
use crate::model::ErrorCurve;
use crate::model::arm::with_joints;

/// Temperatures drawn: so far from the reference temperature, K.
const WARMTH: f64 = 10.0;
/// Range of a joint of which nothing is known, rad and m.
const UNKNOWN: [f64; 2] = [std::f64::consts::PI, 1.0];

/// The differences in words. The tool's motion is that over a seeded draw of
/// poses within the limits of the joints (where there are none, the ranges the
/// identification covered), each in a state of its own.
///
/// # Errors
/// A blob that a controller would refuse, or two of different joint counts.
pub fn diff(before: &[u8], after: &[u8], poses: usize, seed: u64) -> Result<String> {
    let check = |bytes, which| {
        Blob::check(bytes).map_err(|e| {
            Error::data(Kind::Refused, format!("the blob {which}: {e}"), "see `truearm inspect`")
        })
    };
    let (a, b) = (check(before, "before")?, check(after, "after")?);
    if a.joints() != b.joints() {
        return Err(Error::data(
            Kind::OtherArm,
            format!("{} joints before, {} after", a.joints(), b.joints()),
            "only blobs of the same arm can be compared",
        ));
    }
    let mut text = String::new();
    if a.robot_id() != b.robot_id() {
        text += &format!("different robots: {:#018x}, {:#018x}\n", a.robot_id(), b.robot_id());
    }
    if a.sequence() != b.sequence() {
        text += &format!("sequence {} -> {}\n", a.sequence(), b.sequence());
    }
    let content = |blob: &Blob, bytes: &[u8]| blob.content().map(|part| bytes[part].to_vec());
    if content(&a, before) == content(&b, after) {
        return Ok(text + "the parameters are the same\n");
    }
    if a.covariance().is_some() != b.covariance().is_some() {
        text += &format!("covariance {} -> {}\n", has(&a), has(&b));
    }
    with_joints!(a.joints(), N => {
        let fail = |e| Error::data(Kind::Refused, format!("{e}"), "see `truearm inspect`");
        let (a, b) = (a.parameters::<f64, N>().map_err(fail)?, b.parameters().map_err(fail)?);
        text += &parameters(&a, &b);
        text += &motion(&a, &b, poses, seed);
    });
    Ok(text)
}

fn has(blob: &Blob) -> &'static str {
    if blob.covariance().is_some() { "present" } else { "absent" }
}

/// Lines `name before -> after by`, only of what moved.
#[derive(Default)]
struct Moved {
    text: String,
    /// Moved, but less than the last decimal printed.
    little: usize,
}

/// Half of the last decimal printed.
const VISIBLE: f64 = 0.5e-6;

impl Moved {
    fn number(&mut self, name: &str, unit: &str, factor: f64, [a, b]: [f64; 2]) {
        let (a, b) = (a * factor, b * factor);
        if a != b && (b - a).abs() < VISIBLE {
            self.little += 1;
        } else if a != b {
            self.text += &format!("{name:30} {a:>13.6} -> {b:>13.6}  {:>+12.6} {unit}\n", b - a);
        }
    }

    fn vector(&mut self, name: &str, unit: &str, factor: f64, [a, b]: [&Vector3<f64>; 2]) {
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            self.number(&format!("{name} {axis}"), unit, factor, [a[k], b[k]]);
        }
    }

    fn text(&mut self, name: &str, [a, b]: [&str; 2]) {
        if a != b {
            self.text += &format!("{name:30} {a} -> {b}\n");
        }
    }
}

fn parameters<const N: usize>(a: &ArmParameters<f64, N>, b: &ArmParameters<f64, N>) -> String {
    let mut out = Moved::default();
    let degrees = 1_f64.to_degrees();
    out.vector("base translation", "mm", 1e3, [&a.base_translation, &b.base_translation]);
    out.vector("base rotation", "deg", degrees, [&a.base_rotation, &b.base_rotation]);
    out.vector("tool", "mm", 1e3, [&a.tool, &b.tool]);
    for i in 0..N {
        let joint = i + 1;
        let revolute = |p: &ArmParameters<f64, N>| p.nominal[i].kind == JointKind::Revolute;
        let kind = |p| if revolute(p) { "revolute" } else { "prismatic" };
        out.text(&format!("joint {joint} kind"), [kind(a), kind(b)]);
        let of = |p: &ArmParameters<f64, N>| {
            [p.nominal[i].parameters.to_array(), p.corrections[i].to_array()]
        };
        for (what, (x, y)) in
            ["nominal", "correction"].into_iter().zip(of(a).into_iter().zip(of(b)))
        {
            for (k, parameter) in LinkParameter::ALL.into_iter().enumerate() {
                let (unit, factor) =
                    if parameter.is_length() { ("mm", 1e3) } else { ("deg", degrees) };
                let name = format!("joint {joint} {what} {}", parameter.name());
                out.number(&name, unit, factor, [x[k], y[k]]);
            }
        }
        let factor = if revolute(a) { degrees } else { 1e3 };
        let range = |r: Option<[f64; 2]>| match r {
            Some([low, high]) => format!("{:.3}..{:.3}", low * factor, high * factor),
            None => "none".to_owned(),
        };
        let ranges =
            [("limits", a.limits[i], b.limits[i]), ("covered", a.covered[i], b.covered[i])];
        for (what, x, y) in ranges {
            out.text(&format!("joint {joint} {what}"), [&range(x), &range(y)]);
        }
    }
    match (&a.masses, &b.masses) {
        (Some(x), Some(y)) => {
            out.vector("gravity", "m/s^2", 1.0, [&x.gravity, &y.gravity]);
            out.vector("payload point", "mm", 1e3, [&x.payload_com, &y.payload_com]);
            for i in 0..N {
                out.number(&format!("link {} mass", i + 1), "kg", 1.0, [x.mass[i], y.mass[i]]);
                let name = format!("link {} centre of mass", i + 1);
                out.vector(&name, "mm", 1e3, [&x.com[i], &y.com[i]]);
            }
        }
        (x, y) => {
            let given = |given| if given { "given" } else { "none" };
            out.text("masses", [given(x.is_some()), given(y.is_some())]);
        }
    }
    let temperature = [a.reference_temperature, b.reference_temperature];
    out.number("reference temperature", "degrees C", 1.0, temperature);
    for (name, of) in [
        ("RMS error before, mm", [a.rms_before, b.rms_before]),
        ("RMS error after, mm", [a.rms_after, b.rms_after]),
    ] {
        let [a, b] = of.map(rms);
        out.text(name, [&a, &b]);
    }
    let orientation = |p: &ArmParameters<f64, N>| match p.orientation_identified {
        true => "identified",
        false => "nominal",
    };
    out.text("flange orientation", [orientation(a), orientation(b)]);
    let kinds = a.nominal.map(|link| link.kind);
    terms(&mut out.text, &a.terms, &b.terms, &kinds);
    curves(&mut out.text, [a.curves, b.curves]);
    if out.little > 0 {
        out.text += &format!("{} more moved by less than {VISIBLE:e} of these units\n", out.little);
    }
    if out.text.is_empty() {
        // The covariance alone has changed.
        out.text += "no parameter moved\n";
    }
    out.text
}

fn terms(out: &mut String, a: &[Term<f64>], b: &[Term<f64>], kinds: &[JointKind]) {
    let same = |x: &Term<f64>, y: &Term<f64>| {
        Term { coefficient: 0.0, ..*x } == Term { coefficient: 0.0, ..*y }
    };
    let name = |t: &Term<f64>| {
        let (joint, component, order) = term_columns(t, kinds);
        let words = [t.effect.name(), &joint, component, &order];
        words.into_iter().filter(|w| !w.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let mut found = vec![false; b.len()];
    for x in a {
        // The same term may stand there twice.
        match (0..b.len()).find(|k| !found[*k] && same(x, &b[*k])) {
            Some(k) => {
                found[k] = true;
                let (from, to) = (x.coefficient, b[k].coefficient);
                if from != to {
                    let by = to - from;
                    let (name, unit) = (name(x), x.unit(kinds));
                    *out += &format!("term {name}: {from:.6e} -> {to:.6e} ({by:+.3e}) {unit}\n");
                }
            }
            None => {
                let unit = x.unit(kinds);
                *out += &format!("term {}: gone, was {:.6e} {unit}\n", name(x), x.coefficient);
            }
        }
    }
    for (y, _) in b.iter().zip(found).filter(|(_, found)| !found) {
        let unit = y.unit(kinds);
        *out += &format!("term {}: new, {:.6e} {unit}\n", name(y), y.coefficient);
    }
}

/// By how much curves differ, wherever the joint stands.
fn curves(out: &mut String, both: [Curves<'_>; 2]) {
    for joint in 0..truearm::MAX_JOINTS as u8 {
        let [a, b] = both.map(|curves| curves.of_joint(joint));
        let name = format!("curve of joint {}", joint + 1);
        let told = |curve: Curve<'_>| {
            let of_model = ErrorCurve::of_blob(&curve);
            let [most, _] = of_model.size();
            let band = of_model.band() * 1e3;
            format!(
                "{} nodes, up to {:.4} mrad, band {band:.4} mrad",
                curve.nodes().len(),
                most * 1e3
            )
        };
        *out += &match (a, b) {
            (Some(a), Some(b)) if a != b => {
                let off = |k: u32| {
                    let q = f64::from(k) * std::f64::consts::TAU / 4096.0;
                    (a.at::<f64>(q) - b.at::<f64>(q)).abs()
                };
                let most = (0..4096).map(off).fold(0.0, f64::max) * 1e3;
                format!("{name}: {} -> {}, {most:.4} mrad apart at most\n", told(a), told(b))
            }
            (Some(a), None) => format!("{name}: gone, had {}\n", told(a)),
            (None, Some(b)) => format!("{name}: new, {}\n", told(b)),
            _ => String::new(),
        };
    }
}

fn motion<const N: usize>(
    a: &ArmParameters<f64, N>,
    b: &ArmParameters<f64, N>,
    poses: usize,
    seed: u64,
) -> String {
    let limits = core::array::from_fn(|i| {
        let unknown = UNKNOWN[usize::from(a.nominal[i].kind == JointKind::Prismatic)];
        a.limits[i].or(a.covered[i]).unwrap_or([-unknown, unknown])
    });
    let common = |i: usize| {
        let ([low, high], [l, h]) = (a.covered[i]?, b.covered[i]?);
        let both = [low.max(l), high.min(h)];
        (both[0] <= both[1]).then_some(both)
    };
    let covered: Vec<_> = (0..N).filter_map(common).collect();
    let mut text =
        "\n".to_owned() + &farthest(a, b, poses, seed, "within the joint limits", limits);
    text += &match covered.try_into() {
        Ok(covered) => {
            farthest(a, b, poses, seed, "within what both identifications covered", covered)
        }
        Err(_) => "no pose lies within what both identifications covered\n".to_owned(),
    };
    text + &format!(
        "(poses drawn with seed {seed}, approach directions drawn, temperature within {WARMTH} K of the\n\
         reference, no payload, each blob with its own tool point)\n"
    )
}

fn farthest<const N: usize>(
    a: &ArmParameters<f64, N>,
    b: &ArmParameters<f64, N>,
    poses: usize,
    seed: u64,
    region: &str,
    ranges: [[f64; 2]; N],
) -> String {
    let arms = [Arm::new(a), Arm::new(b)];
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut worst, mut square, mut turn) = (None, 0.0, 0.0_f64);
    for _ in 0..poses {
        let q = ranges.map(|[low, high]| rng.random_range(low..=high));
        let state = State {
            approach: [(); N]
                .map(|()| if rng.random() { Approach::Positive } else { Approach::Negative }),
            payload: 0.0,
            temperature: a.reference_temperature + rng.random_range(-WARMTH..=WARMTH),
        };
        let [x, y] = arms.each_ref().map(|arm| arm.real_pose_in(&q, &state));
        let by = y.translation - x.translation;
        square += by.norm_squared();
        let rotation = Rotation3::from_matrix_unchecked(x.rotation.transpose() * y.rotation);
        turn = turn.max(rotation.angle());
        if worst.is_none_or(|(most, _): (Vector3<f64>, _)| by.norm() > most.norm()) {
            worst = Some((by, q));
        }
    }
    let Some((by, q)) = worst else { return String::new() };
    let shown = q.iter().zip(&a.nominal).map(|(q, link)| match link.kind {
        JointKind::Revolute => format!("{:.2} deg", q.to_degrees()),
        JointKind::Prismatic => format!("{:.2} mm", q * 1e3),
    });
    format!(
        "{region}, {poses} poses: the tool moves by {:.4} mm at worst, {:.4} mm RMS, its frame turns by\n\
         {:.5} deg at worst; worst pose {}: by {:.4} {:.4} {:.4} mm\n",
        by.norm() * 1e3,
        (square / poses as f64).sqrt() * 1e3,
        turn.to_degrees(),
        shown.collect::<Vec<_>>().join(", "),
        by.x * 1e3,
        by.y * 1e3,
        by.z * 1e3
    )
}
