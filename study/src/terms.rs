//! What a fit that is told of an effect has for it.

use truearm::effects::Effect;
use truearm_host::effects::{Offer, lag};
use truearm_host::model::{Clock, ModelTerm};
use truearm_simulate::effects::DefectKind;

/// Terms of a hidden effect, coefficients zero; none of gross errors, `None` of
/// what no report can name.
pub fn terms(kind: &DefectKind, gear_ratios: &[f64]) -> Option<Vec<ModelTerm>> {
    if let Some(effect) = Effect::from_name(kind.name()) {
        let joints: Vec<usize> = kind.joints().iter().map(|joint| joint - 1).collect();
        return Some(Offer::of_arm(effect, &joints, &kind.orders(gear_ratios), 1).terms);
    }
    let remount = |axis| ModelTerm::Remount { series: "B".into(), axis, coefficient: 0.0 };
    let drift =
        |component| ModelTerm::Drift { component, course: Clock::Time.goes_on(), coefficient: 0.0 };
    Some(match kind {
        DefectKind::ToolRemount { .. } => (0..3).map(remount).collect(),
        DefectKind::MeasurementDrift { .. } => (0..6).map(drift).collect(),
        DefectKind::ReadoutLag { joint } => lag(*joint, 1).terms,
        DefectKind::Outliers => Vec::new(),
        _ => return None,
    })
}
