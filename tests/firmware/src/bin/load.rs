//! The least that a controller links: a slot is checked and folded, and a tick
//! asks where the tool really is. Its text is held against budgets.toml. It
//! links only if no panic can be reached, as `no_panic` does.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../memory.rs"]
#[allow(dead_code, reason = "one slot is enough")]
mod memory;

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use truearm::blob::Blob;
use truearm::{Arm6, Pose};

#[entry]
fn main() -> ! {
    let arm = load();
    loop {
        black_box(tick(black_box(&arm), black_box(&[0.0; 6])));
    }
}

fn load() -> Option<Arm6<'static, f32>> {
    let [(_, slot), _] = memory::parameter_slots();
    Some(Arm6::new(&Blob::check(slot).ok()?.parameters().ok()?))
}

fn tick(arm: &Option<Arm6<'_, f32>>, encoders: &[f32; 6]) -> Option<Pose<f32>> {
    arm.as_ref().map(|arm| arm.real_pose(encoders))
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
