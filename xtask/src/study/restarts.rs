//! The board's power fails at random moments while it stores one set of
//! parameters after the other. QEMU is ended from outside by its own id.

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::ArmParameters;
use truearm::blob::Blob;

use crate::board::Board;
use crate::image::build;
use crate::run::{Result, call};
use crate::vectors;

/// So many cuts fall while the board starts, up to this long after it was
/// switched on. The others fall into a store.
const STARTING: f64 = 0.1;
const START: Duration = Duration::from_millis(300);

#[derive(Args)]
pub struct Options {
    /// How often the power fails
    #[arg(long, default_value_t = 1000)]
    cycles: u32,
    /// Of the random moments
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub fn study(options: &Options) -> Result {
    call(&mut build("store"))?;
    run(options.cycles, options.seed)
}

/// Cuts the power `cycles` times. After each cut the newest blob in the EEPROM
/// must be whole, and not older than the last store that was reported done.
pub fn run(cycles: u32, seed: u64) -> Result {
    let blob = fs::read(vectors::shipped().blob)?;
    let robot = Blob::check(&blob)?.robot_id();
    let board = Board::new("restarts", &blob, robot)?;
    let store_time = store_time(&board)?;
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let (mut before_open, mut during, mut between, mut settled) = (0, 0, 0, 0);
    let mut known = sequence(&board.found()?.ok_or("no parameters after an uncut store")?)?;
    let first = known;
    for cycle in 0..cycles {
        let mut running = board.start("churn", 20_000, None)?;
        let longest = if dice.random_bool(STARTING) {
            START
        } else {
            // A loaded host takes long to get this far.
            running.wait_for("storing: ", dice.random_range(1..=3))?;
            store_time
        };
        thread::sleep(longest.mul_f64(dice.random()));
        let output = running.cut()?;
        let fail = |why: String| format!("cycle {cycle}: {why}; the image printed:\n{output}");
        if output.contains("FAILED") || output.contains("panicked") {
            return Err(fail("the image found a fault".into()).into());
        }
        if let Some(found) = number(&output, "sequence: ").filter(|found| *found != known) {
            return Err(fail(format!("booted with {found}, {known} was in the EEPROM")).into());
        }
        let rewritten = ["settled: Rewritten", "settled: Erased"];
        settled += u32::from(rewritten.iter().any(|line| output.contains(line)));
        let stored = number(&output, "stored: ").unwrap_or(known);
        let storing = number(&output, "storing: ").unwrap_or(stored);
        match (output.contains("settled: "), storing > stored) {
            (false, _) => before_open += 1,
            (true, true) => during += 1,
            (true, false) => between += 1,
        }
        let found = board.found()?.ok_or_else(|| fail("no parameters are left".into()))?;
        known = sequence(&found)?;
        if !(stored..=storing).contains(&known) {
            return Err(fail(format!("{known} found, {stored} to {storing} possible")).into());
        }
        check_contents(&found).map_err(|error| fail(error.to_string()))?;
    }
    if 2 * during < cycles {
        return Err(format!("only {during} of {cycles} cuts fell into a store").into());
    }
    println!(
        "{cycles} power cuts: {during} while storing, {between} between two stores, {before_open} \
         before the slots were read; {settled} unfinished stores ended or undone at power-up; \
         {} sets stored, none lost",
        known - first
    );
    Ok(())
}

/// How long the emulated board takes for a store on this host.
fn store_time(board: &Board) -> Result<Duration> {
    let mut running = board.start("churn", 20_000, None)?;
    running.wait_for("storing: ", 1)?;
    let start = Instant::now();
    running.wait_for("stored: ", 1)?;
    let time = start.elapsed();
    running.cut()?;
    Ok(time)
}

fn sequence(blob: &[u8]) -> Result<u32> {
    Ok(Blob::check(blob)?.sequence())
}

/// The image gives every set a tool point of its own.
fn check_contents(blob: &[u8]) -> Result {
    let parameters: ArmParameters<f32, 6> = Blob::check(blob)?.parameters()?;
    let wanted = (parameters.sequence % 1000) as f32 * 1e-4;
    if parameters.tool.x == wanted {
        Ok(())
    } else {
        Err(format!("set {} has the tool of another one", parameters.sequence).into())
    }
}

/// The last number that follows this text at the start of a line.
fn number(output: &str, text: &str) -> Option<u32> {
    // A line that the cut tore has no end.
    let whole = output.rsplit_once('\n')?.0;
    whole.lines().rev().find_map(|line| line.strip_prefix(text)?.parse().ok())
}
