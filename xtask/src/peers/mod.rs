//! `cargo xtask peers`: other people's kinematics beside truearm's, on one arm and the
//! same poses, in one run. What is set up stays in `target/peers`; nothing of it is a
//! dependency of the workspace.

mod arm;
mod program;
mod table;
mod urdf;

use std::path::Path;

use program::Program;
use table::Table;

use crate::run::{Result, step, target_dir};

/// Times that every program is started; they take turns.
const ROUNDS: usize = 15;
/// Largest difference of positions, m, that counts as the same arm. Batches in `f32`
/// are compared with single poses in `f32`.
const AGREES: f64 = 1e-9;
/// pybotics has no beta: its arm is another one by what the betas of this one do.
const WITHOUT_BETA: f64 = 5e-3;

pub fn run() -> Result {
    let folder = target_dir().join("peers");
    std::fs::create_dir_all(&folder)?;
    step("arm and poses", || arm::write(&folder))?;
    let programs = step("peers", || Program::set_up_all(&folder))?;
    step("agreement of positions", || {
        programs.iter().try_for_each(|program| agrees(program, &folder))
    })?;
    let mut table = Table::default();
    for round in 1..=ROUNDS {
        eprint!("\rround {round} of {ROUNDS}");
        for program in &programs {
            table.add(&program.output(&folder, "time")?);
        }
    }
    eprintln!();
    print!("{}", table.text(ROUNDS));
    Ok(())
}

/// Nothing is timed that computes something else.
fn agrees(program: &Program, folder: &Path) -> Result {
    for line in program.output(folder, "check")?.lines() {
        let words: Vec<_> = line.split_whitespace().collect();
        let ["deviation", peer, value] = words[..] else { continue };
        let bound = if peer == "pybotics" { WITHOUT_BETA } else { AGREES };
        eprintln!("  {peer:22} {value} m");
        if value.parse::<f64>()?.is_nan() || value.parse::<f64>()? > bound {
            return Err(format!("{peer} is {value} m off: another arm").into());
        }
    }
    Ok(())
}
