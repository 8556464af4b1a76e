//! New parameters while the controller runs: received into a buffer that is used again, asked
//! whether they are this robot's and newer, faded over to, and the old ones kept where they are
//! refused. In flash they go through the store, see the example `store`.
//!
//! `cargo run --example update`

use truearm::blob::{Acceptance, AcceptanceError, Blob, encode};
use truearm::compensate::{SettingError, Status};
use truearm::{Arm6, ArmParameters6, Compensator, Pose, Settings, State, Task};

/// What the arm works with from power-up on.
static FIRST: &[u8] = include_bytes!("../tests/data/firmware/ur10-terms.blob");
/// Of this robot, as `truearm inspect` prints it for its own blob.
const ROBOT_ID: u64 = 0x544a_b5f3_0b94_225d;

type Running = Compensator<'static, f32, 6>;

/// Why the arm goes on with the parameters that it has.
#[derive(Debug)]
enum Kept {
    Blob(AcceptanceError),
    /// It has curves, which stay in the buffer: such a blob needs a buffer of its own for as long
    /// as its arm is used, and a second one for the next. Of an arm whose curves lie in a slot of
    /// flash the other slot is the one to write to, as the store does.
    Curves,
    Settings(SettingError),
}

impl core::fmt::Display for Kept {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Blob(error) => error.fmt(f),
            Self::Curves => f.write_str("its curves need a buffer of their own"),
            Self::Settings(error) => error.fmt(f),
        }
    }
}

/// Called between two ticks, with compensation on or off. Nothing of `received` is borrowed
/// afterwards.
fn update(running: &mut Running, received: &[u8]) -> Result<(), Kept> {
    let newer = Acceptance::of(ROBOT_ID, 6).not_before(running.arm().sequence() + 1);
    let blob = newer.check(received).map_err(Kept::Blob)?;
    let parameters: ArmParameters6<'_, f32> =
        blob.parameters().map_err(|error| Kept::Blob(error.into()))?;
    let own = parameters.detached().ok_or(Kept::Curves)?;
    // With the production tool that it has.
    let arm = running.arm().with_parameters(&own);
    running.set_arm(arm).map_err(Kept::Settings)
}

/// Ticks until compensation is off and nothing is left of it, or on.
fn fade(running: &mut Running, active: bool, q: &[f32; 6], state: &State<f32, 6>) -> [f32; 6] {
    running.set_active(active);
    loop {
        let tick = running.tick(q, state);
        if matches!(tick.status, Status::Off | Status::On | Status::Refused(_)) {
            return tick.joints;
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let q = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
    let first: ArmParameters6<'_, f32> = Acceptance::of(ROBOT_ID, 6).check(FIRST)?.parameters()?;
    let mut arm = Arm6::new(&first);
    arm.set_tool(&Pose::translation(0.0, 0.0, 0.15));
    let state = arm.state();
    let mut running: Running = Compensator::new(arm, Settings::new(Task::Position), &q)?;
    let before = fade(&mut running, true, &q, &state);

    let mut buffer = [0xff; 1024];
    // The same once more: not newer.
    buffer.get_mut(..FIRST.len()).ok_or("too long")?.copy_from_slice(FIRST);
    match update(&mut running, &buffer) {
        Err(Kept::Blob(error)) => println!("kept: {error}"),
        other => return Err(format!("it is not newer, but: {other:?}").into()),
    }

    // An elbow that was found 2 mrad off.
    let mut next = first.clone();
    next.sequence += 1;
    next.corrections[2].theta += 2e-3;
    encode(&next, &mut buffer)?;
    // Without a step: off, and on again with the new ones. In motion `update` alone does, by at
    // most `max_change` a tick.
    fade(&mut running, false, &q, &state);
    assert!(running.is_idle());
    match update(&mut running, &buffer) {
        Ok(()) => println!("parameters {}", running.arm().sequence()),
        Err(kept) => return Err(kept.to_string().into()),
    }
    // The buffer is free for the next.
    buffer.fill(0xff);
    assert!(Blob::check(&buffer).is_err());
    let after = fade(&mut running, true, &q, &state);
    let moved = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    println!("the correction changed by {:.2} mrad", moved * 1e3);
    assert!((1e-3..4e-3).contains(&moved));
    Ok(())
}
