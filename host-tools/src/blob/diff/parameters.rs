//! What moved, parameter by parameter.

use truearm::{JointKind, LinkParameter};
use truearm_sized::{LinkMasses, Parameters};

use super::beyond::{curves, terms};
use super::moved::{Moved, VISIBLE};
use super::rms;
use crate::units::{DEGREES, link_unit};

/// What moved between two blobs, as lines and for a report.
pub(super) fn parameters(out: &mut Moved, a: &Parameters, b: &Parameters) {
    let before = out.text.len();
    out.vector("base translation", "mm", 1e3, [&a.base_translation, &b.base_translation]);
    out.vector("base rotation", "deg", DEGREES, [&a.base_rotation, &b.base_rotation]);
    out.vector("tool", "mm", 1e3, [&a.tool, &b.tool]);
    (0..a.nominal.len()).for_each(|i| joint(out, i, [a, b]));
    masses(out, [&a.masses, &b.masses]);
    let temperature = [a.reference_temperature, b.reference_temperature];
    out.number("reference temperature", "degrees C", 1.0, temperature);
    for (name, of) in [
        ("RMS error before, mm", [a.rms_before, b.rms_before]),
        ("RMS error after, mm", [a.rms_after, b.rms_after]),
    ] {
        let [a, b] = of.map(rms);
        out.text(name, [&a, &b]);
    }
    let orientation = |p: &Parameters| match p.orientation_identified {
        true => "identified",
        false => "nominal",
    };
    out.text("flange orientation", [orientation(a), orientation(b)]);
    let kinds = a.kinds();
    terms(out, &a.terms, &b.terms, &kinds);
    curves(out, [a.curves, b.curves]);
    if out.little > 0 {
        out.text += &format!("{} more moved by less than {VISIBLE:e} of these units\n", out.little);
    }
    if out.text.len() == before {
        // The covariance alone has changed.
        out.text += "no parameter moved\n";
    }
}

/// Kind, parameters and ranges of a joint.
fn joint(out: &mut Moved, i: usize, both: [&Parameters; 2]) {
    let joint = i + 1;
    let revolute = |p: &Parameters| p.nominal[i].kind == JointKind::Revolute;
    let kinds = both.map(|p| if revolute(p) { "revolute" } else { "prismatic" });
    out.text(&format!("joint {joint} kind"), kinds);
    let nominal = both.map(|p| p.nominal[i].parameters.to_array());
    let corrections = both.map(|p| p.corrections[i].to_array());
    for (what, [x, y]) in [("nominal", nominal), ("correction", corrections)] {
        for (k, parameter) in LinkParameter::ALL.into_iter().enumerate() {
            let (unit, factor) = link_unit(parameter);
            let name = format!("joint {joint} {what} {}", parameter.name());
            out.number(&name, unit, factor, [x[k], y[k]]);
        }
    }
    let factor = if revolute(both[0]) { DEGREES } else { 1e3 };
    let range = |r: Option<[f64; 2]>| match r {
        Some([low, high]) => format!("{:.3}..{:.3}", low * factor, high * factor),
        None => "none".to_owned(),
    };
    let ranges = [("limits", both.map(|p| p.limits[i])), ("covered", both.map(|p| p.covered[i]))];
    for (what, of) in ranges {
        let [x, y] = of.map(range);
        out.text(&format!("joint {joint} {what}"), [&x, &y]);
    }
}

fn masses(out: &mut Moved, both: [&Option<LinkMasses>; 2]) {
    let [Some(x), Some(y)] = both else {
        out.text("masses", both.map(|masses| if masses.is_some() { "given" } else { "none" }));
        return;
    };
    out.vector("gravity", "m/s^2", 1.0, [&x.gravity, &y.gravity]);
    out.vector("payload point", "mm", 1e3, [&x.payload_com, &y.payload_com]);
    for i in 0..x.mass.len() {
        out.number(&format!("link {} mass", i + 1), "kg", 1.0, [x.mass[i], y.mass[i]]);
        let name = format!("link {} centre of mass", i + 1);
        out.vector(&name, "mm", 1e3, [&x.com[i], &y.com[i]]);
    }
}
