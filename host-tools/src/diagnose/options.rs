//! What the user of a diagnosis may choose.

use std::ops::RangeInclusive;

use crate::error::{Error, Result};

/// What the user may choose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnoseOptions {
    /// Highest order of a periodic error to scan, cycles a turn.
    pub highest_order: f64,
    /// Most terms of the arm that the model may have.
    pub most_terms: usize,
    /// Go on with fewer equations than unknowns.
    pub allow_few_poses: bool,
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        Self { highest_order: 420.0, most_terms: 128, allow_few_poses: false }
    }
}

/// Orders that a gear or an encoder may have, cycles a turn.
const ORDERS: RangeInclusive<f64> = 3.0..=2000.0;

impl DiagnoseOptions {
    /// Whether there is anything to look for.
    ///
    /// # Errors
    /// An order that no gear or encoder has, or no terms.
    pub fn sensible(&self) -> Result<()> {
        // NaN is in no range.
        if !ORDERS.contains(&self.highest_order) {
            let (low, high) = (ORDERS.start(), ORDERS.end());
            return Err(Error::usage(
                format!("a highest order of {}", self.highest_order),
                format!("give {low} to {high} cycles a turn"),
            ));
        }
        if self.most_terms == 0 {
            return Err(Error::usage(
                "a model of 0 terms",
                "give 1 or more; `identify` finds the geometry alone",
            ));
        }
        Ok(())
    }
}
