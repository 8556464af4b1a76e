//! The uncertainty of the tool point on the controller, from the covariance in
//! a slot: its bits, which xtask compares with the host's, and its cost.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../measure.rs"]
mod measure;
#[path = "../memory.rs"]
mod memory;
#[path = "../outcome.rs"]
mod outcome;
#[path = "../sigma.rs"]
mod sigma;
#[path = "../vectors.rs"]
mod vectors;

use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::hprintln;
use truearm::Arm;
use truearm::blob::Blob;

use measure::Counter;
use vectors::{JOINTS, Vectors};

#[entry]
fn main() -> ! {
    outcome::end(run().is_some())
}

fn run() -> Option<()> {
    let [(_, bytes), _] = memory::parameter_slots();
    let blob = Blob::check(bytes).ok()?;
    let arm = Arm::new(&blob.parameters::<f32, JOINTS>().ok()?);
    let vectors = Vectors::parse(memory::vector_region()).ok()?;
    hprintln!("sigma: {:016x}", sigma::hash(&blob, &arm, vectors.poses()));

    let mut counter = Counter::new(cortex_m::Peripherals::take()?.SYST);
    let print = |name, tenths: u64| {
        hprintln!("instructions {} {}.{}", name, tenths / 10, tenths % 10);
    };
    let pose = (vectors.poses().next()?, vectors::state(1));
    let count = counter.tenths_per_call(1000, &[pose], |(q, state)| {
        black_box(sigma::sigma(black_box(&blob), black_box(&arm), q, state));
    });
    print("point_sigma", count);
    let count = counter.tenths_per_call(1000, &[bytes], |bytes| {
        let _ = black_box(&check(bytes));
    });
    print("check+covariance", count);
    Some(())
}

#[inline(never)]
fn check(bytes: &[u8]) -> bool {
    Blob::check(bytes).is_ok()
}
