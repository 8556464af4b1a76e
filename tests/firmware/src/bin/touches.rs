//! An arm that mends itself from touches of one plate: does the accidents of a file that
//! xtask loads, compares the bits of what it finds with those of the host, and counts what
//! a touch costs.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../measure.rs"]
mod measure;
#[path = "../memory.rs"]
#[allow(dead_code, reason = "the parameters come with the accidents")]
mod memory;
#[path = "../outcome.rs"]
mod outcome;
#[path = "../plates.rs"]
mod plates;
#[path = "../records.rs"]
mod records;

use core::cell::RefCell;
use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::hprintln;
use truearm::streaming::StreamingError;

use measure::Counter;
use plates::{AFTER, Accident, Accidents, Stream, Touch};

#[entry]
fn main() -> ! {
    outcome::end(run().is_some())
}

fn run() -> Option<()> {
    let accidents = Accidents::parse(memory::vector_region())?;
    let mut count = 0;
    let hash = accidents.hash(|_, mended| {
        count += 1;
        let held_out = mended.streamed.held_out.unwrap_or(0.0);
        hprintln!(
            "accident {}: streamed, held out {:.1} um; again, {} steps, rms {:.1} -> {:.1} um",
            count,
            held_out * 1e6,
            mended.again.steps,
            mended.again.rms_before * 1e6,
            mended.again.rms_after * 1e6
        );
    })?;
    hprintln!("hash: {:016x}", hash);
    let first = accidents.iter().next()??;
    costs(&first, &mut Counter::new(cortex_m::Peripherals::take()?.SYST))?;
    (hash == accidents.0.expected).then_some(())
}

/// Counts a touch into a stream of seven unknowns, and all touches at once.
fn costs(accident: &Accident, counter: &mut Counter) -> Option<()> {
    let learned = accident.learned()?;
    let touches = accident.touched(learned.plate);
    let stream = RefCell::new(accident.stream(&learned)?);
    let push_one = |touch: &Touch| {
        if let Ok(mut stream) = stream.try_borrow_mut() {
            let _ = push(black_box(&mut *stream), touch);
        }
    };
    touches.iter().for_each(push_one);
    let tenths = counter.tenths_per_call(16, &touches, push_one);
    hprintln!("instructions touch_push7 {}.{}", tenths / 10, tenths % 10);
    let tenths = counter.tenths_per_call(1, &[&touches], |touches| {
        let _ = black_box(accident.again(&learned, *touches));
    });
    hprintln!("instructions touch_reidentify7 {}", tenths / 10 / AFTER as u64);
    Some(())
}

#[inline(never)]
fn push(stream: &mut Stream, touch: &Touch) -> Result<bool, StreamingError> {
    stream.push(touch)
}
