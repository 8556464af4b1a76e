use core::ops::Range;

use crc::{CRC_64_XZ, Crc};

use super::crc32c::Crc32c;

/// First four bytes of every blob.
pub const MAGIC: [u8; 4] = *b"TARM";
/// The layout this version writes and reads: formats 1.0 to 1.6.
pub const LAYOUT: u16 = 3;
/// Bytes of an authentication tag.
pub const TAG: usize = 32;

pub(super) const HEADER: usize = 104;
pub(super) const RECORD: usize = 76;
pub(super) const TERM: usize = 8;
pub(super) const CHECKSUM: usize = 4;

// Fields of the header that are read or changed by themselves.
pub(super) const LENGTH: Range<usize> = 8..12;
pub(super) const SEQUENCE: Range<usize> = 12..16;
pub(super) const ROBOT_ID: Range<usize> = 16..24;
pub(super) const CREATED: Range<usize> = 24..28;
pub(super) const FLAGS: usize = 28;

pub(super) const FLAG_ORIENTATION: u8 = 1;
pub(super) const FLAG_MASSES: u8 = 2;
pub(super) const FLAG_COVARIANCE: u8 = 4;
pub(super) const FLAG_TAG: u8 = 8;
pub(super) const FLAG_CURVES: u8 = 16;
/// Terms follow torques that are read; there are no masses.
pub(super) const FLAG_TORQUES: u8 = 32;
/// Without the feature no reader knows of curves, as firmware of format 1.1.
pub(super) const KNOWN_FLAGS: u8 = {
    let known = FLAG_ORIENTATION | FLAG_MASSES | FLAG_COVARIANCE | FLAG_TAG | FLAG_TORQUES;
    if cfg!(feature = "curves") { known | FLAG_CURVES } else { known }
};
pub(super) const HAS_LIMITS: u8 = 1;
pub(super) const HAS_COVERED: u8 = 2;

/// Bytes of a blob for this many joints and terms, without covariance, without
/// curves, of which each takes [`super::curve_len`] more, and without tag, which takes
/// [`TAG`] more.
#[must_use]
pub const fn encoded_len(joints: usize, terms: usize) -> usize {
    HEADER + RECORD * joints + TERM * terms + CHECKSUM
}

/// Parameters that a covariance speaks of: 6 of the base, 3 of the tool point,
/// 5 a joint, 1 a term.
#[must_use]
pub const fn uncertain_parameters(joints: usize, terms: usize) -> usize {
    9 + 5 * joints + terms
}

/// Numbers of the triangular factor of a covariance, 4 bytes each in a blob.
#[must_use]
pub const fn factor_len(joints: usize, terms: usize) -> usize {
    let p = uncertain_parameters(joints, terms);
    p * (p + 1) / 2
}

pub(super) fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = Crc32c::new();
    crc.update(bytes);
    crc.value()
}

/// The id a blob carries: CRC-64/XZ of model name, a zero byte, and serial.
/// A controller compares it with its own and refuses another robot's blob.
///
/// ```
/// use truearm::blob::robot_id;
///
/// const MINE: u64 = robot_id("UR10", "2019300");
/// assert_ne!(MINE, robot_id("UR10", "2019301"));
/// ```
#[must_use]
pub const fn robot_id(name: &str, serial: &str) -> u64 {
    const CRC64: Crc<u64, crc::NoTable> = Crc::<u64, crc::NoTable>::new(&CRC_64_XZ);
    let mut digest = CRC64.digest();
    digest = update(digest, name.as_bytes());
    digest = update(digest, &[0]);
    digest = update(digest, serial.as_bytes());
    return digest.finalize();

    const fn update<'a>(
        digest: crc::Digest<'a, u64, crc::NoTable>,
        bytes: &[u8],
    ) -> crc::Digest<'a, u64, crc::NoTable> {
        let mut digest = digest;
        digest.update(bytes);
        digest
    }
}
