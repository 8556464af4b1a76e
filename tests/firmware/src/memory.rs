//! The only place that turns addresses into references.

use core::slice;

/// Where the image looks for a vector file. Test data, so this address is not
/// in memory.x; xtask and `.cargo/config.toml` load the file here.
pub const VECTORS: usize = 0x0020_0000;

/// Room behind `VECTORS` on the board.
const VECTORS_SIZE: usize = 1 << 20;

// Only the addresses of these symbols of memory.x mean anything.
unsafe extern "C" {
    static __param_a_start: u8;
    static __param_b_start: u8;
    static __param_slot_size: u8;
}

/// The two parameter slots: name and bytes.
pub fn parameter_slots() -> [(&'static str, &'static [u8]); 2] {
    let size = (&raw const __param_slot_size).addr();
    // SAFETY: memory.x reserves both slots, apart from flash and RAM of the
    // program, and nothing writes to them while the program runs.
    unsafe {
        [
            ("A", slice::from_raw_parts(&raw const __param_a_start, size)),
            ("B", slice::from_raw_parts(&raw const __param_b_start, size)),
        ]
    }
}

/// What lies where a vector file belongs.
pub fn vector_region() -> &'static [u8] {
    // SAFETY: the board has 4 MiB of memory at address 0, of which memory.x
    // gives none beyond 0x0010_8000 to anyone; nothing writes there.
    unsafe { slice::from_raw_parts(core::ptr::with_exposed_provenance(VECTORS), VECTORS_SIZE) }
}
