//! The uncertainty of the tool point: the bits that the image computes from a
//! covariance in its slot must be those of the host.

#[path = "../../tests/firmware/src/sigma.rs"]
mod format;

use std::fs;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::{Blob, encode_with, encoded_len, factor_len};
use truearm::{Arm6, ArmParameters6};

use crate::image::{command_of, directory};
use crate::qemu;
use crate::run::{Result, target_dir};
use crate::vectors::{Files, Vectors, shipped_terms};

/// Runs the image on the shipped arm with terms and an invented covariance;
/// what it printed.
pub fn check() -> Result<String> {
    let Files { blob, vectors } = shipped_terms();
    let bytes = with_covariance(&fs::read(blob)?)?;
    let blob = Blob::check(&bytes)?;
    let arm = Arm6::new(&blob.parameters()?);
    let file = fs::read(&vectors)?;
    let poses = Vectors::parse(&file).map_err(|error| error.to_string())?.poses();
    let expected = format!("sigma: {:016x}", format::hash(&blob, &arm, poses));

    let path = target_dir().join("firmware/covariance.blob");
    fs::write(&path, &bytes)?;
    let command = command_of("sigma", &Files { blob: path, vectors })?;
    let ended = qemu::run(&command, &directory())?;
    if !ended.success || !ended.output.lines().any(|line| line == expected) {
        return Err(format!("the host computed {expected}").into());
    }
    Ok(ended.output)
}

/// The blob with a covariance of millimetres and milliradians.
fn with_covariance(blob: &[u8]) -> Result<Vec<u8>> {
    let parameters: ArmParameters6<f32> = Blob::check(blob)?.parameters()?;
    let size = parameters.terms.len();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    // No entry of a diagonal is negative.
    let factor: Vec<f32> = (0..factor_len(6, size)).map(|_| rng.random_range(0.0..1e-3)).collect();
    let mut bytes = vec![0; encoded_len(6, size) + 4 * factor.len()];
    encode_with(&parameters, Some(&factor), &mut bytes)?;
    Ok(bytes)
}
