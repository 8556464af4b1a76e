//! What is wrong with a file, as an error that names it.

use std::cell::Cell;
use std::path::Path;
use std::sync::Once;

use parquet::errors::ParquetError;

use crate::error::{Error, Place, Result};

thread_local! {
    /// Whether a panic of this thread is that of what reads columns, and is said as an error.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}
static QUIET: Once = Once::new();

/// What reads columns panics over some damaged files: that is an error of the file.
pub fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T>) -> Result<T> {
    QUIET.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !GUARDED.get() {
                usual(info);
            }
        }));
    });
    let damaged = |_| {
        let help = "write it anew: its bytes are not what was written";
        Err(Error::file(path, Place::default(), "a damaged Parquet file", help))
    };
    GUARDED.set(true);
    let read = std::panic::catch_unwind(std::panic::AssertUnwindSafe(read));
    GUARDED.set(false);
    read.unwrap_or_else(damaged)
}

pub fn broken(path: &Path, error: &ParquetError) -> Error {
    let help = "write it anew: a column a number or label, compressed by Snappy, gzip, LZ4 or \
                Zstandard";
    Error::file(path, Place::default(), error.to_string(), help)
}
