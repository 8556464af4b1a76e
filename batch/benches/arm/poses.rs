//! How many there are, for the benchmarks and for what reads their counts.

pub const POSES: usize = 1024;
