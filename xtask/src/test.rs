//! `cargo xtask test`: everything that is tested, on the host and under QEMU.

use crate::run::{Result, call, cargo, root, step};
use crate::{firmware, qemu};

pub fn run() -> Result {
    qemu::ensure_tools()?;
    step("host tests", || call(&mut cargo(&root(), "test --workspace")))?;
    firmware::run(None)?;
    eprintln!("\nok: host tests; firmware: image, proof of no panic, bits and budgets under QEMU");
    Ok(())
}
