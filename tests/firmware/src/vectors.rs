//! The vector file: joint angles and the hash of the poses they must give.
//! Shared by the image, the host test and xtask, so it needs no std.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | 4 bytes | `TAFK` |
//! | 4 | u32 | poses |
//! | 8 | u32 | joints |
//! | 12 | u32 | 0 |
//! | 16 | u64 | expected hash, see [`hash`] |
//! | 24 | f32 ... | poses * joints angles in rad |
//!
//! All little-endian.

#![allow(dead_code, reason = "each of its three users needs a part")]

use core::fmt;

use crc::{CRC_64_XZ, Crc};
use truearm::{Arm, Pose, State};

/// First four bytes of a vector file.
pub const MAGIC: [u8; 4] = *b"TAFK";
/// Bytes before the angles.
pub const HEADER: usize = 24;
/// Joints of the arm under test.
pub const JOINTS: usize = 6;

/// One pose's joint angles, rad.
pub type Joints = [f32; JOINTS];

static CRC64: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// A vector file in place.
#[derive(Debug, Clone, Copy)]
pub struct Vectors<'a> {
    /// Hash that the poses must give.
    pub expected: u64,
    angles: &'a [u8],
}

/// Why bytes are not a vector file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorError {
    /// Does not begin with `TAFK`.
    NoVectors,
    /// For arms with this many joints.
    Joints(u32),
    /// Ends before its last pose.
    Truncated,
}

impl fmt::Display for VectorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoVectors => f.write_str("does not begin with TAFK: no vector file"),
            Self::Joints(n) => write!(f, "vectors for {n} joints, the arm has {JOINTS}"),
            Self::Truncated => f.write_str("the vector file ends before its last pose"),
        }
    }
}

impl<'a> Vectors<'a> {
    /// Finds a vector file in the front of `bytes`.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, VectorError> {
        let (header, rest) = bytes.split_first_chunk::<HEADER>().ok_or(VectorError::NoVectors)?;
        let word = |index: usize| {
            let bytes = header.as_chunks::<4>().0.get(index).copied().unwrap_or_default();
            u32::from_le_bytes(bytes)
        };
        if word(0).to_le_bytes() != MAGIC {
            return Err(VectorError::NoVectors);
        }
        if word(2) as usize != JOINTS {
            return Err(VectorError::Joints(word(2)));
        }
        let angles = (word(1) as usize).checked_mul(JOINTS * 4).and_then(|size| rest.get(..size));
        let expected = u64::from(word(5)) << 32 | u64::from(word(4));
        Ok(Self { expected, angles: angles.ok_or(VectorError::Truncated)? })
    }

    /// The joint angles of each pose.
    pub fn poses(&self) -> impl ExactSizeIterator<Item = Joints> + use<'a> {
        let (poses, _) = self.angles.as_chunks::<{ JOINTS * 4 }>();
        poses.iter().map(|pose| {
            let mut angles = pose.as_chunks::<4>().0.iter();
            [0; JOINTS].map(|_| f32::from_le_bytes(angles.next().copied().unwrap_or_default()))
        })
    }
}

/// The state of the arm at the `index`-th pose, so that every value a term
/// depends on varies: directions through all of -1, 0, +1, payload 0 to 10 kg,
/// temperature 10 to 40 degrees Celsius.
pub fn state(index: usize) -> State<f32, JOINTS> {
    let mut power = 1;
    State {
        direction: [0; JOINTS].map(|_| {
            let digit = index / power % 3;
            power *= 3;
            digit as f32 - 1.0
        }),
        payload: (index % 11) as f32,
        temperature: 10.0 + (index % 31) as f32,
    }
}

/// CRC-64/XZ of the bits of all results: of each pose first without, then with
/// its state the three columns of the rotation and the translation, as
/// little-endian `f32`. One changed bit changes it.
pub fn hash(arm: &Arm<f32, JOINTS>, poses: impl Iterator<Item = Joints>) -> u64 {
    let mut digest = CRC64.digest();
    for (index, q) in poses.enumerate() {
        for pose in [arm.real_pose(&q), arm.real_pose_in(&q, &state(index))] {
            let Pose { rotation, translation } = pose;
            for value in rotation.iter().chain(translation.iter()) {
                digest.update(&value.to_le_bytes());
            }
        }
    }
    digest.finalize()
}
