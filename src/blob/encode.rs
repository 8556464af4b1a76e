use core::fmt;

use super::check::{Blob, DecodeError};
use super::layout::{
    FLAG_ORIENTATION, HAS_COVERED, HAS_LIMITS, HEADER, LAYOUT, MAGIC, MAX_JOINTS, RECORD, checksum,
    encoded_len,
};
use crate::arm::ArmParameters;
use crate::kinematics::JointKind;
use crate::scalar::Scalar;

/// Why parameters were not written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EncodeError {
    /// The output is too small.
    NoRoom {
        /// Bytes needed.
        needed: usize,
        /// Bytes given.
        got: usize,
    },
    /// A reader would refuse the result for this reason.
    Refused(DecodeError),
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRoom { needed, got } => {
                write!(f, "{got} bytes of room where {needed} are needed")
            }
            Self::Refused(error) => write!(f, "these parameters would be refused: {error}"),
        }
    }
}

impl core::error::Error for EncodeError {}

/// Appends to a slice; silently stops at its end, which the caller has checked.
struct Writer<'a>(&'a mut [u8]);

impl Writer<'_> {
    fn put(&mut self, bytes: &[u8]) {
        if let Some((front, rest)) = core::mem::take(&mut self.0).split_at_mut_checked(bytes.len())
        {
            front.copy_from_slice(bytes);
            self.0 = rest;
        }
    }
    fn reals<T: Scalar>(&mut self, values: &[T]) {
        for value in values {
            self.put(&(value.to_f64() as f32).to_le_bytes());
        }
    }
}

/// Writes a blob into the front of `out` and returns its length. Reals are
/// rounded to binary32. The result has been read back and found acceptable.
///
/// # Errors
/// Too little room, or a value that a reader would refuse, by name.
pub fn encode<T: Scalar, const N: usize>(
    parameters: &ArmParameters<T, N>,
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    let p = parameters;
    let needed = encoded_len(N);
    let got = out.len();
    let out = out.get_mut(..needed).ok_or(EncodeError::NoRoom { needed, got })?;
    if N == 0 || N > MAX_JOINTS {
        return Err(EncodeError::Refused(DecodeError::JointCount(N.min(255) as u8)));
    }
    let flags = if p.orientation_identified { FLAG_ORIENTATION } else { 0 };
    let mut w = Writer(out);
    w.put(&MAGIC);
    w.put(&LAYOUT.to_le_bytes());
    w.put(&[N as u8, flags]);
    w.put(&(needed as u32).to_le_bytes());
    w.put(&p.sequence.to_le_bytes());
    w.put(&p.robot_id.to_le_bytes());
    for v in [&p.base_translation, &p.base_rotation, &p.tool] {
        w.reals(&[v.x, v.y, v.z]);
    }
    w.reals(&[p.rms_before, p.rms_after]);
    let joints = p.nominal.iter().zip(&p.corrections);
    for ((link, correction), (limits, covered)) in joints.zip(p.limits.iter().zip(&p.covered)) {
        let kind = match link.kind {
            JointKind::Revolute => 0,
            JointKind::Prismatic => 1,
        };
        let mut presence = 0;
        for (range, bit) in [(limits, HAS_LIMITS), (covered, HAS_COVERED)] {
            if range.is_some() {
                presence |= bit;
            }
        }
        w.put(&[kind, presence, 0, 0]);
        w.reals(&link.parameters.to_array());
        w.reals(&correction.to_array());
        for range in [limits, covered] {
            w.reals(&range.unwrap_or([T::ZERO; 2]));
        }
    }
    let (body, tail) = out.split_at_mut(HEADER + N * RECORD);
    tail.copy_from_slice(&checksum(body).to_le_bytes());
    Blob::check(out).map_err(EncodeError::Refused)?;
    Ok(needed)
}
