//! Logging from firmware: what a tick, a refusal and a position say, through
//! defmt. xtask decodes the frames and reads them.

#![no_std]
#![no_main]

#[path = "../memory.rs"]
mod memory;
#[path = "../outcome.rs"]
mod outcome;
#[path = "../vectors.rs"]
mod vectors;

use cortex_m_rt::entry;
use defmt_semihosting as _;
use truearm::blob::Blob;
use truearm::{Arm, Compensator, RealPosition, Settings, State, Task};

use vectors::{JOINTS, Joints};

/// In front of the robot, rad.
const START: Joints = [0.0, -1.2, 1.6, -1.2, -1.57, 0.0];
/// Stretched out, shoulder to wrist in a line, the wrist's axes as well.
const SINGULAR: Joints = [0.0; JOINTS];

#[entry]
fn main() -> ! {
    outcome::end(run().is_some())
}

fn run() -> Option<()> {
    let [(_, slot), _] = memory::parameter_slots();
    let blob = Blob::check(slot).ok()?;
    defmt::info!("found {}", blob);
    let mut damaged = *slot.first_chunk::<1024>()?;
    *damaged.get_mut(100)? ^= 0x10;
    if let Err(error) = Blob::check(&damaged) {
        defmt::error!("damaged: {}", error);
    }
    defmt::error!("cut off: {}", Blob::check(slot.get(..10)?).err()?);

    let arm = Arm::new(&blob.parameters::<f32, JOINTS>().ok()?);
    let state = State::at(24.0);
    defmt::info!("position {}", RealPosition::of(&arm, &START, &state, None));

    let settings = Settings { ramp_ticks: 2, ..Settings::new(Task::Pose) };
    let mut compensator = Compensator::new(arm, settings, &START).ok()?;
    defmt::info!("off {}", compensator.tick(&START, &state));
    compensator.set_active(true);
    defmt::info!("switched on {}", compensator.tick(&START, &state).status);
    compensator.tick(&START, &state);
    defmt::info!("after the ramp {}", compensator.tick(&START, &state).status);
    defmt::warn!("singular {}", compensator.tick(&SINGULAR, &state));
    let mut command = START;
    *command.get_mut(3)? = f32::NAN;
    defmt::error!("refused {}", compensator.tick(&command, &state));
    defmt::error!("refused {}", compensator.tick(&START, &State::at(f32::NAN)).status);
    Some(())
}
