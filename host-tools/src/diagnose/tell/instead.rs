//! What an alternative says otherwise, in words.

use crate::diagnose::Effect;
use crate::effects::OUTLIERS;
use crate::model::CURVE;

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
