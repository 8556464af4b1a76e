//! Calibrated URDFs, as Pinocchio reads them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{LinkParameter, MdhParameters, Pose};
use truearm_host::convert::Identified;
use truearm_host::convert::presets::{PRESETS, Preset};
use truearm_host::convert::urdf::urdf_text;
use truearm_host::model::arm::chain;
use truearm_host::model::{Model, Robot};

use super::AGREES;
use crate::run::Result;

const SCRIPT: &str = include_str!("../../peers/urdf.py");
const POSES: usize = 1000;

/// Every preset with corrections drawn as an identification would find them.
pub fn check(python: &Path, folder: &Path) -> Result {
    let place = folder.join("urdf");
    fs::create_dir_all(&place)?;
    for (k, preset) in PRESETS.iter().enumerate() {
        write(preset, k as u64, &place)?;
    }
    let script = folder.join("urdf.py");
    fs::write(&script, SCRIPT)?;
    let output = Command::new(python).arg(&script).arg(&place).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let text = String::from_utf8(output.stdout)?;
    for line in text.lines() {
        eprintln!("  {line}");
        let off = line.split_whitespace().nth(2).and_then(|word| word.parse::<f64>().ok());
        if !off.is_some_and(|off| off < AGREES) {
            return Err(format!("{line}: Pinocchio reads another arm").into());
        }
    }
    if text.lines().count() != PRESETS.len() {
        return Err("not every URDF was read".into());
    }
    Ok(())
}

/// `NAME.urdf`, and `NAME.txt` with poses and the identified points.
fn write(preset: &Preset, seed: u64, place: &Path) -> Result {
    let robot = Robot::parse(Path::new(preset.name), preset.text)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut three = |size: f64| Vector3::<f64>::from_fn(|_, _| rng.random_range(-size..size));
    let mut model = Model::nominal(robot);
    model.frame_translation = three(1e-3);
    model.frame_rotation = three(1e-3);
    let marker = model.robot.tool + three(5e-3);
    model.markers = vec![(String::new(), marker)];
    for correction in &mut model.corrections {
        *correction = MdhParameters::from_array(LinkParameter::ALL.map(|_| three(1e-3).x));
    }
    let frame = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let base = model.robot.base.pose().compose(&frame);
    let arm = chain(&model.links(), base, marker);
    let mut rows = String::new();
    for _ in 0..POSES {
        let q: Vec<f64> = model.links().iter().map(|_| rng.random_range(-1.5..1.5)).collect();
        let point = arm.pose(&q).translation;
        let numbers = q.iter().chain(point.iter()).map(|value| format!("{value:e}"));
        writeln!(rows, "{}", numbers.collect::<Vec<_>>().join(" "))?;
    }
    fs::write(place.join(format!("{}.txt", preset.name)), rows)?;
    let identified = Identified::of(&model, None)?;
    fs::write(place.join(format!("{}.urdf", preset.name)), urdf_text(&model, &identified))?;
    Ok(())
}
