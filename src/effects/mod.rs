//! The repertoire: what an arm does beyond rigid geometry.
//!
//! A model is a list of [`Term`]s. Every term is linear in its coefficient and
//! deflects a joint, the base or a length a little; its derivative is a known
//! [`Term::basis`] times a geometric column. Identification and controller
//! share this code.

mod approach;
mod folded;
mod inputs;
mod statics;
mod tables;
mod term;

pub use approach::Approach;
pub(crate) use folded::FoldedTerms;
pub use inputs::TermInputs;
pub(crate) use statics::GravityModel;
pub use statics::{Load, Masses};
pub use tables::Tables;
pub use term::{Effect, Term, deflection};

/// Most terms of an arm.
pub const MAX_TERMS: usize = 24;
