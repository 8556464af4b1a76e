//! The proof that nothing a controller calls can panic: the image `no_panic`
//! links, and with a panic built in it does not. By target and optimisation
//! level, for what one optimiser proves another need not.

use crate::image::{CURVES, PANIC_SYMBOL, build_for};
use crate::run::{Result, call, cargo, root, step};
use crate::tools::{OTHERS, RISC_V, TARGET};

/// What a test run proves.
pub fn usual() -> Result {
    for level in ["3", "s"] {
        prove(TARGET, level)?;
    }
    OTHERS.iter().try_for_each(|target| prove(target, "s"))
}

/// The rest.
pub fn others() -> Result {
    prove(TARGET, "z")?;
    for target in OTHERS {
        for level in ["3", "z"] {
            prove(target, level)?;
        }
    }
    step(&format!("the crate for {RISC_V}"), || {
        let build = format!("build --release -p truearm --all-features --target {RISC_V}");
        call(&mut cargo(&root(), &build))
    })
}

fn prove(target: &str, level: &str) -> Result {
    step(&format!("proof of no panic: {target}, opt-level {level}"), || {
        call(build_for(target, level, "no_panic").args(CURVES))?;
        let mut control = build_for(target, level, "no_panic");
        let output = control.args(["--features", "negative_control,curves"]).output()?;
        let message = String::from_utf8_lossy(&output.stderr);
        if output.status.success() {
            return Err("the negative control links: the proof proves nothing".into());
        }
        if !message.contains(PANIC_SYMBOL) {
            return Err(format!("the negative control failed otherwise:\n{message}").into());
        }
        eprintln!("it links; with a panic built in it does not ({PANIC_SYMBOL})");
        Ok(())
    })
}
