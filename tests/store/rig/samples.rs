//! Blobs to store, made from the shipped one.

use crc::{CRC_32_ISCSI, Crc};
use truearm::blob::{Acceptance, Blob, encoded_len};

static SHIPPED: &[u8] = include_bytes!("../../data/firmware/ur10.blob");
static CRC32C: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// Takes what the robot of this blob takes.
pub fn mine(blob: &[u8]) -> Acceptance {
    let blob = Blob::check(blob).expect("a valid sample");
    Acceptance::of(blob.robot_id(), blob.joints())
}

/// Six joints. Blobs of other `contents` have other parameters.
pub fn full(sequence: u32, contents: u8) -> Vec<u8> {
    finished(SHIPPED.to_vec(), sequence, contents)
}

/// As many joints and terms: with few it is short enough to try every pair of
/// cuts.
pub fn short(joints: usize, terms: usize, sequence: u32, contents: u8) -> Vec<u8> {
    let size = encoded_len(joints, terms);
    let mut bytes = SHIPPED[..encoded_len(joints.min(6), 0) - 4].to_vec();
    while bytes.len() < encoded_len(joints, 0) - 4 {
        bytes.extend_from_within(bytes.len() - 76..);
    }
    bytes[6] = joints as u8;
    bytes[7] = terms as u8;
    bytes[8..12].copy_from_slice(&(size as u32).to_le_bytes());
    // A gain of joint 1 that is none.
    bytes.extend([5, 0, 0, 0, 0, 0, 0, 0].repeat(terms));
    bytes.extend([0; 4]);
    finished(bytes, sequence, contents)
}

fn finished(mut bytes: Vec<u8>, sequence: u32, contents: u8) -> Vec<u8> {
    bytes[12..16].copy_from_slice(&sequence.to_le_bytes());
    // Low bits of a real number.
    bytes[40] ^= contents;
    seal(&mut bytes);
    Blob::check(&bytes).expect("a valid sample");
    bytes
}

/// Writes the checksum of the bytes as they are.
pub fn seal(bytes: &mut [u8]) {
    let (body, checksum) = bytes.split_last_chunk_mut::<4>().expect("a blob's length");
    *checksum = CRC32C.checksum(body).to_le_bytes();
}
