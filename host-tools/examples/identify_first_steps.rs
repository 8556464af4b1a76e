//! The calibration engineer's first ten lines, as a library.
//!
//! `cargo run --release -p truearm-host --example identify_first_steps`

use std::path::Path;

use truearm_host::blob::pack;
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Measurements, Robot};

fn main() -> truearm_host::Result<()> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/seed-table-8");
    let robot = Robot::read(&data.join("robot.toml"))?;
    let measurements = Measurements::read(&data.join("measurements.csv"), &robot)?;
    let found = identify(&robot, &measurements, &Options::default(), &|_done, _total| ())?;

    println!("wrong rows: {:?}", found.figures.outlier_rows);
    if let Some(held_out) = found.figures.cross_validated {
        println!("held-out error: {:.3} mm mean, {:.3} mm max", held_out.mean_mm, held_out.max_mm);
    }
    let blob = pack(&found.model, None)?;
    println!("parameter blob: {} bytes", blob.len());
    Ok(())
}
