//! Pages, a function a verb.

mod compare;
mod diagnose;
mod identify;
mod plan;
mod verify;

pub use compare::compared;
pub use diagnose::diagnosed;
pub use identify::identified;
pub use plan::{Planned, planned, separated};
pub use verify::verified;

use super::document::Section;
use super::picture::Measured;
use super::sections;
use crate::identify::Figures;
use crate::observations::kind;

/// 3-D RMS that the stated standard deviations leave, mm.
fn noise_floor_mm(on: &Measured) -> f64 {
    let rows = &on.data.rows;
    let variance: f64 = rows.iter().map(|r| kind(r).noise(r).powi(2)).sum();
    (variance / rows.len().max(1) as f64).sqrt() * 1e3
}

/// What is said of every identified arm.
fn of_figures(f: &Figures, not_testable: &[String]) -> [Section; 4] {
    [
        sections::corrections(f),
        sections::lambda(f),
        sections::unknown(f, not_testable),
        sections::flagged(f),
    ]
}

/// Rows, poses and stations in a few words.
fn rows_of(f: &Figures) -> (String, String) {
    ("measured".to_owned(), format!("{} rows, {} poses", f.rows, f.poses))
}
