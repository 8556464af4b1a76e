use core::fmt;

use super::layout::LAYOUT;
use crate::arm::MAX_JOINTS;
use crate::effects::MAX_TERMS;

/// The part of a blob a field stands in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Record {
    /// Before the records.
    Header,
    /// Record of a joint, counted from 0; from 1 where it is shown, as are the
    /// others.
    Joint(u8),
    /// Record of a term, counted from 0.
    Term(u8),
    /// Number of the covariance's factor, counted from 0.
    Factor(u16),
    /// A curve, counted from 0.
    Curve(u8),
}

/// The name of a field, as in the byte map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FieldName {
    /// Where it stands.
    pub record: Record,
    /// Group: `base translation`, `nominal`, `correction`, `limits`...
    pub group: &'static str,
    /// Member of the group, may be empty: `x`, `alpha`, `low`...
    pub member: &'static str,
}

impl fmt::Display for FieldName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.record {
            Record::Header => (),
            Record::Joint(index) => write!(f, "joint {} ", u16::from(index) + 1)?,
            Record::Term(index) => write!(f, "term {} ", u16::from(index) + 1)?,
            Record::Curve(index) => write!(f, "curve {} ", u16::from(index) + 1)?,
            Record::Factor(index) => write!(f, "number {} of ", u32::from(index) + 1)?,
        }
        f.write_str(self.group)?;
        if !self.member.is_empty() {
            write!(f, " {}", self.member)?;
        }
        Ok(())
    }
}

/// What is wrong with a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Flaw {
    /// An infinity or a NaN.
    NotFinite,
    /// Outside the range of the byte map.
    Implausible,
    /// A value that this layout gives no meaning.
    Unknown,
    /// The low end of a range lies above its high end.
    Inverted,
    /// A term depends on gravity and the blob has no masses.
    NeedsMasses,
}

/// Why a blob was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum DecodeError {
    /// Fewer bytes than the blob needs.
    Truncated {
        /// Bytes needed.
        needed: usize,
        /// Bytes given.
        got: usize,
    },
    /// Does not begin with `TARM`: no blob, or an erased slot.
    NotABlob,
    /// A draft from before format 1.0.
    DraftLayout(u16),
    /// A layout that came after this version.
    NewerLayout(u16),
    /// No arm has this many joints.
    JointCount(u8),
    /// More terms than [`MAX_TERMS`].
    TermCount(u8),
    /// The length field contradicts the counts and the parts that are present.
    Length {
        /// As written in the blob.
        stored: u32,
        /// As the counts demand.
        expected: usize,
    },
    /// Damaged: the checksum differs.
    Checksum {
        /// As written in the blob.
        stored: u32,
        /// Of the bytes as they are.
        computed: u32,
    },
    /// A field with an impossible value.
    Field(FieldName, Flaw),
    /// Decoded for an arm with another number of joints.
    WrongArm {
        /// Joints in the blob.
        blob: usize,
        /// Joints of the arm.
        arm: usize,
    },
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated { needed, got } => write!(f, "{got} bytes where {needed} are needed"),
            Self::NotABlob => f.write_str("does not begin with TARM: not a parameter blob"),
            Self::DraftLayout(l) => write!(
                f,
                "layout {l} was a draft and is no longer read; this version reads layout {LAYOUT}"
            ),
            Self::NewerLayout(l) => {
                write!(f, "layout {l} is newer than this version, which reads layout {LAYOUT}")
            }
            Self::JointCount(n) => write!(f, "{n} joints where 1 to {MAX_JOINTS} are possible"),
            Self::TermCount(n) => write!(f, "{n} terms where {MAX_TERMS} are possible"),
            Self::Length { stored, expected } => {
                write!(f, "the length field says {stored} where the contents need {expected}")
            }
            Self::Checksum { stored, computed } => {
                write!(f, "checksum {stored:#010x} is written, the bytes give {computed:#010x}")
            }
            Self::Field(name, flaw) => {
                let flaw = match flaw {
                    Flaw::NotFinite => "is not a finite number",
                    Flaw::Implausible => "is outside its plausible range",
                    Flaw::Unknown => "has a value without a meaning in this layout",
                    Flaw::Inverted => "is above its high end",
                    Flaw::NeedsMasses => "needs link masses and gravity, which are not given",
                };
                write!(f, "{name} {flaw}")
            }
            Self::WrongArm { blob, arm } => {
                write!(f, "the blob has {blob} joints, the arm has {arm}")
            }
        }
    }
}

impl core::error::Error for DecodeError {}

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
