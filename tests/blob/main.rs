//! The parameter blob.

mod acceptance;
#[path = "../common/blobs.rs"]
mod blobs;
#[path = "../common/mod.rs"]
mod common;
mod curves;
mod damage;
mod golden;
mod round_trip;
mod torques;
