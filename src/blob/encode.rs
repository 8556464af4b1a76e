use core::fmt;

use nalgebra::Vector3;

use super::check::Blob;
use super::error::DecodeError;
use super::layout::{
    CHECKSUM, FLAG_COVARIANCE, FLAG_MASSES, FLAG_ORIENTATION, HAS_COVERED, HAS_LIMITS, LAYOUT,
    MAGIC, checksum, encoded_len, factor_len,
};
use super::term;
use crate::arm::{ArmParameters, MAX_JOINTS};
use crate::effects::Masses;
use crate::kinematics::JointKind;
use crate::scalar::Scalar;

/// Why parameters were not written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum EncodeError {
    /// The output is too small.
    NoRoom {
        /// Bytes needed.
        needed: usize,
        /// Bytes given.
        got: usize,
    },
    /// The factor of a covariance has the wrong size for these joints and terms.
    Factor {
        /// Numbers needed, see [`super::factor_len`].
        needed: usize,
        /// Numbers given.
        got: usize,
    },
    /// The last sequence number there is, see
    /// [`AcceptanceError::LastSequence`](super::AcceptanceError::LastSequence).
    LastSequence,
    /// A reader would refuse the result for this reason.
    Refused(DecodeError),
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRoom { needed, got } => {
                write!(f, "{got} bytes of room where {needed} are needed")
            }
            Self::Factor { needed, got } => {
                write!(f, "a covariance factor of {got} numbers where {needed} are needed")
            }
            Self::LastSequence => {
                write!(f, "sequence {} is the last there is: none could follow it", u32::MAX)
            }
            Self::Refused(error) => write!(f, "these parameters would be refused: {error}"),
        }
    }
}

impl core::error::Error for EncodeError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Refused(error) => Some(error),
            _ => None,
        }
    }
}

impl From<DecodeError> for EncodeError {
    fn from(error: DecodeError) -> Self {
        Self::Refused(error)
    }
}

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
/// rounded to binary32, orders of terms to 1/64. The result has been read back
/// and found acceptable.
///
/// # Errors
/// Too little room, an order the layout cannot hold, or a value that a reader
/// would refuse, by name.
pub fn encode<T: Scalar, const N: usize>(
    parameters: &ArmParameters<T, N>,
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    encode_with(parameters, None, out)
}

/// Like [`encode`], with the covariance of the parameters: the lower triangle
/// `L` of `L L'`, column by column, parameters ordered as in [`super::format`].
///
/// # Errors
/// As for [`encode`], and a factor of another size than [`factor_len`].
pub fn encode_with<T: Scalar, const N: usize>(
    parameters: &ArmParameters<T, N>,
    factor: Option<&[f32]>,
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    let p = parameters;
    if let Some(factor) = factor {
        let (needed, got) = (factor_len(N, p.terms.len()), factor.len());
        if needed != got {
            return Err(EncodeError::Factor { needed, got });
        }
    }
    let needed = encoded_len(N, p.terms.len()) + 4 * factor.map_or(0, <[f32]>::len);
    let got = out.len();
    let out = out.get_mut(..needed).ok_or(EncodeError::NoRoom { needed, got })?;
    if N == 0 || N > MAX_JOINTS {
        return Err(EncodeError::Refused(DecodeError::JointCount(N.min(255) as u8)));
    }
    if p.sequence == u32::MAX {
        return Err(EncodeError::LastSequence);
    }
    let mut flags = if p.orientation_identified { FLAG_ORIENTATION } else { 0 };
    if p.masses.is_some() {
        flags |= FLAG_MASSES;
    }
    if factor.is_some() {
        flags |= FLAG_COVARIANCE;
    }
    let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
    let masses = p.masses.unwrap_or(Masses {
        gravity: none,
        mass: [T::ZERO; N],
        com: [none; N],
        payload_com: none,
    });
    let mut w = Writer(out);
    w.put(&MAGIC);
    w.put(&LAYOUT.to_le_bytes());
    w.put(&[N as u8, p.terms.len() as u8]);
    w.put(&(needed as u32).to_le_bytes());
    w.put(&p.sequence.to_le_bytes());
    w.put(&p.robot_id.to_le_bytes());
    w.put(&p.created.to_le_bytes());
    w.put(&[flags, 0, 0, 0]);
    for v in [&p.base_translation, &p.base_rotation, &p.tool] {
        w.reals(&[v.x, v.y, v.z]);
    }
    w.reals(&[p.rms_before, p.rms_after, p.reference_temperature]);
    for v in [&masses.gravity, &masses.payload_com] {
        w.reals(&[v.x, v.y, v.z]);
    }
    let joints = p.nominal.iter().zip(&p.corrections);
    let ranges = p.limits.iter().zip(&p.covered);
    let loads = masses.mass.iter().zip(&masses.com);
    for (((link, correction), (limits, covered)), (mass, com)) in joints.zip(ranges).zip(loads) {
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
        w.reals(&[*mass, com.x, com.y, com.z]);
    }
    for (term, index) in p.terms.iter().zip(0..) {
        w.put(&term::to_bytes(index, term)?);
    }
    for value in factor.unwrap_or(&[]) {
        w.put(&value.to_le_bytes());
    }
    let (body, tail) = out.split_at_mut(needed - CHECKSUM);
    tail.copy_from_slice(&checksum(body).to_le_bytes());
    Blob::check(out)?;
    Ok(needed)
}
