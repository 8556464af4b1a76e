//! Stack that a piece of work takes, by painting what lies below.

use core::ptr;

const PAINT: u32 = 0x5a5a_a5a5;
/// Left unpainted for the frames of the painter itself.
const OWN: usize = 512;

unsafe extern "C" {
    // End of the static variables, by cortex-m-rt; the stack grows down to it.
    static __sheap: u8;
}

/// Bytes of stack below the caller's that `work` takes.
#[inline(never)]
pub fn used(work: &mut dyn FnMut()) -> usize {
    let bottom = (&raw const __sheap).addr().next_multiple_of(4);
    let top = cortex_m::register::msp::read() as usize;
    for address in (bottom..top.saturating_sub(OWN)).step_by(4) {
        // SAFETY: RAM between the static variables and this function's frame,
        // which nothing uses before `work` runs.
        unsafe { ptr::with_exposed_provenance_mut::<u32>(address).write_volatile(PAINT) };
    }
    work();
    let painted = |address: &usize| {
        // SAFETY: as above; `work` has ended.
        unsafe { ptr::with_exposed_provenance::<u32>(*address).read_volatile() == PAINT }
    };
    let clean = (bottom..top).step_by(4).take_while(painted).count() * 4;
    top - bottom - clean
}
