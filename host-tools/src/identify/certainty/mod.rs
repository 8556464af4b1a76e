//! How well all that is known: error bars, covariance, what the data leave open.

pub mod carried;
pub mod covariance;
pub mod directed;
pub mod error_bars;
pub mod redundancy;
pub mod repeats;
pub mod scale;
pub mod unknowns;
