//! The target sits elsewhere in a series than in the first. Never flashed.

use super::{Data, Family, Offer};
use crate::model::ModelTerm;

pub(super) const FAMILY: Family = Family {
    name: "tool-remount",
    offers,
    plausible: f64::NEG_INFINITY..f64::INFINITY,
    several: false,
};

fn offers(data: &Data) -> Result<Vec<Offer>, &'static str> {
    let [_, later @ ..] = &data.conditions.series[..] else { return Err(LABELS) };
    let shift = |series: &String| {
        let along = |axis| ModelTerm::Remount { series: series.clone(), axis, coefficient: 0.0 };
        Offer { terms: (0..3).map(along).collect(), tried: later.len() as f64 }
    };
    if later.is_empty() { Err(LABELS) } else { Ok(later.iter().map(shift).collect()) }
}

const LABELS: &str = "a column series with several labels";
