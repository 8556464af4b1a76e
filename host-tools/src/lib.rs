//! Host side of truearm: from tracker files to an identified arm and a blob.
//!
//! Data flow one way: [`files`] -> [`model`] -> [`observations`] -> [`identify`] ->
//! [`report`] and
//! [`model::Model`] -> [`mod@evaluate`], [`blob`], [`convert`], which also makes robot files. The kinematics are those of the
//! [`truearm`] crate, the same code that runs on the controller.

pub mod blob;
pub mod check;
pub mod convert;
pub mod diagnose;
pub mod effects;
pub mod error;
pub mod evaluate;
pub mod evidence;
pub mod files;
pub mod fleet;
pub mod gram;
pub mod headings;
pub mod identify;
pub mod import;
pub mod markup;
pub mod methods;
pub mod model;
pub mod observations;
pub mod page;
pub mod paths;
pub mod plan;
pub mod plot;
pub mod report;
pub mod statistics;
pub mod table;
pub mod tikhonov;
pub mod units;
pub mod verify;

pub use error::{Error, ErrorKind, Result};
