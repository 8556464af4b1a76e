//! How an image ends: with a status for QEMU, which ends with it.

use core::panic::PanicInfo;

use cortex_m_semihosting::{debug, hprintln};

/// Ends the image, with 0 if all went well, otherwise with 1.
pub fn end(success: bool) -> ! {
    debug::exit(if success { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    hprintln!("{}", info);
    end(false)
}
