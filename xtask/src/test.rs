//! `cargo xtask test`: everything that is tested, on the host and under QEMU.

use crate::run::{Result, call, cargo, root, step};
use crate::{c, demo, embassy, end_to_end, firmware, log, store, tools};

pub fn run() -> Result {
    tools::ensure()?;
    step("host tests", || call(&mut cargo(&root(), "test --workspace")))?;
    firmware::run(None)?;
    step("defmt log", log::check)?;
    step("control loop under embassy", embassy::check)?;
    c::run()?;
    end_to_end::run()?;
    store::run()?;
    step("an arm that mends itself", demo::check)?;
    eprintln!(
        "\nok: host tests; firmware: image, proof of no panic at two levels and on three targets, \
         bits and budgets under QEMU; log frames decoded; a loop under embassy; \
         the C library; \
         the line from tracker file to controller; \
         parameters that survive in an EEPROM; \
         an arm that notices what happened to it and mends itself"
    );
    Ok(())
}
