//! Host side of truearm: from tracker files to an identified arm and a blob.
//!
//! Data flow one way: [`files`] -> [`model`] -> [`identify`] -> [`report`] and
//! [`model::Model`] -> [`mod@evaluate`], [`mod@pack`]. The kinematics are those of the
//! [`truearm`] crate, the same code that runs on the controller.

pub mod compare;
pub mod describe;
pub mod diagnose;
pub mod error;
pub mod evaluate;
pub mod explain;
pub mod export;
pub mod files;
pub mod identify;
pub mod methods;
pub mod model;
pub mod pack;
pub mod plan;
pub mod plot;
pub mod report;
pub mod tikhonov;
pub mod unpack;
pub mod verify;

pub use error::{Error, Result};
