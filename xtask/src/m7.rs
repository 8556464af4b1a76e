//! The same image in `f64` on a Cortex-M7, whose unit has double precision.

use crate::image::{build_in, directory, image_in, qemu_command};
use crate::qemu;
use crate::run::{Result, call, target_dir};
use crate::vectors::{shipped, shipped_terms};

/// The last one given to rustc counts.
const CPU: &str = r#"target.thumbv7em-none-eabihf.rustflags=["-C","target-cpu=cortex-m7"]"#;

/// Builds it and runs it on both shipped blobs.
pub fn check() -> Result {
    let dir = target_dir().join("firmware-m7");
    call(build_in(&dir, "firmware").args(["--features", "f64", "--config", CPU]))?;
    for files in [shipped(), shipped_terms()] {
        let mut command = qemu_command(&image_in(&dir, "firmware"), &files)?;
        for word in &mut command {
            match word.as_str() {
                "mps2-an386" => *word = "mps2-an500".into(),
                "cortex-m4" => *word = "cortex-m7".into(),
                _ => (),
            }
        }
        let ended = qemu::run(&command, &directory())?;
        if !(ended.success && ended.output.contains("f64, poses: 1024")) {
            return Err("the image found a fault".into());
        }
    }
    Ok(())
}
