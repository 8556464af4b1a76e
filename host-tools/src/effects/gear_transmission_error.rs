//! Waves tied to the gear ratio that the robot file states.

use truearm::effects::Effect;

use super::{Data, Family, Offer};

const EFFECT: Effect = Effect::GearTransmissionError;

pub(super) const FAMILY: Family =
    Family { name: EFFECT.name(), offers, plausible: -2e-2..2e-2, several: false };

/// Cycles of an input turn: a strain-wave gear errs twice; others once.
const CYCLES: [&[f64]; 4] = [&[2.0], &[2.0, 4.0], &[1.0], &[1.0, 2.0]];

fn offers(data: &Data) -> Result<Vec<Offer>, &'static str> {
    let joints = data.joints(EFFECT);
    let ratio = |j: usize| data.robot.joints.get(j)?.gear_ratio;
    let mut out = Vec::new();
    for (j, ratio) in joints.iter().filter_map(|j| Some((*j, ratio(*j)?))) {
        for cycles in CYCLES {
            let orders: Vec<f64> = cycles.iter().map(|k| k * ratio).collect();
            out.push(Offer::of_arm(EFFECT, &[j], &orders, CYCLES.len() * joints.len()));
        }
    }
    if out.is_empty() { Err("gear_ratio") } else { Ok(out) }
}
