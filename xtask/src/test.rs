//! `cargo xtask test`: everything that is tested, on the host and under QEMU.

use crate::beside::Beside;
use crate::run::{Result, call, cargo, root, step};
use crate::{demo, end_to_end, store, tools};

/// `thorough`: what CI asks beside.
pub fn run(thorough: bool) -> Result {
    tools::ensure()?;
    let controller = Beside::start(if thorough { "controller --thorough" } else { "controller" })?;
    let host = step("host tests", || call(&mut cargo(&root(), "test --workspace")));
    match (host, controller.end()) {
        (Err(host), Err(controller)) => return Err(format!("{host}; {controller}").into()),
        (host, controller) => host.and(controller)?,
    }
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
