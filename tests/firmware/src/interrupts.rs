//! The images take no interrupts: one vector in place of the 240 that a table
//! for any Cortex-M has room for.

/// Read by the chip, if ever.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
#[used]
static __INTERRUPTS: [unsafe extern "C" fn(); 1] = [unexpected];

unsafe extern "C" fn unexpected() {
    loop {
        cortex_m::asm::wfi();
    }
}
