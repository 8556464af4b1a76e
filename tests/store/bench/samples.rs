//! Blobs to store, made from the shipped one.

use crc::{CRC_32_ISCSI, Crc};
use truearm::blob::{Acceptance, Blob, encoded_len};

static SHIPPED: &[u8] = include_bytes!("../../data/firmware/ur10.blob");
static CRC32C: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// Takes the blobs of the robot they are all for.
pub fn mine() -> Acceptance {
    Acceptance::of(Blob::check(SHIPPED).expect("the shipped blob").robot_id())
}

/// Six joints. Blobs of other `contents` have other parameters.
pub fn full(sequence: u32, contents: u8) -> Vec<u8> {
    finished(SHIPPED.to_vec(), sequence, contents)
}

/// As few joints: short enough to try every pair of cuts.
pub fn small(joints: usize, sequence: u32, contents: u8) -> Vec<u8> {
    let size = encoded_len(joints, 0);
    let mut bytes = SHIPPED[..size].to_vec();
    bytes[6] = joints as u8;
    bytes[7] = 0;
    bytes[8..12].copy_from_slice(&(size as u32).to_le_bytes());
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
