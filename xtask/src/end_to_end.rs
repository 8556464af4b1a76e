//! The whole line: a tracker's file is identified and packed by the program a
//! user has, and the controller image computes the same poses from that blob,
//! bit for bit.

use crate::image;
use crate::run::{Result, call, program, root, step, target_dir};

pub fn run() -> Result {
    let out = target_dir().join("line");
    let data = root().join("tests/data/ur10-ipa");
    let blob = out.join("params.bin");
    step("identification of the shipped UR10", || {
        let mut identify = program()?;
        identify
            .arg("identify")
            .arg(data.join("robot.toml"))
            .arg(data.join("series-b/measurements.csv"));
        call(identify.arg("--out").arg(&out))?;
        call(program()?.arg("pack").arg(out.join("model.toml")).arg("--out").arg(&blob))
    })?;
    step("its blob on the controller", || image::run_image(&image::files_for(&blob)?).map(drop))
}
