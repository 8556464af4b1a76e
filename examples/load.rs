//! Parameters from a slot of flash: whole and of this robot, or a reason why not.
//!
//! `cargo run --example load`

use truearm::blob::{Acceptance, AcceptanceError};
use truearm::{Arm6, Pose};

/// On a controller: the slot of memory.x into which `truearm pack` and a programmer put it.
static GOOD: &[u8] = include_bytes!("../tests/data/firmware/ur10-terms.blob");
/// Of this robot, as `truearm inspect` prints it for its own blob.
const ROBOT_ID: u64 = 0x544a_b5f3_0b94_225d;

/// Checked byte by byte, then folded once, with the production tool.
fn load(slot: &[u8], robot_id: u64) -> Result<Arm6<'_, f32>, AcceptanceError> {
    let parameters = Acceptance::of(robot_id, 6).check(slot)?.parameters()?;
    let mut arm = Arm6::new(&parameters);
    // In place: `with_tool` makes a second arm, 3 KB of stack.
    arm.set_tool(&Pose::translation(0.0, 0.0, 0.15));
    Ok(arm)
}

fn main() {
    let blank = [0xff; 4096];
    let mut damaged = GOOD.to_vec();
    damaged[200] ^= 1;
    let slots = [
        ("blank", blank.as_slice(), ROBOT_ID),
        ("damaged", &damaged, ROBOT_ID),
        ("another robot's", GOOD, ROBOT_ID + 1),
        ("good", GOOD, ROBOT_ID),
    ];
    let mut usable = 0;
    for (name, slot, robot_id) in slots {
        match load(slot, robot_id) {
            // The controller goes on with its own, nominal kinematics.
            Err(error) => println!("{name}: {error}"),
            Ok(arm) => {
                usable += 1;
                let q = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
                let (real, nominal) = (arm.real_pose(&q), arm.nominal().forward(&q));
                let off = (real.translation - nominal.translation).norm();
                println!("{name}: the tool is {:.2} mm off at {q:?}", off * 1e3);
                assert!((1e-4..1e-2).contains(&off), "millimetres, as an arm is off");
            }
        }
    }
    assert_eq!(usable, 1, "only the good one may be used");
}
