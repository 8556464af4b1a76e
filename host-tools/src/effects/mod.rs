//! The repertoire as the host knows it: which candidates of an effect the data
//! can test, what choosing among them costs, and which coefficients physics
//! allows. What a controller knows of it (name, unit, components, basis) is in
//! [`truearm::effects`], and how a term is said follows from that.
//!
//! A file an effect. To add one of the arm, write the crate's half, this half,
//! and its row in the table below.

mod backlash;
mod base_compliance;
mod encoder_eccentricity;
mod family;
mod gear_transmission_error;
mod joint_compliance;
mod joint_coupling;
mod joint_gain;
mod joint_periodic_error;
mod joint_stiffening;
mod lateral_compliance;
mod measurement_drift;
mod outliers;
mod readout_lag;
mod thermal_expansion;
mod tool_remount;

pub use family::{Data, Family, Offer};
pub use measurement_drift::courses;
pub use outliers::OUTLIERS;
pub use readout_lag::lag;
pub use thermal_expansion::growing;

/// Every effect that a report may name: those of the arm, then those of the
/// measurement. As many families an explanation may come from.
pub const ALL: &[Family] = &[
    joint_compliance::FAMILY,
    base_compliance::FAMILY,
    encoder_eccentricity::FAMILY,
    gear_transmission_error::FAMILY,
    joint_periodic_error::FAMILY,
    joint_gain::FAMILY,
    joint_coupling::FAMILY,
    backlash::FAMILY,
    thermal_expansion::FAMILY,
    joint_stiffening::FAMILY,
    lateral_compliance::FAMILY,
    measurement_drift::FAMILY,
    readout_lag::FAMILY,
    tool_remount::FAMILY,
    outliers::FAMILY,
];

/// The family of a name in reports.
#[must_use]
pub fn family(name: &str) -> Option<&'static Family> {
    ALL.iter().find(|family| family.name == name)
}

/// All that the data can test, and in words what cannot be tested for want of
/// something in the files.
#[must_use]
pub fn offers(data: &Data) -> (Vec<Offer>, Vec<String>) {
    let mut out = Vec::new();
    let mut missing: Vec<(&str, Vec<&str>)> = Vec::new();
    for family in ALL {
        match (family.offers)(data) {
            Ok(offers) => out.extend(offers),
            Err(what) => match missing.iter_mut().find(|(known, _)| *known == what) {
                Some((_, names)) => names.push(family.name),
                None => missing.push((what, vec![family.name])),
            },
        }
    }
    let words = missing.into_iter().map(|(what, names)| {
        let verb = if names.len() == 1 { "needs" } else { "need" };
        format!("{}: {verb} {what}", names.join(", "))
    });
    (out, words.collect())
}

#[cfg(test)]
mod tests;
