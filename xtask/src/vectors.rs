//! `cargo xtask vectors`, and vector files for the firmware run.

#[path = "../../tests/firmware/src/vectors.rs"]
mod format;

use std::fs;
use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::{Blob, curve_len, encode, encode_curve, encoded_len};
use truearm::effects::{Curve, Effect, MAX_TERMS, Term};
use truearm::{Arm, ArmParameters, Curves};

use crate::run::{Result, root};
pub use format::{JOINTS, Joints, Vectors, state};

use format::{HEADER, MAGIC};

const POSES: usize = 1024;

/// A parameter blob and the vector file for it.
pub struct Files {
    pub blob: PathBuf,
    pub vectors: PathBuf,
}

fn shipped_as(blob: &str, vectors: &str) -> Files {
    let dir = root().join("tests/data/firmware");
    Files { blob: dir.join(blob), vectors: dir.join(vectors) }
}

/// The shipped arm without terms, as tests and image find it.
pub fn shipped() -> Files {
    shipped_as("ur10.blob", "fk.vectors")
}

/// The same arm with terms of every effect.
pub fn shipped_terms() -> Files {
    shipped_as("ur10-terms.blob", "terms.vectors")
}

/// The same arm with curves, compliance and what else a real arm of its kind has.
pub fn shipped_curves() -> Files {
    shipped_as("ur10-curves.blob", "curves.vectors")
}

/// Rewrites the shipped files for this blob; without one only what follows from
/// the shipped blob.
pub fn ship(blob: Option<&Path>) -> Result {
    let blob = &blob.map_or_else(|| shipped().blob, Path::to_owned);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut angle = || rng.random_range(-core::f32::consts::TAU..=core::f32::consts::TAU);
    let poses: Vec<Joints> = (0..POSES).map(|_| [0; JOINTS].map(|_| angle())).collect();
    let bytes = fs::read(blob).map_err(|error| format!("{}: {error}", blob.display()))?;
    let with_terms = with_terms(&bytes)?;
    let with_curves = with_curves(&with_terms, &mut rng)?;
    let blobs =
        [(shipped(), bytes), (shipped_terms(), with_terms), (shipped_curves(), with_curves)];
    for (files, bytes) in blobs {
        let vectors = file(&bytes, &poses)?;
        fs::write(&files.vectors, vectors)?;
        fs::write(&files.blob, &bytes)?;
        println!(
            "wrote {} ({} bytes) and {}",
            files.blob.display(),
            bytes.len(),
            files.vectors.display()
        );
    }
    Ok(())
}

/// The blob with as many terms as there is room for, of every effect, with
/// invented coefficients.
fn with_terms(blob: &[u8]) -> Result<Vec<u8>> {
    let mut parameters: ArmParameters<f32, JOINTS> = Blob::check(blob)?.parameters()?;
    let terms: Vec<_> = invented_terms().collect();
    parameters.terms = heapless::Vec::from_slice(&terms)?;
    let mut bytes = vec![0; encoded_len(JOINTS, MAX_TERMS)];
    encode(&parameters, &mut bytes)?;
    Ok(bytes)
}

/// The blob with invented curves in the joints 1 to 5 and nine of its terms: compliance
/// of three joints and of the base, a line of the gear, play in two joints.
fn with_curves(blob: &[u8], rng: &mut ChaCha8Rng) -> Result<Vec<u8>> {
    // Noise of some 0.4 mrad, as smooth as two nodes.
    const SMOOTH: [i32; 7] = [1, 6, 15, 20, 15, 6, 1];
    let mut tables = Vec::new();
    for joint in 0..5 {
        let noise: Vec<i32> =
            (0..Curve::USUAL_NODES).map(|_| rng.random_range(-32_767..=32_767)).collect();
        let node = |k: usize| {
            let near = SMOOTH.iter().enumerate().map(|(i, w)| w * noise[(k + i) % noise.len()]);
            (near.sum::<i32>() / 64) as i16
        };
        let nodes: Vec<i16> = (0..noise.len()).map(node).collect();
        let mut table = vec![0; curve_len(nodes.len())];
        encode_curve(joint, 4.7e-8, 2e-5, &nodes, &mut table)?;
        tables.extend(table);
    }
    let mut parameters: ArmParameters<f32, JOINTS> = Blob::check(blob)?.parameters()?;
    use Effect::*;
    let chosen = [JointCompliance, BaseCompliance, GearTransmissionError, Backlash];
    parameters.terms.retain(|term| chosen.contains(&term.effect));
    // Half the gap by direction, which gravity does not decide.
    let gap = |term: &mut Term<f32>| term.order = 0.0;
    parameters.terms.iter_mut().filter(|term| term.effect == Backlash).for_each(gap);
    let _ = parameters.terms.pop();
    parameters.curves = Curves::of(&tables)?;
    let mut bytes = vec![0; encoded_len(JOINTS, parameters.terms.len()) + tables.len()];
    encode(&parameters, &mut bytes)?;
    Ok(bytes)
}

fn invented_terms() -> impl Iterator<Item = Term<f32>> {
    use Effect::*;
    let all = Term::<f32>::ALL;
    // Effect, joint, source joint, component, order, coefficient.
    [
        (JointCompliance, 1, 0, 0, 0.0, 2.3e-5),
        (JointCompliance, 2, 0, 0, 0.0, 3.1e-5),
        (JointCompliance, 3, 0, 0, 0.0, 4.7e-5),
        (JointStiffening, 1, 0, 0, 0.0, -1.3e-7),
        (LateralCompliance, 2, 0, 0, 0.0, 1.3e-5),
        (BaseCompliance, 0, 0, 0, 0.0, 1.7e-6),
        (BaseCompliance, 0, 0, 1, 0.0, 2.9e-6),
        (EncoderEccentricity, 0, 0, 0, 1.0, 1.9e-4),
        (EncoderEccentricity, 0, 0, 1, 1.0, -1.3e-4),
        (EncoderEccentricity, 2, 0, 0, 2.0, 0.7e-4),
        (EncoderEccentricity, 2, 0, 1, 2.0, 1.1e-4),
        (GearTransmissionError, 1, 0, 0, 202.0, 2.1e-5),
        (GearTransmissionError, 1, 0, 1, 202.0, -3.7e-5),
        (JointPeriodicError, 3, 0, 0, 7.5, 5.3e-5),
        (JointPeriodicError, 3, 0, 1, 7.5, -4.1e-5),
        (JointPeriodicError, 4, 0, 0, 17.25, 2.7e-5),
        (JointGain, 1, 0, 0, 0.0, 3.3e-5),
        (JointCoupling, 5, 4, 0, 0.0, 8.3e-5),
        (JointCoupling, 4, 3, 0, 0.0, -2.3e-5),
        (Backlash, 1, 0, 0, 20.0, 1.2e-4),
        (Backlash, 2, 0, 0, 0.0, 0.9e-4),
        (Backlash, 4, 0, 0, 0.5, 1.6e-4),
        (ThermalExpansion, all, 0, 0, 0.0, 1.2e-5),
        (ThermalExpansion, 2, 0, 0, 0.0, 1.1e-5),
    ]
    .into_iter()
    .map(|(effect, joint, source, component, order, coefficient)| Term {
        effect,
        joint,
        source,
        component,
        order,
        coefficient,
    })
}

/// The shipped poses with the hash that the host computes for this blob.
pub fn for_blob(blob: &Path) -> Result<Vec<u8>> {
    let bytes = fs::read(blob).map_err(|error| format!("{}: {error}", blob.display()))?;
    let shipped = fs::read(shipped().vectors)?;
    let poses: Vec<Joints> =
        Vectors::parse(&shipped).map_err(|error| error.to_string())?.poses().collect();
    file(&bytes, &poses).map_err(|error| format!("{}: {error}", blob.display()).into())
}

fn file(blob: &[u8], poses: &[Joints]) -> Result<Vec<u8>> {
    let single = Arm::new(&Blob::check(blob)?.parameters::<f32, JOINTS>()?);
    let single = format::hashes(&single, poses.iter().copied());
    let double = Arm::new(&Blob::check(blob)?.parameters::<f64, JOINTS>()?);
    let double = format::hashes(&double, poses.iter().map(|q| q.map(f64::from)));
    let mut bytes = MAGIC.to_vec();
    for word in [poses.len() as u32, JOINTS as u32, 0] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(single.iter().chain(&double).flat_map(|hash| hash.to_le_bytes()));
    debug_assert_eq!(bytes.len(), HEADER);
    bytes.extend(poses.iter().flatten().flat_map(|angle| angle.to_le_bytes()));
    Ok(bytes)
}
