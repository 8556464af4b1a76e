//! `cargo xtask controller`: everything that is built for a controller.

use crate::run::{Result, step};
use crate::study::fuzz;
use crate::{c, embassy, firmware, log, proof, tools};

/// What a test run asks; `thorough`, what CI asks beside.
pub fn run(thorough: bool) -> Result {
    tools::ensure()?;
    firmware::run(None)?;
    step("defmt log", log::check)?;
    step("control loop under embassy", embassy::check)?;
    c::run()?;
    if thorough {
        proof::others()?;
        c::miri()?;
        // Of each target: half a minute for both.
        fuzz::run(&["-max_total_time=15".to_owned()])?;
    }
    Ok(())
}
