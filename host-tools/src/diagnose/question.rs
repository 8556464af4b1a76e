//! What a diagnosis asks.

use super::candidates::Candidate;
use super::moments::Moments;
use crate::identify::Problem;
use crate::identify::fit::folds::Fold;
use crate::identify::fit::robust::Flags;

/// What is asked.
#[derive(Clone, Copy)]
pub struct Question<'a> {
    /// Geometry only.
    pub problem: &'a Problem<'a>,
    /// Candidates of known form.
    pub offered: &'a [Candidate],
    /// Highest order of a line.
    pub highest_order: f64,
    /// Lambda and flags.
    pub flags: Flags,
    /// Rows.
    pub rows: &'a [usize],
    /// Folds of the nested cross-validation.
    pub folds: &'a [Fold],
    /// First moments of the links, where gravity bends springs.
    pub moments: Option<&'a Moments>,
    /// Most terms of the arm that the model may have.
    pub most_terms: usize,
}
