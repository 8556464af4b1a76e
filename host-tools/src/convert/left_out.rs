//! How much of an identified arm is lost where only its geometry is carried.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::effects::Term;
use truearm::{Approach, Pose};

use super::reach::{POSES, ranges};
use crate::model::arm::{ArmMasses, RowInputs, chain};
use crate::model::{CURVE, JointTables, Model, ModelTerm};

/// Temperatures drawn: so far from the reference temperature, K.
pub const WARMTH: f64 = 10.0;

/// What terms of one effect at the same joints move.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// Name of the effect.
    pub effect: &'static str,
    /// Its joints, counted from 1.
    pub joints: Vec<usize>,
    /// How far it moves the tool point, root mean square, m.
    pub rms: f64,
    /// And at most, m.
    pub largest: f64,
}

/// What each effect of the arm moves over seeded poses within the covered joint
/// ranges (the limits where nothing is known of them, else a turn or a metre),
/// arrival directions drawn, temperature within `WARMTH`, no payload. The last
/// entry, with an empty name, is of all together. Empty without terms.
#[must_use]
pub fn left_out(model: &Model) -> Vec<LeftOut> {
    let mut groups = groups(model);
    if groups.is_empty() && model.curves.is_empty() {
        return Vec::new();
    }
    if !model.curves.is_empty() {
        let joints = model.curves.iter().map(|curve| usize::from(curve.joint()) + 1);
        groups.push((CURVE, joints.collect(), Vec::new()));
    }
    let tool = model.tool();
    let arm = chain(&model.links(), Pose::identity(), tool);
    let states = states(model);
    let size = |(effect, joints, terms): &Group| {
        let curved = *effect == CURVE || effect.is_empty();
        let moved = states.iter().map(|(q, inputs)| {
            let bare = RowInputs { curves: Vec::new(), ..inputs.clone() };
            let inputs = if curved { inputs } else { &bare };
            (arm.bent(q, terms, inputs).translation - arm.pose(q).translation).norm()
        });
        let moved: Vec<f64> = moved.collect();
        LeftOut {
            effect,
            joints: joints.clone(),
            rms: (moved.iter().map(|m| m * m).sum::<f64>() / moved.len() as f64).sqrt(),
            largest: moved.iter().fold(0.0, |most, m| m.max(most)),
        }
    };
    let all = groups.iter().flat_map(|(_, _, terms)| terms.clone()).collect();
    let all: Group = ("", Vec::new(), all);
    groups.iter().chain(std::iter::once(&all)).map(size).collect()
}

/// Effect, joints, terms.
type Group = (&'static str, Vec<usize>, Vec<Term<f64>>);

fn groups(model: &Model) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for term in &model.terms {
        let ModelTerm::Arm(arm_term) = term else { continue };
        let (effect, joints) = (term.effect_name(), term.joints());
        match groups.iter_mut().find(|(e, j, _)| *e == effect && *j == joints) {
            Some((_, _, terms)) => terms.push(*arm_term),
            None => groups.push((effect, joints, vec![*arm_term])),
        }
    }
    groups
}

/// Joint values and what terms depend on there.
fn states(model: &Model) -> Vec<(Vec<f64>, RowInputs)> {
    let robot = &model.robot;
    let unloaded = chain(&model.links(), Pose::identity(), Vector3::zeros());
    let masses = robot.gravity.filter(|_| !robot.links.is_empty()).map(|gravity| ArmMasses {
        gravity,
        links: robot.links.iter().map(|l| (l.mass, l.com)).collect(),
        payload: robot.payload,
    });
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let tables = JointTables::new(&model.curves);
    let ranges = ranges(model);
    let state = |_| {
        let q: Vec<f64> = ranges.iter().map(|[low, high]| rng.random_range(*low..=*high)).collect();
        let load = masses.as_ref().map(|m| unloaded.load(m, &q, 0.0)).unwrap_or_default();
        let side = |forward: bool| if forward { Approach::Positive } else { Approach::Negative };
        let approach = q.iter().map(|_| side(rng.random())).collect();
        let warmth = rng.random_range(-WARMTH..=WARMTH);
        let curves = tables.bend(&q);
        (q, RowInputs { approach, warmth, curves, ..load })
    };
    (0..POSES).map(state).collect()
}
