//! All links grow alike, or one that stands by a heat source.

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
    let joints = &data.robot.joints;
    let mut out = vec![Offer::of_arm(EFFECT, &[], &[0.0], 1)];
    for (j, joint) in joints.iter().enumerate() {
        let p = joint.link.parameters;
        if p.a != 0.0 || p.d != 0.0 {
            // One link alone is rare: as if four times as many were tried.
            out.push(Offer::of_arm(EFFECT, &[j], &[0.0], 4 * joints.len()));
        }
    }
    Ok(out)
}
