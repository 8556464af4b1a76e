//! The firmware engineer's first ten lines: parameters from flash, then the
//! real tool pose in every tick. Runs on the host as it stands.
//!
//! `cargo run --example controller_first_steps`

use truearm::blob::{Blob, DecodeError};
use truearm::{Arm6, Pose};

/// On a controller this is the parameter slot of memory.x.
static SLOT: &[u8] = include_bytes!("../tests/data/firmware/ur10.blob");

fn main() -> Result<(), DecodeError> {
    let parameters = Blob::check(SLOT)?.parameters::<f32, 6>()?;
    let arm = Arm6::new(&parameters).with_tool(Pose::translation(0.0, 0.0, 0.15));

    let encoders = [0.3, -1.2, 1.5, -0.4, 1.1, 0.0];
    let believed = arm.nominal().forward(&encoders).translation;
    let real = arm.real_pose(&encoders).translation;

    println!("believed  {:.4} {:.4} {:.4} m", believed.x, believed.y, believed.z);
    println!("real      {:.4} {:.4} {:.4} m", real.x, real.y, real.z);
    println!("inside the identified joint ranges: {}", arm.covers(&encoders));
    Ok(())
}
