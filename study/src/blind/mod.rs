//! Blind sets: what is hidden in them is opened after the verdict.

pub mod draft;
pub mod score;
pub mod secret;
pub mod sets;
