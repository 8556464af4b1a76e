//! A control loop as an async task of embassy-executor: a tick of compensation
//! every millisecond, beside a supervisor that switches it on. Time comes from
//! SysTick, by the driver in `systick.rs`.

#![no_std]
#![no_main]

#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../memory.rs"]
#[expect(dead_code, reason = "no vectors here")]
mod memory;
#[path = "../outcome.rs"]
mod outcome;
#[path = "../systick.rs"]
mod systick;

use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m_semihosting::hprintln;
use embassy_executor::Spawner;
use embassy_time::{Duration, Instant, Ticker, Timer};
use truearm::blob::Blob;
use truearm::compensate::Status;
use truearm::{Arm6, Compensator, Settings, Task};

type Joints = [f32; 6];

/// Of the loop, in milliseconds and so in ticks.
const DURATION: u16 = 1000;
/// When the supervisor switches compensation on.
const SWITCHED_ON: u64 = 200;

/// What the supervisor wants.
static ACTIVE: AtomicBool = AtomicBool::new(false);

/// In front of the robot, rad.
fn command(tick: u16) -> Joints {
    let along = f32::from(tick) * 1e-3;
    [0.3 * along, -1.2, 1.6 - 0.2 * along, -1.2, -1.57, 0.0]
}

fn load() -> Option<Arm6<'static, f32>> {
    let [(_, slot), _] = memory::parameter_slots();
    Some(Arm6::new(&Blob::check(slot).ok()?.parameters().ok()?))
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let Some(core) = cortex_m::Peripherals::take() else { outcome::end(false) };
    systick::start(core.SYST);
    match (load(), supervise()) {
        (Some(arm), Ok(supervisor)) => {
            spawner.spawn(supervisor);
            outcome::end(control(&arm).await.is_some());
        }
        _ => outcome::end(false),
    }
}

/// Whatever else a controller does; here it only switches compensation on.
#[embassy_executor::task]
async fn supervise() {
    Timer::after(Duration::from_millis(SWITCHED_ON)).await;
    ACTIVE.store(true, Ordering::Relaxed);
}

/// The loop; `None` where a motion would have to stop.
async fn control(arm: &Arm6<'static, f32>) -> Option<()> {
    let state = arm.state();
    let settings = Settings { ramp_ticks: 200, ..Settings::new(Task::Position) };
    let mut compensator = Compensator::new(arm.clone(), settings, &command(0)).ok()?;
    let target = |q: &Joints| arm.nominal().forward(q).translation;
    let error = |q: &Joints, joints: &Joints| {
        (arm.real_pose_in(joints, &state).translation - target(q)).norm() * 1e6
    };

    let (mut off, mut on, mut ticks_on) = (0.0_f32, 0.0_f32, 0);
    let start = Instant::now();
    let mut every_millisecond = Ticker::every(Duration::from_millis(1));
    for tick in 0..DURATION {
        let q = command(tick);
        compensator.set_active(ACTIVE.load(Ordering::Relaxed));
        let done = compensator.tick(&q, &state);
        match done.status {
            Status::Off => off = off.max(error(&q, &done.joints)),
            Status::On => {
                on = on.max(error(&q, &done.joints));
                ticks_on += 1;
            }
            Status::Refused(_) => return None,
            _ => (),
        }
        every_millisecond.next().await;
    }
    let elapsed = start.elapsed().as_millis();
    hprintln!("embassy: {} ticks in {} ms, {} with compensation", DURATION, elapsed, ticks_on);
    hprintln!("embassy: tool off by {:.1} um without, {:.1} um with", off, on);
    // No tick came late, and compensation was on from the ramp's end.
    let in_time = elapsed.abs_diff(u64::from(DURATION)) <= 1;
    let expected = u64::from(DURATION) - SWITCHED_ON - 200;
    let switched = u64::abs_diff(ticks_on, expected) <= 2;
    (in_time && switched && off > 100.0 && on < 10.0).then_some(())
}
