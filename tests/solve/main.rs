//! Identification on the controller.

#[path = "../common/arms.rs"]
mod arms;
#[path = "../common/mod.rs"]
mod common;
mod drift;
mod misfit;
mod rail;
mod reidentify;
mod streaming;
mod streaming_arm;
mod tikhonov;
