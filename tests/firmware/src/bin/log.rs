//! Logging from firmware: what a blob, a position and a tick say, through defmt.
//! xtask decodes the frames and compares them with what it computes itself.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../log.rs"]
mod log;
#[path = "../memory.rs"]
#[allow(dead_code, reason = "has no vectors")]
mod memory;
#[path = "../outcome.rs"]
mod outcome;

use cortex_m_rt::entry;
use defmt_semihosting as _;
use truearm::blob::Blob;

#[entry]
fn main() -> ! {
    outcome::end(run().is_some())
}

fn run() -> Option<()> {
    let [(_, slot), _] = memory::parameter_slots();
    defmt::info!("{}", Blob::check(slot).ok()?);
    let events = log::events(slot.first_chunk()?)?;
    defmt::error!("{}", events.damaged);
    defmt::error!("{}", events.cut);
    defmt::info!("{}", events.position);
    defmt::info!("{}", events.off);
    defmt::info!("{}", events.ramping.status);
    defmt::info!("{}", events.on);
    defmt::warn!("{}", events.singular);
    defmt::error!("{}", events.refused);
    Some(())
}
