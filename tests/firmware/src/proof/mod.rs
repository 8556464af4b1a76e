//! Everything that a controller may call, on values of which the compiler
//! knows nothing, for the proof in `bin/no_panic.rs`.

pub mod identification;
pub mod parts;
pub mod power_up;
pub mod tick;

use core::hint::black_box;

/// Computed, whatever of it the compiler thinks is of use.
pub fn compute<V>(value: V) {
    let _ = black_box(&value);
}
