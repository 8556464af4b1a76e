//! What an alternative says otherwise, in words.

use truearm::effects::Effect::ThermalExpansion;

use crate::diagnose::{Alternative, Effect};
use crate::effects::OUTLIERS;
use crate::model::CURVE;
use crate::units::duration;

/// An effect at its joints.
type Placed = (&'static str, Vec<usize>);

/// What an alternative has that the model of these effects has not, in place of what:
/// `joint-compliance of joint 2 instead of base-compliance`.
#[must_use]
pub fn instead(alternative: &[Placed], effects: &[Effect]) -> String {
    let own = placed(effects);
    let words = |has: &[Placed], not: &[Placed]| {
        let more = has.iter().filter(|e| !not.contains(e)).map(|(n, j)| place(n, j));
        let mut names: Vec<String> = more.collect();
        names.dedup();
        if names.is_empty() { "nothing".to_owned() } else { names.join(" and ") }
    };
    format!("{} instead of {}", words(alternative, &own), words(&own, alternative))
}

/// What an alternative says otherwise: other effects, or the same ones at once and not late.
#[must_use]
pub fn otherwise(alternative: &Alternative, effects: &[Effect]) -> String {
    if alternative.is_told_by_poses() {
        return instead(&alternative.effects, effects);
    }
    let said = |tau: Option<f64>| match tau {
        Some(tau) => format!("{} late", duration(tau)),
        None => "at once".to_owned(),
    };
    let own = effects.iter().find_map(|e| e.time_constant_s);
    format!(
        "{} {} instead of {}",
        ThermalExpansion.name(),
        said(alternative.time_constant_s),
        said(own)
    )
}

/// How late an arm follows its temperature: `with the temperature as it was, 25 min late
/// (+- 2 min)`; none where it does at once.
#[must_use]
pub fn late(e: &Effect) -> Option<String> {
    let tau = e.time_constant_s?;
    let sure =
        e.time_constant_sigma_s.map_or(String::new(), |sigma| format!(" (+- {})", duration(sigma)));
    Some(format!("with the temperature as it was, {} late{sure}", duration(tau)))
}

/// What a model names, as alternatives name it: a joint each, but for couplings.
fn placed(effects: &[Effect]) -> Vec<Placed> {
    let mut own: Vec<Placed> = Vec::new();
    for e in effects.iter().filter(|e| e.name != OUTLIERS && e.name != CURVE) {
        match e.joints.len() {
            0 | 1 => own.push((e.name, e.joints.clone())),
            _ if coupled(e.name) => own.push((e.name, e.joints.clone())),
            _ => own.extend(e.joints.iter().map(|j| (e.name, vec![*j]))),
        }
    }
    own
}

fn coupled(name: &str) -> bool {
    truearm::effects::Effect::from_name(name).is_some_and(truearm::effects::Effect::is_coupled)
}

/// An effect and its joints, counted from 1.
#[must_use]
pub fn place(name: &str, joints: &[usize]) -> String {
    let list: Vec<String> = joints.iter().map(usize::to_string).collect();
    match (name, joints.len()) {
        (_, 0) => name.to_owned(),
        _ if coupled(name) && joints.len() == 2 => {
            format!("{name} from joint {} to {}", list[0], list[1])
        }
        (_, 1) => format!("{name} of joint {}", list[0]),
        _ => format!("{name} of joints {}", list.join(", ")),
    }
}
