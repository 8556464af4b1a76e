//! Compensation in every control tick: the joints at which the real tool is
//! where the nominal model, which is the controller's own, says it is.
//!
//! `cargo run --example tick`

use truearm::blob::Blob;
use truearm::compensate::Status;
use truearm::{Arm6, Compensator, Settings, Task};

/// Whose it is, is asked in the example `load`.
static SLOT: &[u8] = include_bytes!("../tests/data/firmware/ur10.blob");

/// Here the motion would come from the inverse kinematics, rad.
fn command(tick: u16) -> [f32; 6] {
    let along = f32::from(tick) * 1e-3;
    [0.3 * along, -1.2, 1.6 - 0.2 * along, -1.2, -1.57, 0.0]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arm = Arm6::<f32>::new(&Blob::check(SLOT)?.parameters()?);
    // What else is known of the arm: payload, temperature, how joints came to rest.
    let state = arm.state();
    let settings = Settings { ramp_ticks: 200, ..Settings::new(Task::Position) };
    let mut compensator = Compensator::new(arm.clone(), settings, &command(0))?;
    compensator.set_active(true);

    let mut worst_when_on = 0.0_f32;
    for tick in 0..1000 {
        let q = command(tick);
        let done = compensator.tick(&q, &state);
        let target = arm.nominal().forward(&q).translation;
        let error = |joints| (arm.real_pose_in(joints, &state).translation - target).norm() * 1e3;
        let (without, with) = (error(&q), error(&done.joints));
        match done.status {
            // The joints are safe to command, but nobody knows where to.
            Status::Refused(reason) => return Err(format!("stop the motion: {reason:?}").into()),
            Status::On => {
                worst_when_on = worst_when_on.max(with);
                // Near a singular pose, or held back by a limit: better than
                // without, and `left` says by what it misses.
                if !done.clamped.is_empty() {
                    println!("tick {tick}: {:?} left", done.left.map(|left| left.position));
                }
            }
            // Off, being faded in or out.
            _ => (),
        }
        if tick % 100 == 0 {
            println!("tick {tick:3} {:?}: {without:.3} mm without, {with:.4} mm", done.status);
        }
    }
    println!("largest error while on: {worst_when_on:.4} mm");
    assert!(worst_when_on > 0.0 && worst_when_on < 0.01);
    Ok(())
}
