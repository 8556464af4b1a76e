//! What errors are allowed.

use super::Verification;
use crate::error::{Error, Result};

/// Of tolerances.
const UNITS: [&str; 2] = ["mm", "deg"];

/// The largest errors allowed of what measured points or lengths, mm, and of turns and
/// inclinations, degrees.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tolerances {
    /// Of points and lengths.
    pub mm: Option<f64>,
    /// Of turns and inclinations.
    pub deg: Option<f64>,
}

impl Tolerances {
    /// What is allowed of a kind that is judged in `unit`.
    #[must_use]
    pub fn of(&self, unit: &str) -> Option<f64> {
        match unit {
            "mm" => self.mm,
            "deg" => self.deg,
            _ => None,
        }
    }

    /// Whether they allow anything.
    ///
    /// # Errors
    /// One that is none, or not above nothing.
    pub fn sensible(&self) -> Result<()> {
        for unit in UNITS {
            if let Some(value) = self.of(unit).filter(|value| !(*value > 0.0 && value.is_finite()))
            {
                return Err(Error::usage(
                    format!("a tolerance of {value} {unit}"),
                    "give the largest error allowed in this unit, such as 0.3",
                ));
            }
        }
        Ok(())
    }

    /// Whether all of them say something of what was measured.
    ///
    /// # Errors
    /// As for [`Tolerances::sensible`], and one in whose unit no row is judged.
    pub fn tell(&self, verified: &Verification) -> Result<()> {
        self.sensible()?;
        let idle = |unit: &&str| {
            self.of(unit).is_some() && !verified.kinds.iter().any(|kind| kind.unit == *unit)
        };
        match UNITS.into_iter().find(idle) {
            None => Ok(()),
            Some(unit) => Err(Error::usage(
                format!("a tolerance in {unit}: no row of {} is measured in it", verified.file),
                "give a tolerance of what was measured: mm of points and lengths, deg of turns and \
                 inclinations",
            )),
        }
    }
}
