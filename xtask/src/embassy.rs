//! The control loop as an async task, under QEMU: the image judges itself.

use crate::image::{build_dir, build_of, directory, image, qemu_command};
use crate::qemu;
use crate::run::{Result, call};
use crate::vectors::shipped;

pub fn check() -> Result {
    call(&mut build_of(&build_dir(), "--bin embassy --features embassy"))?;
    let mut command = qemu_command(&image("embassy"), &shipped())?;
    // The executor waits for its next tick by running on, since QEMU waits for no event: 32 ns
    // an instruction, a processor of 31 MHz, make that 31 million instructions a second of
    // the board, and not a thousand million.
    for word in command.iter_mut().filter(|word| *word == "shift=0") {
        "shift=5".clone_into(word);
    }
    let ended = qemu::run(&command, &directory())?;
    // Without the line it did not get to the end of its loop.
    if ended.success && ended.output.contains("embassy: 1000 ticks in 1000 ms") {
        Ok(())
    } else {
        Err("the loop was late, or compensation did not work".into())
    }
}
