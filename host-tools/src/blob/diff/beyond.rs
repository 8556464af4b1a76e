//! What moved beyond geometry: terms and curves.

use truearm::effects::{Curve, Term};
use truearm::{Curves, JointKind};

use super::moved::Moved;
use super::{Told, term_columns};
use crate::blob::describe::gaps_in_words;
use crate::model::ErrorCurve;

/// Terms that came, went or changed.
pub(super) fn terms(out: &mut Moved, a: &[Term<f64>], b: &[Term<f64>], kinds: &[JointKind]) {
    let same = |x: &Term<f64>, y: &Term<f64>| {
        Term { coefficient: 0.0, ..*x } == Term { coefficient: 0.0, ..*y }
    };
    let name = |t: &Term<f64>| {
        let (joint, component, order) = term_columns(t, kinds);
        let words = ["term", t.effect.name(), &joint, component, &order];
        words.into_iter().filter(|w| !w.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let number = |x: f64| Some(Told::Number(x));
    let mut found = vec![false; b.len()];
    for x in a {
        let (name, unit, from) = (name(x), x.unit(kinds), x.coefficient);
        // The same term may stand there twice.
        match (0..b.len()).find(|k| !found[*k] && same(x, &b[*k])) {
            Some(k) => {
                found[k] = true;
                let to = b[k].coefficient;
                if from != to {
                    let by = to - from;
                    out.text += &format!("{name}: {from:.6e} -> {to:.6e} ({by:+.3e}) {unit}\n");
                    out.change(&name, unit, [number(from), number(to)]);
                }
            }
            None => {
                out.text += &format!("{name}: gone, was {from:.6e} {unit}\n");
                out.change(&name, unit, [number(from), None]);
            }
        }
    }
    for (y, _) in b.iter().zip(found).filter(|(_, found)| !found) {
        let (name, unit) = (name(y), y.unit(kinds));
        out.text += &format!("{name}: new, {:.6e} {unit}\n", y.coefficient);
        out.change(&name, unit, [None, number(y.coefficient)]);
    }
}

/// By how much curves differ, wherever the joint stands.
pub(super) fn curves(out: &mut Moved, both: [Curves<'_>; 2]) {
    for joint in 0..truearm::MAX_JOINTS as u8 {
        let [a, b] = both.map(|curves| curves.of_joint(joint));
        let name = format!("curve of joint {}", joint + 1);
        let told = |curve: &Curve<'_>| {
            let of_model = ErrorCurve::of_blob(curve);
            let [most, _] = of_model.size();
            let band = of_model.band() * 1e3;
            let gaps =
                gaps_in_words(&of_model).map_or_else(String::new, |gaps| format!(", {gaps}"));
            format!(
                "{} nodes, up to {:.4} mrad, band {band:.4} mrad{gaps}",
                curve.nodes().len(),
                most * 1e3
            )
        };
        let words = [&a, &b].map(|curve| curve.as_ref().map(told));
        out.text += &match (&a, &b, &words) {
            (Some(a), Some(b), [Some(before), Some(after)]) if a != b => {
                let off = |k: u32| {
                    let q = f64::from(k) * std::f64::consts::TAU / 4096.0;
                    (a.at::<f64>(q) - b.at::<f64>(q)).abs()
                };
                let most = (0..4096).map(off).fold(0.0, f64::max) * 1e3;
                format!("{name}: {before} -> {after}, {most:.4} mrad apart at most\n")
            }
            (_, _, [Some(before), None]) => format!("{name}: gone, had {before}\n"),
            (_, _, [None, Some(after)]) => format!("{name}: new, {after}\n"),
            _ => continue,
        };
        out.change(&name, "", words.map(|words| words.map(Told::Text)));
    }
}
