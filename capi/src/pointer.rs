//! What comes from C, checked as far as a pointer can be.

use crate::{INITIALISED, Result, Truearm, TruearmError};

/// The arm behind a pointer of the caller.
///
/// # Safety
/// NULL, or memory of `TRUEARM_MEMORY_SIZE` readable bytes that nothing else
/// uses meanwhile.
pub unsafe fn handle<'a>(arm: *mut Truearm) -> Result<&'a mut Truearm> {
    writable(arm)?;
    // SAFETY: not NULL, aligned; a u64 can be read from any bytes.
    let initialised = unsafe { (&raw const (*arm).initialised).read() };
    if initialised != INITIALISED {
        return Err(TruearmError::NotInitialised);
    }
    // SAFETY: `truearm_init` was here and wrote all of it; the caller's promise.
    Ok(unsafe { &mut *arm })
}

/// A copy of what the caller points to.
///
/// # Safety
/// NULL, or readable as a `T` for which all bytes are valid.
pub unsafe fn input<T: Copy>(pointer: *const T) -> Result<T> {
    writable(pointer.cast_mut())?;
    // SAFETY: not NULL, aligned; the caller's promise.
    Ok(unsafe { pointer.read() })
}

/// The same, or `None` for NULL.
///
/// # Safety
/// As for `input`.
pub unsafe fn optional<T: Copy>(pointer: *const T) -> Result<Option<T>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    unsafe { input(pointer) }.map(Some)
}

/// Refuses what cannot be written to.
pub fn writable<T>(pointer: *mut T) -> Result {
    if pointer.is_null() {
        Err(TruearmError::Null)
    } else if !pointer.is_aligned() {
        Err(TruearmError::Alignment)
    } else {
        Ok(())
    }
}
