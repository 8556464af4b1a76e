use super::curves;
use super::error::{DecodeError, FieldName, Flaw, Record};
use super::fields;
use super::layout::{
    CHECKSUM, FLAG_COVARIANCE, FLAG_MASSES, FLAG_TAG, FLAG_TORQUES, FLAGS, HAS_COVERED, HAS_LIMITS,
    HEADER, KNOWN_FLAGS, LAYOUT, MAGIC, RECORD, TAG, TERM, checksum, encoded_len, factor_len,
    uncertain_parameters,
};
use super::reader::Reader;
use super::term;
use crate::arm::MAX_JOINTS;
use crate::effects::{Curves, MAX_TERMS};
use crate::kinematics::JointKind;

/// A blob of which every byte has been checked, still in place.
///
/// ```
/// use truearm::blob::{Blob, DecodeError};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
/// let blob = Blob::check(slot)?;
/// assert_eq!((blob.joints(), blob.terms()), (6, 0));
/// assert_eq!(Blob::check(&[0xff; 4096]), Err(DecodeError::NotABlob));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blob<'a> {
    pub(super) header: &'a [u8; HEADER],
    pub(super) records: &'a [u8],
    pub(super) terms: &'a [u8],
    /// Factor of the covariance; empty without.
    pub(super) factor: &'a [u8],
    pub(super) curves: Curves<'a>,
    pub(super) tag: Option<&'a [u8; TAG]>,
    /// All that the tag speaks for.
    pub(super) signed: &'a [u8],
}

/// What it is, not its bytes.
#[cfg(feature = "defmt")]
impl defmt::Format for Blob<'_> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(
            f,
            "Blob {{ robot_id: {=u64:016x}, sequence: {=u32}, joints: {=usize}, terms: {=usize} }}",
            self.robot_id(),
            self.sequence(),
            self.joints(),
            self.terms()
        );
    }
}

/// No standard deviation of any parameter is larger, SI.
const WIDEST: f32 = 10.0;

impl<'a> Blob<'a> {
    /// Checks every byte in place; what lies behind the blob's length is
    /// ignored, so a whole memory slot may be given. Whose blob it is, how old
    /// and who wrote it is not asked here but by [`super::Acceptance`].
    ///
    /// # Errors
    /// The first failure in the order of [`super::format`]. Never panics,
    /// whatever the bytes.
    pub fn check(bytes: &'a [u8]) -> Result<Self, DecodeError> {
        let truncated = |needed| DecodeError::Truncated { needed, got: bytes.len() };
        let header: &[u8; HEADER] = bytes.first_chunk().ok_or(truncated(HEADER))?;
        let [m0, m1, m2, m3, l0, l1, joints, terms, s0, s1, s2, s3, ..] = *header;
        check_layout([m0, m1, m2, m3], u16::from_le_bytes([l0, l1]))?;
        // Damage first, so that nothing damaged looks like something to come.
        let stored = u32::from_le_bytes([s0, s1, s2, s3]);
        let size = (stored as usize).max(HEADER + CHECKSUM);
        let body = bytes.get(..size - CHECKSUM).ok_or(truncated(size))?;
        let written = bytes.get(body.len()..).and_then(<[u8]>::first_chunk);
        let written = u32::from_le_bytes(*written.ok_or(truncated(size))?);
        let computed = checksum(body);
        if written != computed {
            return Err(DecodeError::Checksum { stored: written, computed });
        }
        let (count, term_count) = (usize::from(joints), usize::from(terms));
        if count == 0 || count > MAX_JOINTS {
            return Err(DecodeError::JointCount(joints));
        }
        if term_count > MAX_TERMS {
            return Err(DecodeError::TermCount(terms));
        }
        check_flags(header)?;
        let flags = header[FLAGS];
        let masses = flags & FLAG_MASSES != 0;
        let factor_size =
            if flags & FLAG_COVARIANCE != 0 { 4 * factor_len(count, term_count) } else { 0 };
        let tag_size = if flags & FLAG_TAG != 0 { TAG } else { 0 };
        let without_curves = encoded_len(count, term_count) + factor_size + tag_size;
        let expected = without_curves + curves::size(flags, stored, without_curves);
        let mut reader = Reader(body.get(HEADER..).unwrap_or(&[]));
        let contradiction = DecodeError::Length { stored, expected };
        if stored as usize != expected {
            return Err(contradiction);
        }
        let records = reader.slice(count * RECORD).ok_or(contradiction)?;
        let term_records = reader.slice(term_count * TERM).ok_or(contradiction)?;
        let factor = reader.slice(factor_size).ok_or(contradiction)?;
        let curves = reader.slice(expected - without_curves).ok_or(contradiction)?;
        let tag = if tag_size == 0 { None } else { reader.take() };
        let signed = body.get(..body.len() - tag_size).ok_or(contradiction)?;
        fields::check(Record::Header, header, masses, 0)?;
        for (record, index) in records.chunks_exact(RECORD).zip(0..) {
            check_record(index, record, masses)?;
        }
        let (mut late, mut torques) = (None, false);
        for (record, index) in term::each(term_records).zip(0..) {
            torques |= term::check(index, record, (joints, flags), &mut late)?;
        }
        // They are read where a term needs them and no masses give them, and nowhere else.
        if flags & FLAG_TORQUES != 0 && (masses || !torques) {
            return Err(of_header("flags", Flaw::Implausible));
        }
        if !factor.is_empty() {
            check_factor(factor, uncertain_parameters(count, term_count))?;
        }
        let cut = |size| DecodeError::Length { stored, expected: without_curves + size };
        let curves = curves::check(curves, |joint| turns(records, joint), cut)?;
        Ok(Self { header, records, terms: term_records, factor, curves, tag, signed })
    }
}

/// Whether it is a blob of this layout.
fn check_layout(magic: [u8; 4], layout: u16) -> Result<(), DecodeError> {
    if magic != MAGIC {
        return Err(DecodeError::NotABlob);
    }
    match layout {
        LAYOUT => Ok(()),
        layout if layout < LAYOUT => Err(DecodeError::DraftLayout(layout)),
        layout => Err(DecodeError::NewerLayout(layout)),
    }
}

fn of_header(group: &'static str, flaw: Flaw) -> DecodeError {
    DecodeError::Field(FieldName { record: Record::Header, group, member: "" }, flaw)
}

/// Whether flags and reserved bytes have a meaning.
fn check_flags(header: &[u8; HEADER]) -> Result<(), DecodeError> {
    let unknown = |group| Err(of_header(group, Flaw::Unknown));
    let [flags, reserved @ ..] =
        header.get(FLAGS..).and_then(<[u8]>::first_chunk).copied().unwrap_or([0xff; 4]);
    if flags & !KNOWN_FLAGS != 0 {
        return unknown("flags");
    }
    if reserved != [0; 3] {
        return unknown("reserved");
    }
    Ok(())
}

fn check_record(joint: u8, record: &[u8], masses: bool) -> Result<(), DecodeError> {
    let unknown = |group| {
        let name = FieldName { record: Record::Joint(joint), group, member: "" };
        DecodeError::Field(name, Flaw::Unknown)
    };
    let [kind, presence, reserved @ ..] = head_of(record);
    if kind_of(kind).is_none() {
        return Err(unknown("kind"));
    }
    if presence & !(HAS_LIMITS | HAS_COVERED) != 0 {
        return Err(unknown("presence"));
    }
    if reserved != [0, 0] {
        return Err(unknown("reserved"));
    }
    fields::check(Record::Joint(joint), record, masses, presence)
}

/// Whether there is such a joint, and it turns.
fn turns(records: &[u8], joint: u8) -> bool {
    let [kind, ..] = head_of(records.get(usize::from(joint) * RECORD..).unwrap_or(&[]));
    kind_of(kind) == Some(JointKind::Revolute)
}

/// A lower triangle by columns; no diagonal entry is negative.
fn check_factor(factor: &[u8], size: usize) -> Result<(), DecodeError> {
    let mut reader = Reader(factor);
    let mut index: u16 = 0;
    for column in 0..size {
        for row in column..size {
            let value = reader.f32();
            let low = if row == column { 0.0 } else { -WIDEST };
            // There are two thousand of them: a name only for a bad one.
            if !(low..=WIDEST).contains(&value) {
                let record = Record::Factor(index);
                let name = FieldName { record, group: "covariance factor", member: "" };
                let finite = value.is_finite();
                let flaw = if finite { Flaw::Implausible } else { Flaw::NotFinite };
                return Err(DecodeError::Field(name, flaw));
            }
            index = index.saturating_add(1);
        }
    }
    Ok(())
}

/// Kind, presence and reserved bytes of a joint's record.
pub(super) fn head_of(record: &[u8]) -> [u8; 4] {
    record.first_chunk().copied().unwrap_or([0xff; 4])
}

pub(super) fn kind_of(byte: u8) -> Option<JointKind> {
    match byte {
        0 => Some(JointKind::Revolute),
        1 => Some(JointKind::Prismatic),
        _ => None,
    }
}
