//! A proof by the linker that nothing a controller calls can panic: the panic
//! handler calls a function that does not exist, so the image links only if no
//! panic can be reached. With the feature `negative_control` it must not link.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../proof/mod.rs"]
mod proof;

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::debug;

use proof::{compute, identification, power_up, tick};

#[entry]
fn main() -> ! {
    let bytes = black_box(&[0; 4096]);
    let single = black_box(&[0.0_f32; 6]);
    let double = black_box(&[0.0_f64; 6]);
    compute(tick::load_and_tick(bytes, single));
    compute(tick::load_and_tick(bytes, double));
    compute(identification::watch_and_reidentify(bytes, single));
    compute(identification::watch_and_reidentify(bytes, double));
    compute(identification::stream(single));
    compute(identification::stream(double));
    compute(power_up::flash(bytes, black_box(&mut [0; 4096])));
    if !cfg!(feature = "flash_only") {
        compute(power_up::eeprom(bytes, black_box(&mut [0; 4096])));
    }
    #[cfg(feature = "negative_control")]
    compute(bytes[black_box(7)]);
    loop {
        debug::exit(debug::EXIT_SUCCESS);
    }
}

unsafe extern "C" {
    fn truearm_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never called: the function does not exist, and nothing links
    // that could get here.
    unsafe { truearm_panic_is_reachable() }
}
