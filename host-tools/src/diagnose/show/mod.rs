//! Showing what was found: the gap from nominal to the final model, on poses
//! that were not fitted; each effect with its coefficients; explanations that
//! stay within reach, and the poses that would tell them apart.

mod alternatives;
mod certainty;
mod effects;
mod gap;
mod hold_out;
mod late;
mod stages;

pub use alternatives::alternatives;
pub use effects::effects;
pub use gap::{HeldOut, Show};
