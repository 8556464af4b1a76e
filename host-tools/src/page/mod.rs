//! `report.html`: what a verb found, for people to look at. One file that needs
//! nothing else: no network, no fonts, no scripts but its own.
//!
//! Data flow one way: [`report`](crate::report) and what the verbs computed ->
//! [`picture`] (rows as figures show them) -> [`charts`] (a file a kind) ->
//! sections (a file each) -> pages (a function a verb). Only the command line
//! imports this room.

pub mod charts;
mod document;
mod numbers;
pub mod picture;
mod sections;
mod verbs;

pub use document::{Figure, Page, Section};
pub use picture::Measured;
pub use sections::next::{Next, after_measuring, commands};
pub use verbs::{Planned, compared, diagnosed, identified, planned, separated, verified};

/// With what a page of truearm's own making begins.
pub const BEGIN: &str = "<!DOCTYPE html>\n<!-- truearm report -->\n";
