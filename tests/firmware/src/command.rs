//! What the host wants of the image: words of the semihosting command line, and
//! a blob in memory.

use core::slice;

use cortex_m_semihosting::{nr, syscall1};

/// Where the host loads a blob that is to be stored: memory of the board that
/// memory.x gives to nobody.
const BLOB: usize = 0x0030_0000;
const BLOB_SIZE: usize = 4096;

/// The command line, in the given room.
pub fn line(room: &mut [u8; 80]) -> Option<&str> {
    let mut block = [room.as_mut_ptr().expose_provenance(), room.len()];
    // SAFETY: the block is an address and the bytes there are to fill, which
    // `room` lends; the answer is their number, in the block's second word.
    let status = unsafe { syscall1(nr::GET_CMDLINE, (&raw mut block).expose_provenance()) };
    let [_, length] = block;
    if status != 0 {
        return None;
    }
    let line = room.get(..length)?;
    core::str::from_utf8(line.split(|byte| *byte == 0).next()?).ok()
}

/// The bytes where a blob to be stored would be.
pub fn blob() -> &'static [u8] {
    // SAFETY: the board has 4 MiB of memory at address 0; nobody writes there.
    unsafe { slice::from_raw_parts(core::ptr::with_exposed_provenance(BLOB), BLOB_SIZE) }
}
