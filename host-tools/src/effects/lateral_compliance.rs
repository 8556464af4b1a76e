//! A bearing in every joint that bends across its axis. Under the first joint it would
//! be the base.

use truearm::effects::Effect;

use super::{Data, Family, Offer};

const EFFECT: Effect = Effect::LateralCompliance;

pub(super) const FAMILY: Family = Family {
    name: EFFECT.name(),
    offers,
    // A bearing gives way to its load.
    plausible: 0.0..1e-1,
    several: false,
};

fn offers(data: &Data) -> Result<Vec<Offer>, &'static str> {
    data.weighed()?;
    let joints: Vec<usize> = data.joints(EFFECT).into_iter().filter(|joint| *joint > 0).collect();
    // Every gear gives way, few bearings do as far: as if four times as many were tried.
    let tried = 4 * joints.len();
    Ok(joints.iter().map(|j| Offer::of_arm(EFFECT, &[*j], &[0.0], tried)).collect())
}
