//! Gross errors of single rows: flagged and left out, never a term.

use super::Family;

/// Its name in reports.
pub const OUTLIERS: &str = "outliers";

pub(super) const FAMILY: Family = Family {
    name: OUTLIERS,
    offers: |_| Ok(Vec::new()),
    plausible: f64::NEG_INFINITY..f64::INFINITY,
    several: false,
};
