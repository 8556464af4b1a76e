//! Identification on the controller: does the re-identification runs of a file
//! that xtask loads, compares the bits of what it finds with those of the host,
//! and counts what this and streaming identification cost.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../measure.rs"]
mod measure;
#[path = "../memory.rs"]
#[allow(dead_code, reason = "the parameters come with the runs")]
mod memory;
#[path = "../records.rs"]
mod records;
#[path = "../runs.rs"]
mod runs;
#[path = "../stack.rs"]
mod stack;
#[path = "../streaming.rs"]
mod streaming;

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};

use measure::Counter;
use runs::Runs;

#[entry]
fn main() -> ! {
    debug::exit(if run() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

fn run() -> bool {
    let Some(runs) = Runs::parse(memory::vector_region()) else {
        hprintln!("FAILED: no runs at {:#010x}", memory::VECTORS);
        return false;
    };
    let mut count = 0;
    let hash = runs.hash(|_, known, moved| {
        count += 1;
        hprintln!(
            "run {}: {} steps, rms {:.1} -> {:.1} um; tracker moved: {} steps, rms {:.1} -> {:.1} um",
            count,
            known.steps,
            known.rms_before * 1e6,
            known.rms_after * 1e6,
            moved.steps,
            moved.rms_before * 1e6,
            moved.rms_after * 1e6
        );
    });
    let Some(hash) = hash else {
        hprintln!("FAILED: a blob was refused or a re-identification failed");
        return false;
    };
    if let (Some(p), Some(Some(run))) = (cortex_m::Peripherals::take(), runs.iter().next()) {
        let mut counter = Counter::new(p.SYST);
        let known = counter.tenths_per_call(4, &[&run], |run| {
            let _ = black_box(run.known());
        });
        let moved = counter.tenths_per_call(4, &[&run], |run| {
            let _ = black_box(run.moved());
        });
        hprintln!("instructions reidentify5 {}", known / 10);
        hprintln!("instructions reidentify11 {}", moved / 10);
        let Some(figures) = streaming::measure(&mut counter) else {
            hprintln!("FAILED: streaming identification takes more stack than stated");
            return false;
        };
        hprintln!("instructions streaming_push30 {}.{}", figures.push / 10, figures.push % 10);
        hprintln!("instructions streaming_choose30 {}", figures.choose / 10);
        hprintln!("stack streaming_push30 {}", figures.push_stack);
        hprintln!("stack streaming_choose30 {}", figures.choose_stack);
        hprintln!("stack streaming_solve30 {}", figures.solve_stack);
    }
    hprintln!("runs: {}", count);
    hprintln!("hash: {:016x}", hash);
    if hash != runs.0.expected {
        hprintln!("FAILED: the host computed {:016x}", runs.0.expected);
        return false;
    }
    hprintln!("ok: bit for bit what the host computed");
    true
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    hprintln!("{}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
