//! A controller whose parameters are in an AT24C64 EEPROM, with a temperature
//! sensor on the same bus. At power-up it loads them and says what it found;
//! then it does what the command line says, `VERB ROBOT-ID`:
//!
//! - `boot`: nothing more;
//! - `store`: stores the blob that the host loaded into memory;
//! - `churn`: stores one blob after the other, until the power fails.

#![no_std]
#![no_main]

#[path = "../command.rs"]
mod command;
#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../outcome.rs"]
mod outcome;
#[path = "../sbcon.rs"]
mod sbcon;

use core::cell::RefCell;

use cortex_m_rt::entry;
use cortex_m_semihosting::hprintln;
use eeprom24x::{Eeprom24x, SlaveAddr, Storage};
use embedded_hal_bus::i2c::RefCellDevice;
use truearm::blob::{Acceptance, encode};
use truearm::sensor::{TEMPERATURE_SENSOR, read_temperature};
use truearm::store::{ByteSlots, Medium, Source, Store};
use truearm::{Arm6, ArmParameters6, State};

use sbcon::{Clocks, SbCon};

/// Pages of an AT24C64.
const PAGE: usize = 32;
/// Half of it for each slot.
const SLOT: u32 = 4096;

/// Why the image exits with 1; the reason has been printed.
struct Failed;

#[entry]
fn main() -> ! {
    outcome::end(run().is_ok())
}

fn run() -> Result<(), Failed> {
    let mut room = [0; 80];
    let mut words = command::line(&mut room).unwrap_or_default().split_whitespace();
    let verb = words.next().unwrap_or("boot");
    let robot = words.next().and_then(|word| u64::from_str_radix(word, 16).ok()).unwrap_or(0);
    // SAFETY: the image is for mps2 boards, and this line runs once.
    let bus = RefCell::new(unsafe { SbCon::new() });
    let eeprom = Eeprom24x::new_24x64(RefCellDevice::new(&bus), SlaveAddr::default());
    let slots = ByteSlots::<_, PAGE>::new(Storage::new(eeprom, Clocks), [0, SLOT], SLOT);
    let slots = slots.map_err(|error| failed("slots", error))?;

    let mut buffer = [0; SLOT as usize];
    let (mut store, opened) = Store::open(slots, &mut buffer, Acceptance::of(robot, 6))
        .map_err(|error| failed("store", error))?;
    report(&opened.source);
    hprintln!("settled: {:?}", opened.settled);
    let parameters = match opened.blob {
        Some(blob) => Some(blob.parameters().map_err(|error| failed("parameters", error))?),
        None => None,
    };
    if let Some(parameters) = &parameters {
        hprintln!("sequence: {}", parameters.sequence);
        where_the_tool_is(parameters, &mut RefCellDevice::new(&bus))?;
    }
    match verb {
        "boot" => Ok(()),
        "store" => match store.store(command::blob()) {
            Ok(done) => {
                hprintln!("stored: {:?}", done);
                Ok(())
            }
            Err(error) => Err(failed("store", error)),
        },
        "churn" => churn(&mut store, parameters),
        _ => Err(failed("command line", verb)),
    }
}

fn failed(what: &str, why: impl core::fmt::Display) -> Failed {
    hprintln!("FAILED: {}: {}", what, why);
    Failed
}

fn report<E: core::fmt::Debug>(source: &Source<E>) {
    match source {
        Source::Newest(slot) => hprintln!("parameters: slot {}, the newest", slot),
        Source::LastGood { slot, rejected } => {
            hprintln!(
                "parameters: slot {}, the last good; slot {}: {}",
                slot,
                slot.other(),
                rejected
            )
        }
        Source::Nominal(slots) => hprintln!("parameters: nominal; {:?}", slots),
    }
}

/// With the joints at zero and at the temperature of the sensor; as bits, for
/// the host to compare.
fn where_the_tool_is(
    parameters: &ArmParameters6<f32>,
    bus: &mut RefCellDevice<SbCon>,
) -> Result<(), Failed> {
    let temperature = read_temperature(bus, TEMPERATURE_SENSOR)
        .map_err(|error| failed("temperature", format_args!("{error:?}")))?;
    let state = State::at(temperature);
    let [x, y, z] = Arm6::new(parameters).real_pose_in(&[0.0; 6], &state).translation.into();
    hprintln!("temperature: {} C", temperature);
    hprintln!("tool: {:08x} {:08x} {:08x}", x.to_bits(), y.to_bits(), z.to_bits());
    Ok(())
}

/// Stores sets of parameters with rising sequence numbers, and says so before
/// and after each.
fn churn<M: Medium>(
    store: &mut Store<M>,
    parameters: Option<ArmParameters6<f32>>,
) -> Result<(), Failed> {
    let mut parameters =
        parameters.ok_or_else(|| failed("churn", "no parameters to begin with"))?;
    let mut bytes = [0; 1024];
    loop {
        parameters.sequence += 1;
        // Another set, which the host can tell from its number.
        parameters.tool.x = (parameters.sequence % 1000) as f32 * 1e-4;
        let size = encode(&parameters, &mut bytes).map_err(|error| failed("encode", error))?;
        hprintln!("storing: {}", parameters.sequence);
        // Never there already: each has a number of its own.
        let _ = store.store(&bytes[..size]).map_err(|error| failed("store", error))?;
        hprintln!("stored: {}", parameters.sequence);
    }
}
