use nalgebra::Vector3;

use super::check::Blob;
use super::curves;
use super::error::{DecodeError, EncodeError, Record};
use super::fields;
use super::layout::{
    CHECKSUM, CREATED, FLAG_COVARIANCE, FLAG_CURVES, FLAG_MASSES, FLAG_ORIENTATION, FLAG_TORQUES,
    FLAGS, HAS_COVERED, HAS_LIMITS, HEADER, LAYOUT, LENGTH, MAGIC, RECORD, ROBOT_ID, SEQUENCE,
    TERM, checksum, encoded_len, factor_len,
};
use super::term;
use crate::arm::{ArmParameters, MAX_JOINTS};
use crate::effects::{Masses, Term};
use crate::kinematics::JointKind;
use crate::scalar::Scalar;

/// Writes a blob into the front of `out` and returns its length. Reals are
/// rounded to binary32, orders of terms to 1/64 (frictions and time constants as FORMAT.md
/// has them). The result has been read back
/// and found acceptable. What was there in `out`, as far as a blob reaches, is lost also where it
/// is refused, but for too little room.
///
/// # Errors
/// Too little room, an order the layout cannot hold, or a value that a reader
/// would refuse, by name.
///
/// ```
/// use truearm::{ArmParameters6, blob::{Blob, encode, encoded_len}};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
/// let mut parameters: ArmParameters6<'_, f32> = Blob::check(slot)?.parameters()?;
/// parameters.tool.z += 0.01;
/// parameters.sequence += 1;
/// let mut bytes = [0; encoded_len(6, 0)];
/// let length = encode(&parameters, &mut bytes)?;
/// assert_eq!(Blob::check(bytes.get(..length).unwrap_or(&[]))?.parameters(), Ok(parameters));
/// # Ok(())
/// # }
/// ```
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
    let curves = p.curves.as_bytes();
    let numbers = factor.map_or(0, <[f32]>::len);
    let needed = encoded_len(N, p.terms.len()) + 4 * numbers + curves.len();
    let got = out.len();
    let out = out.get_mut(..needed).ok_or(EncodeError::NoRoom { needed, got })?;
    if N == 0 || N > MAX_JOINTS {
        return Err(EncodeError::Refused(DecodeError::JointCount(N.min(255) as u8)));
    }
    if p.sequence == u32::MAX {
        return Err(EncodeError::LastSequence);
    }
    let flags = flags_of(p, factor.is_some());
    let masses = masses_of(p);
    out.fill(0);
    let (header, rest) = out.split_at_mut_checked(HEADER).unwrap_or_default();
    write_header(header, p, &masses, flags, needed);
    let (records, rest) = rest.split_at_mut_checked(N * RECORD).unwrap_or_default();
    write_records(records, p, &masses);
    let (places, rest) = rest.split_at_mut_checked(p.terms.len() * TERM).unwrap_or_default();
    let places = places.as_chunks_mut().0.iter_mut();
    for ((term, index), place) in p.terms.iter().zip(0..).zip(places) {
        *place = term::to_bytes(index, term)?;
    }
    let (places, rest) = rest.split_at_mut_checked(4 * numbers).unwrap_or_default();
    let numbers = factor.unwrap_or(&[]).iter();
    for (place, number) in places.as_chunks_mut().0.iter_mut().zip(numbers) {
        *place = number.to_le_bytes();
    }
    if !p.curves.is_empty() {
        put(Some(rest), curves);
    }
    let (body, tail) = out.split_at_mut_checked(needed - CHECKSUM).unwrap_or_default();
    put(Some(tail), &checksum(body).to_le_bytes());
    Blob::check(out)?;
    Ok(needed)
}

/// Zeros where there are none.
fn masses_of<T: Scalar, const N: usize>(p: &ArmParameters<T, N>) -> Masses<T, N> {
    let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
    p.masses.unwrap_or(Masses {
        gravity: none,
        mass: [T::ZERO; N],
        com: [none; N],
        payload_com: none,
    })
}

/// What a blob of these parameters holds.
fn flags_of<T: Scalar, const N: usize>(p: &ArmParameters<T, N>, covariance: bool) -> u8 {
    let held = [
        (p.orientation_identified, FLAG_ORIENTATION),
        (p.masses.is_some(), FLAG_MASSES),
        (covariance, FLAG_COVARIANCE),
        (!p.curves.is_empty(), FLAG_CURVES),
        (p.masses.is_none() && p.terms.iter().any(Term::needs_torque), FLAG_TORQUES),
    ];
    held.iter().filter(|(is, _)| *is).fold(0, |flags, (_, flag)| flags | flag)
}

fn put(place: Option<&mut [u8]>, bytes: &[u8]) {
    let place = place.unwrap_or_default();
    place.iter_mut().zip(bytes).for_each(|(place, byte)| *place = *byte);
}

// One copy for blobs and for what is only judged, as of the next.
#[inline(never)]
fn write_header<T: Scalar, const N: usize>(
    header: &mut [u8],
    p: &ArmParameters<T, N>,
    masses: &Masses<T, N>,
    flags: u8,
    size: usize,
) {
    for (place, bytes) in [
        (0..4, &MAGIC[..]),
        (4..6, &LAYOUT.to_le_bytes()),
        (6..8, &[N as u8, p.terms.len() as u8]),
        (LENGTH, &(size as u32).to_le_bytes()),
        (SEQUENCE, &p.sequence.to_le_bytes()),
        (ROBOT_ID, &p.robot_id.to_le_bytes()),
        (CREATED, &p.created.to_le_bytes()),
        (FLAGS..FLAGS + 1, &[flags]),
    ] {
        put(header.get_mut(place), bytes);
    }
    fields::BASE_TRANSLATION.write(header, p.base_translation.as_slice());
    fields::BASE_ROTATION.write(header, p.base_rotation.as_slice());
    fields::TOOL.write(header, p.tool.as_slice());
    fields::RMS_BEFORE.write(header, &[p.rms_before]);
    fields::RMS_AFTER.write(header, &[p.rms_after]);
    fields::REFERENCE_TEMPERATURE.write(header, &[p.reference_temperature]);
    fields::GRAVITY.write(header, masses.gravity.as_slice());
    fields::PAYLOAD_POINT.write(header, masses.payload_com.as_slice());
}

fn write_records<T: Scalar, const N: usize>(
    records: &mut [u8],
    p: &ArmParameters<T, N>,
    masses: &Masses<T, N>,
) {
    for (joint, record) in records.chunks_exact_mut(RECORD).enumerate() {
        write_record(record, joint, p, masses);
    }
}

/// That of a joint, counted from 0; nothing where there is none.
#[inline(never)]
fn write_record<T: Scalar, const N: usize>(
    record: &mut [u8],
    joint: usize,
    p: &ArmParameters<T, N>,
    masses: &Masses<T, N>,
) {
    let joints = p.nominal.iter().zip(&p.corrections);
    let ranges = p.limits.iter().zip(&p.covered);
    let loads = masses.mass.iter().zip(&masses.com);
    let mut joints = joints.zip(ranges).zip(loads);
    let Some((((link, correction), (limits, covered)), (mass, com))) = joints.nth(joint) else {
        return;
    };
    let kind = match link.kind {
        JointKind::Revolute => 0,
        JointKind::Prismatic => 1,
    };
    let has = |range: &Option<_>, bit| if range.is_some() { bit } else { 0 };
    let presence = has(limits, HAS_LIMITS) | has(covered, HAS_COVERED);
    put(record.get_mut(..2), &[kind, presence]);
    fields::NOMINAL.write(record, &link.parameters.to_array());
    fields::CORRECTION.write(record, &correction.to_array());
    fields::LIMITS.write(record, &limits.unwrap_or([T::ZERO; 2]));
    fields::COVERED.write(record, &covered.unwrap_or([T::ZERO; 2]));
    fields::MASS.write(record, &[*mass]);
    fields::CENTRE_OF_MASS.write(record, com.as_slice());
}

/// Whether [`encode`] takes these parameters: every number of header, records and terms is
/// judged as a reader judges it, a record at a time, without room for a blob. Of their curves
/// only whose they are: [`crate::Curves`] are checked bytes.
#[inline(never)]
pub(crate) fn storable<T: Scalar, const N: usize>(
    parameters: &ArmParameters<T, N>,
) -> Result<(), EncodeError> {
    let p = parameters;
    if N == 0 || N > MAX_JOINTS {
        return Err(EncodeError::Refused(DecodeError::JointCount(N.min(255) as u8)));
    }
    if p.sequence == u32::MAX {
        return Err(EncodeError::LastSequence);
    }
    let (flags, masses) = (flags_of(p, false), masses_of(p));
    let present = p.masses.is_some();
    let mut header = [0; HEADER];
    write_header(&mut header, p, &masses, flags, 0);
    fields::check(Record::Header, &header, present, 0)?;
    for joint in 0..N as u8 {
        let mut record = [0; RECORD];
        write_record(&mut record, usize::from(joint), p, &masses);
        let [_, presence, ..] = record;
        fields::check(Record::Joint(joint), &record, present, presence)?;
    }
    let mut late = None;
    for (term, index) in p.terms.iter().zip(0..) {
        term::check(index, &term::to_bytes(index, term)?, (N as u8, flags), &mut late)?;
    }
    let turns = |joint: u8| {
        p.nominal.get(usize::from(joint)).is_some_and(|link| link.kind == JointKind::Revolute)
    };
    let cut = |expected| DecodeError::Length { stored: 0, expected };
    curves::check(p.curves.as_bytes(), turns, cut)?;
    Ok(())
}
