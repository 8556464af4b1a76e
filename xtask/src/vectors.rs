//! `cargo xtask vectors BLOB`, and vector files for the firmware run.

#[path = "../../tests/firmware/src/vectors.rs"]
mod format;

use std::fs;
use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Arm;
use truearm::blob::Blob;

use crate::run::{Result, root};
use format::{JOINTS, Joints, MAGIC, Vectors};

const POSES: usize = 1024;

/// The shipped blob and vector file, as tests and image find them.
pub fn shipped() -> (PathBuf, PathBuf) {
    let dir = root().join("tests/data/firmware");
    (dir.join("ur10.blob"), dir.join("fk.vectors"))
}

/// Rewrites the shipped files for this blob.
pub fn ship(blob: &Path) -> Result {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut angle = || rng.random_range(-core::f32::consts::TAU..=core::f32::consts::TAU);
    let poses: Vec<Joints> = (0..POSES).map(|_| [0; JOINTS].map(|_| angle())).collect();
    let bytes = fs::read(blob).map_err(|error| format!("{}: {error}", blob.display()))?;
    let vectors = file(&bytes, &poses)?;
    let (shipped_blob, shipped_vectors) = shipped();
    fs::write(&shipped_blob, bytes)?;
    fs::write(&shipped_vectors, vectors)?;
    println!("wrote {} and {}", shipped_blob.display(), shipped_vectors.display());
    Ok(())
}

/// The shipped poses with the hash that the host computes for this blob.
pub fn for_blob(blob: &Path) -> Result<Vec<u8>> {
    let bytes = fs::read(blob).map_err(|error| format!("{}: {error}", blob.display()))?;
    let shipped = fs::read(shipped().1)?;
    let poses: Vec<Joints> =
        Vectors::parse(&shipped).map_err(|error| error.to_string())?.poses().collect();
    file(&bytes, &poses).map_err(|error| format!("{}: {error}", blob.display()).into())
}

fn file(blob: &[u8], poses: &[Joints]) -> Result<Vec<u8>> {
    let arm = Arm::new(&Blob::check(blob)?.parameters::<f32, JOINTS>()?);
    let hash = format::hash(&arm, poses.iter().copied());
    let mut bytes = MAGIC.to_vec();
    for word in [poses.len() as u32, JOINTS as u32, 0] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(hash.to_le_bytes());
    bytes.extend(poses.iter().flatten().flat_map(|angle| angle.to_le_bytes()));
    Ok(bytes)
}
