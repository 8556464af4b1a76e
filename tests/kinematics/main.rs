//! Chains, effects and curves against oracles.

#[path = "../common/arms.rs"]
mod arms;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/curves.rs"]
mod curves;
mod effects;
mod error_curves;
mod loads;
mod oracle;
mod parameters;
mod poses;
mod scalar;
