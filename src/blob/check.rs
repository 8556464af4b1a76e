use core::fmt;

use super::layout::{
    CHECKSUM, FLAG_MASSES, FLAG_ORIENTATION, HAS_COVERED, HAS_LIMITS, HEADER, LAYOUT, MAGIC,
    MAX_JOINTS, RECORD, TERM, checksum, encoded_len,
};
use super::term;
use crate::effects::MAX_TERMS;
use crate::kinematics::{JointKind, LinkParameter};

/// A blob of which every byte has been checked, still in place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blob<'a> {
    pub(super) header: &'a [u8; HEADER],
    pub(super) records: &'a [u8],
    pub(super) terms: &'a [u8],
}

/// The part of a blob a field stands in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Record {
    /// Before the records.
    Header,
    /// Record of a joint, counted from 1.
    Joint(u8),
    /// Record of a term, counted from 1.
    Term(u8),
}

/// The name of a field, as in the byte map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
            Record::Joint(number) => write!(f, "joint {number} ")?,
            Record::Term(number) => write!(f, "term {number} ")?,
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
    /// A layout this version does not know.
    UnsupportedLayout(u16),
    /// No arm has this many joints.
    JointCount(u8),
    /// More terms than [`MAX_TERMS`].
    TermCount(u8),
    /// The length field contradicts the joint and term counts.
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
            Self::UnsupportedLayout(l) => {
                write!(f, "layout {l} is not known to this version, which reads layout {LAYOUT}")
            }
            Self::JointCount(n) => write!(f, "{n} joints where 1 to {MAX_JOINTS} are possible"),
            Self::TermCount(n) => write!(f, "{n} terms where {MAX_TERMS} are possible"),
            Self::Length { stored, expected } => {
                write!(f, "the length field says {stored} where joints and terms need {expected}")
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

/// Reads fixed-size pieces from the front; `None` past the end.
pub(super) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn take<const K: usize>(&mut self) -> Option<&'a [u8; K]> {
        let (front, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(front)
    }
    pub fn f32(&mut self) -> f32 {
        // Only called on slices whose length was checked; NaN is refused by
        // every field check, so a wrong length cannot pass unnoticed.
        self.take().map_or(f32::NAN, |b| f32::from_le_bytes(*b))
    }
}

const XYZ: [&str; 3] = ["x", "y", "z"];
const RANGE: [&str; 2] = ["low", "high"];

fn check_value(name: FieldName, value: f32, low: f32, high: f32) -> Result<(), DecodeError> {
    if !value.is_finite() {
        Err(DecodeError::Field(name, Flaw::NotFinite))
    } else if value < low || value > high {
        Err(DecodeError::Field(name, Flaw::Implausible))
    } else {
        Ok(())
    }
}

impl<'a> Blob<'a> {
    /// Checks every byte in place; what lies behind the blob's length is
    /// ignored, so a whole memory slot may be given.
    ///
    /// # Errors
    /// The first failure in the order of the byte map's last paragraph. Never
    /// panics, whatever the bytes.
    pub fn check(bytes: &'a [u8]) -> Result<Self, DecodeError> {
        let truncated = |needed| DecodeError::Truncated { needed, got: bytes.len() };
        let (header, rest) = bytes.split_first_chunk::<HEADER>().ok_or(truncated(HEADER))?;
        let mut reader = Reader(header);
        let start: &[u8; 8] = reader.take().ok_or(truncated(HEADER))?;
        let [m0, m1, m2, m3, l0, l1, joints, terms] = *start;
        if [m0, m1, m2, m3] != MAGIC {
            return Err(DecodeError::NotABlob);
        }
        let layout = u16::from_le_bytes([l0, l1]);
        if layout != LAYOUT {
            return Err(DecodeError::UnsupportedLayout(layout));
        }
        let count = usize::from(joints);
        if count == 0 || count > MAX_JOINTS {
            return Err(DecodeError::JointCount(joints));
        }
        let term_bytes = usize::from(terms) * TERM;
        if usize::from(terms) > MAX_TERMS {
            return Err(DecodeError::TermCount(terms));
        }
        let expected = encoded_len(count, usize::from(terms));
        let stored: &[u8; 4] = reader.take().ok_or(truncated(HEADER))?;
        let stored = u32::from_le_bytes(*stored);
        if stored as usize != expected {
            return Err(DecodeError::Length { stored, expected });
        }
        let (records, rest) = rest.split_at_checked(count * RECORD).ok_or(truncated(expected))?;
        let (terms, rest) = rest.split_at_checked(term_bytes).ok_or(truncated(expected))?;
        let (stored, _) = rest.split_first_chunk::<CHECKSUM>().ok_or(truncated(expected))?;
        let stored = u32::from_le_bytes(*stored);
        let body = bytes.get(..expected - CHECKSUM).ok_or(truncated(expected))?;
        let computed = checksum(body);
        if stored != computed {
            return Err(DecodeError::Checksum { stored, computed });
        }
        let blob = Self { header, records, terms };
        let masses = blob.check_header()?;
        for (record, number) in records.chunks_exact(RECORD).zip(1..) {
            check_record(number, record, masses)?;
        }
        for (record, number) in term::each(terms).zip(1..) {
            term::check(number, record, joints, masses)?;
        }
        Ok(blob)
    }

    /// Whether it has masses.
    fn check_header(&self) -> Result<bool, DecodeError> {
        let name = |group, member| FieldName { record: Record::Header, group, member };
        let unknown = |group| DecodeError::Field(name(group, ""), Flaw::Unknown);
        let mut reader = Reader(self.header.get(24..).unwrap_or(&[]));
        let [flags, reserved @ ..]: [u8; 4] = *reader.take().ok_or(unknown("flags"))?;
        if flags & !(FLAG_ORIENTATION | FLAG_MASSES) != 0 {
            return Err(unknown("flags"));
        }
        if reserved != [0; 3] {
            return Err(unknown("reserved"));
        }
        for (group, most) in [("base translation", 1.0), ("base rotation", 1.0), ("tool", 10.0)] {
            for member in XYZ {
                check_value(name(group, member), reader.f32(), -most, most)?;
            }
        }
        check_value(name("rms before", ""), reader.f32(), 0.0, 10.0)?;
        check_value(name("rms after", ""), reader.f32(), 0.0, 10.0)?;
        check_value(name("reference temperature", ""), reader.f32(), -100.0, 200.0)?;
        let masses = flags & FLAG_MASSES != 0;
        for (group, most) in [("gravity", 20.0), ("payload point", 10.0)] {
            let most = if masses { most } else { 0.0 };
            for member in XYZ {
                check_value(name(group, member), reader.f32(), -most, most)?;
            }
        }
        Ok(masses)
    }
}

fn check_record(joint: u8, record: &[u8], masses: bool) -> Result<(), DecodeError> {
    let name = |group, member| FieldName { record: Record::Joint(joint), group, member };
    let unknown = |group| DecodeError::Field(name(group, ""), Flaw::Unknown);
    let mut reader = Reader(record);
    let [kind, presence, reserved @ ..]: [u8; 4] = *reader.take().ok_or(unknown("record"))?;
    if kind_of(kind).is_none() {
        return Err(unknown("kind"));
    }
    if presence & !(HAS_LIMITS | HAS_COVERED) != 0 {
        return Err(unknown("presence"));
    }
    if reserved != [0, 0] {
        return Err(unknown("reserved"));
    }
    for (group, length, angle) in [("nominal", 10.0, 6.3), ("correction", 0.2, 0.2)] {
        for parameter in LinkParameter::ALL {
            let most = if parameter.is_length() { length } else { angle };
            check_value(name(group, parameter.name()), reader.f32(), -most, most)?;
        }
    }
    for (group, bit) in [("limits", HAS_LIMITS), ("covered range", HAS_COVERED)] {
        let most = if presence & bit == 0 { 0.0 } else { 100.0 };
        let values = [reader.f32(), reader.f32()];
        for (member, value) in RANGE.into_iter().zip(values) {
            check_value(name(group, member), value, -most, most)?;
        }
        if values[0] > values[1] {
            return Err(DecodeError::Field(name(group, "low"), Flaw::Inverted));
        }
    }
    let (heaviest, farthest) = if masses { (10_000.0, 10.0) } else { (0.0, 0.0) };
    check_value(name("mass", ""), reader.f32(), 0.0, heaviest)?;
    for member in XYZ {
        check_value(name("centre of mass", member), reader.f32(), -farthest, farthest)?;
    }
    Ok(())
}

pub(super) fn kind_of(byte: u8) -> Option<JointKind> {
    match byte {
        0 => Some(JointKind::Revolute),
        1 => Some(JointKind::Prismatic),
        _ => None,
    }
}
