//! Identification by parts and in pieces: it is that of the whole, wherever the rows are.

#[cfg(feature = "parquet")]
mod columnar;
mod parts;
mod pieces;
#[path = "../simulated/mod.rs"]
mod simulated;
