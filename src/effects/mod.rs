//! The repertoire: what an arm does beyond rigid geometry.
//!
//! A model is a list of [`Term`]s. Every term is linear in its coefficient and
//! bends a joint, the base or a length a little; its derivative is a known
//! [`Term::basis`] times a geometric column. Identification and controller
//! share this code.

mod approach;
mod folded;
mod inputs;
mod statics;
mod tables;
mod term;

pub use approach::Approach;
pub use folded::FoldedTerms;
pub use inputs::Inputs;
pub use statics::{Load, Masses, Weights};
pub use tables::Tables;
pub use term::{Bending, Effect, Term};

/// Most terms of an arm.
pub const MAX_TERMS: usize = 24;
