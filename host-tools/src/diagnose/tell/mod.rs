//! Sentences on what no name is given to: where the residuals are, and joints
//! that look as if they had slipped.

mod instead;
mod slip;
mod whereabouts;

pub use instead::{instead, late, otherwise, place};
pub use whereabouts::sentences;
