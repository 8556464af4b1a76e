//! What a controller links and nothing else: parameters from a slot, all
//! effects, one compensated tick. Its text, static RAM and the stack of a tick
//! are held against budgets.toml. It formats nothing, and it links only if no
//! panic can be reached, as `no_panic` does.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../memory.rs"]
mod memory;
#[path = "../stack.rs"]
mod stack;
#[path = "../vectors.rs"]
mod vectors;

use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hio};
use truearm::blob::Blob;
use truearm::compensate::Status;
use truearm::{Arm, Compensator, Settings, State, Task, Tick};

use vectors::{JOINTS, Joints, Vectors};

type Memory = Option<Compensator<'static, f32, JOINTS>>;

/// What a tick takes and gives.
struct Cycle {
    compensator: &'static mut Compensator<'static, f32, JOINTS>,
    command: Joints,
    state: State<f32, JOINTS>,
    tick: Option<Tick<f32, JOINTS>>,
}

#[entry]
fn main() -> ! {
    debug::exit(if run().is_some() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

fn run() -> Option<()> {
    let mut memory: &'static mut Memory = cortex_m::singleton!(: Memory = None)?;
    let load_stack = stack::used(&mut || load(&mut memory));
    let compensator = memory.as_mut()?;
    let terms = compensator.arm().terms().len();
    let tool = *compensator.arm().nominal().tool();
    let tool_stack = stack::used(&mut || compensator.set_tool(&tool));
    compensator.set_active(true);
    let vectors = Vectors::parse(memory::vector_region()).ok()?;
    let mut poses = vectors.poses();
    let command = poses.next()?;
    let mut cycle = Cycle { compensator, command, state: vectors::state(0), tick: None };
    let mut tick_stack = 0;
    let mut ramped = 0;
    // Poses far apart, so that every branch of a tick is taken: damped, held
    // by its bounds, fading.
    for (index, q) in poses.enumerate() {
        cycle.command = q;
        cycle.state = vectors::state(index);
        let used = stack::used(&mut || tick(&mut cycle));
        tick_stack = if used > tick_stack { used } else { tick_stack };
        ramped += usize::from(cycle.tick.as_ref()?.status == Status::On);
    }
    print("stack load", terms, load_stack)?;
    print("stack set_tool", terms, tool_stack)?;
    print("stack tick", terms, tick_stack)?;
    (ramped > 0).then_some(())
}

/// The first slot with a valid blob.
#[inline(never)]
fn load(memory: &mut &'static mut Memory) {
    **memory = memory::parameter_slots().iter().find_map(|(_, slot)| {
        let arm = Arm::new(&Blob::check(slot).ok()?.parameters().ok()?);
        let start = [0.0; JOINTS];
        let settings = Settings { trust_nominal_orientation: true, ..Settings::new(Task::Pose) };
        Compensator::new(arm, settings, &start).ok()
    });
}

#[inline(never)]
fn tick(cycle: &mut Cycle) {
    cycle.tick = Some(cycle.compensator.tick(&cycle.command, &cycle.state));
}

/// `NAME+TERMS VALUE`.
fn print(name: &str, terms: usize, value: usize) -> Option<()> {
    let mut out = hio::hstdout().ok()?;
    out.write_all(name.as_bytes()).ok()?;
    out.write_all(b"+").ok()?;
    for (number, end) in [(terms, b" "), (value, b"\n")] {
        let mut rest = number;
        let mut digits = [0; 6];
        for digit in digits.iter_mut().rev() {
            *digit = b'0' + (rest % 10) as u8;
            rest /= 10;
        }
        let zeros = digits.iter().take(5).take_while(|digit| **digit == b'0').count();
        out.write_all(digits.get(zeros..)?).ok()?;
        out.write_all(end).ok()?;
    }
    Some(())
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
