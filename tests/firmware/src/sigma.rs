//! The uncertainty of the tool point at some poses, as bits. Shared by the image
//! and xtask.

use crc::{CRC_64_XZ, Crc};
use truearm::blob::{Blob, Covariance};
use truearm::{Arm, State};

use crate::vectors::{JOINTS, Joints, state};

/// Poses of a vector file that are taken.
pub const POSES: usize = 64;

static CRC64: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// One standard deviation of the tool point; zeros without a covariance of the
/// arm.
#[inline(never)]
pub fn sigma(
    blob: &Blob,
    arm: &Arm<f32, JOINTS>,
    q: &Joints,
    state: &State<f32, JOINTS>,
) -> [f32; 3] {
    let sigma = |covariance: Covariance| covariance.point_sigma(arm, q, state).ok();
    blob.covariance().and_then(sigma).unwrap_or([0.0; 3])
}

/// CRC-64/XZ of the bits of all.
pub fn hash(blob: &Blob, arm: &Arm<f32, JOINTS>, poses: impl Iterator<Item = Joints>) -> u64 {
    let mut digest = CRC64.digest();
    for (index, q) in poses.take(POSES).enumerate() {
        for value in sigma(blob, arm, &q, &state(index)) {
            digest.update(&value.to_le_bytes());
        }
    }
    digest.finalize()
}
