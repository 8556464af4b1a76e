//! What the log image logs. Shared with xtask, which computes the same on the
//! host, so it needs no std.

use truearm::blob::{Blob, DecodeError};
use truearm::{Arm, Compensator, RealPosition, Settings, State, Task, Tick};

const JOINTS: usize = 6;
type Joints = [f32; JOINTS];

/// In front of the robot, rad.
const START: Joints = [0.0, -1.2, 1.6, -1.2, -1.57, 0.0];
/// Stretched out, with the first and the last axis of the wrist in parallel.
const SINGULAR: Joints = [0.0; JOINTS];
/// The joint whose command is NaN in the end.
pub const REFUSED: usize = 3;

/// One of everything that firmware wants to log.
pub struct Events {
    /// Of a blob with one wrong bit.
    pub damaged: DecodeError,
    /// Of its first bytes.
    pub cut: DecodeError,
    pub position: RealPosition<f32>,
    pub off: Tick<f32, JOINTS>,
    pub ramping: Tick<f32, JOINTS>,
    pub on: Tick<f32, JOINTS>,
    pub singular: Tick<f32, JOINTS>,
    pub refused: Tick<f32, JOINTS>,
}

/// Of the blob at the front of `slot`; `None` if something did not come about.
pub fn events(slot: &[u8; 1024]) -> Option<Events> {
    let blob = Blob::check(slot).ok()?;
    let arm = Arm::new(&blob.parameters().ok()?);
    let mut damaged = *slot;
    *damaged.get_mut(100)? ^= 0x10;

    let state = State::at(24.0);
    let position = RealPosition::of(&arm, &START, &state);
    let settings = Settings { ramp_ticks: 2, ..Settings::new(Task::Pose) };
    let settings = settings.trusting_nominal_orientation();
    let mut compensator = Compensator::new(arm, settings, &START).ok()?;
    let off = compensator.tick(&START, &state);
    compensator.set_active(true);
    let mut blind = START;
    *blind.get_mut(REFUSED)? = f32::NAN;
    Some(Events {
        damaged: Blob::check(&damaged).err()?,
        cut: Blob::check(slot.get(..10)?).err()?,
        position,
        off,
        ramping: compensator.tick(&START, &state),
        on: compensator.tick(&START, &state),
        singular: compensator.tick(&SINGULAR, &state),
        refused: compensator.tick(&blind, &state),
    })
}
