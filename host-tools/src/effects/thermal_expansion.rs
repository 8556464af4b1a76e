//! All links grow alike, or one that stands by a heat source.

use std::iter::once;

use truearm::Link;
use truearm::effects::Effect;

use super::{Data, Family, Offer};

const EFFECT: Effect = Effect::ThermalExpansion;

pub(super) const FAMILY: Family = Family {
    name: EFFECT.name(),
    offers,
    // Aluminium grows by 2.4e-5 a kelvin, and joints warm up more than the air does.
    plausible: -1e-5..6e-5,
    several: false,
};

fn offers(data: &Data) -> Result<Vec<Offer>, &'static str> {
    if !data.conditions.temperature {
        return Err("a column temperature_c that varies");
    }
    let links: Vec<_> = data.robot.joints.iter().map(|joint| joint.link).collect();
    Ok(growing(&links))
}

/// All links together, and each that has a length.
pub fn growing(links: &[Link<f64>]) -> Vec<Offer> {
    let long = |j: &usize| links[*j].parameters.a != 0.0 || links[*j].parameters.d != 0.0;
    // One link alone is rare: as if four times as many were tried.
    let alone = |j: usize| Offer::of_arm(EFFECT, &[j], &[0.0], 4 * links.len());
    let each = (0..links.len()).filter(long).map(alone);
    once(Offer::of_arm(EFFECT, &[], &[0.0], 1)).chain(each).collect()
}
