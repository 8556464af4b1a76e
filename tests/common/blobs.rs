//! Blobs to test on.

#![allow(dead_code, reason = "each test file uses a part")]

use truearm::ArmParameters;
use truearm::blob::Blob;
use truearm::effects::{Effect, Term};

/// Six joints, masses, 24 terms: the shipped UR10 with terms of every effect.
pub fn full() -> Vec<u8> {
    include_bytes!("../data/firmware/ur10-terms.blob").to_vec()
}

/// Tables of 32 and 64 nodes for joints 2 and 5.
#[cfg(feature = "curves")]
pub fn curve_bytes() -> Vec<u8> {
    use truearm::blob::{curve_len, encode_curve};
    let node = |k: usize| (k.wrapping_mul(2_654_435_761) >> 5) as i16;
    let mut out = vec![0; curve_len(32) + curve_len(64)];
    let (first, second) = out.split_at_mut(curve_len(32));
    let nodes: Vec<i16> = (1..=96).map(node).collect();
    encode_curve(1, 1.5e-8, 2e-5, &nodes[..32], first).unwrap();
    encode_curve(4, 1e-8, 3e-5, &nodes[32..], second).unwrap();
    out
}

/// The shipped UR10 with terms of every effect and these curves.
#[cfg(feature = "curves")]
pub fn curved() -> Vec<u8> {
    let (full, table) = (full(), curve_bytes());
    let mut parameters = Blob::check(&full).unwrap().parameters::<f32, 6>().unwrap();
    parameters.curves = truearm::Curves::of(&table).unwrap();
    let mut bytes = vec![0; full.len() + table.len()];
    truearm::blob::encode(&parameters, &mut bytes).unwrap();
    bytes
}

/// The same with a tag.
#[cfg(feature = "curves")]
pub fn tagged_curved() -> Vec<u8> {
    with_tag(curved())
}

/// [`full`] with a tag, of which the checksum knows nothing more than that it
/// is there.
pub fn tagged() -> Vec<u8> {
    with_tag(full())
}

fn with_tag(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len() - 4);
    bytes[28] |= 8;
    bytes.extend((0..32).map(|k: u8| k.wrapping_mul(41)));
    let length = bytes.len() as u32 + 4;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes.extend([0; 4]);
    mend(&mut bytes);
    bytes
}

/// Writes the right checksum, as only a faulty writer would.
pub fn mend(bytes: &mut [u8]) {
    let body = bytes.len() - 4;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&bytes[..body]);
    bytes[body..].copy_from_slice(&crc.to_le_bytes());
}

pub fn term(effect: Effect, joint: u8, order: f32, coefficient: f32) -> Term<f32> {
    Term { effect, joint, source: 0, component: 0, order, coefficient }
}

/// Three joints, one of them prismatic, with everything; `tests/blob/golden.rs` has
/// the values.
pub fn parameters() -> ArmParameters<'static, f32, 3> {
    let bytes = include_bytes!("../data/golden/layout-3-full.blob");
    Blob::check(bytes).unwrap().parameters().unwrap()
}
