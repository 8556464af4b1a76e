//! The curves of a blob: what stands in their bytes, see [`super::format`].

use super::error::{DecodeError, EncodeError, FieldName, Flaw, Record};
use super::layout::FLAG_CURVES;
use crate::effects::{CURVE_HEAD, Curves, EXPONENTS, Gaps, first_curve};

/// No curve is further from zero than this, rad; nor is its band wider.
const MOST: f32 = 5e-2;
/// Steps of the largest node.
const MOST_STEPS: f32 = 32_768.0;

fn flaw(index: u8, field: &'static str, flaw: Flaw) -> DecodeError {
    DecodeError::Field(FieldName { record: Record::Curve(index), group: field, member: "" }, flaw)
}

/// Bytes that a curve of so many nodes takes in a blob; with [`Gaps`] [`gaps_len`] more.
#[must_use]
pub const fn curve_len(nodes: usize) -> usize {
    CURVE_HEAD + 2 * nodes
}

/// Bytes that the gaps of a curve of so many nodes take.
#[must_use]
pub const fn gaps_len(nodes: usize) -> usize {
    4 + nodes / 8
}

impl<'t> Curves<'t> {
    /// Curves as a blob holds them, joints ascending; of arms of any joints.
    ///
    /// # Errors
    /// The first field that a reader of a blob would refuse, by name. Without the feature
    /// `curves` whatever is not empty.
    pub fn of(bytes: &'t [u8]) -> Result<Self, DecodeError> {
        if bytes.is_empty() {
            return Ok(Self::NONE);
        }
        if !cfg!(feature = "curves") {
            return Err(flaw(0, "", Flaw::Unknown));
        }
        let cut = |expected| DecodeError::Length { stored: bytes.len() as u32, expected };
        check(bytes, |_| true, cut)
    }
}

/// Bytes of the curves of a blob with these flags and so many bytes, as many of them
/// without curves.
#[inline]
pub(super) fn size(flags: u8, stored: u32, without: usize) -> usize {
    if !cfg!(feature = "curves") || flags & FLAG_CURVES == 0 {
        return 0;
    }
    // There is one at least.
    (stored as usize).saturating_sub(without).max(CURVE_HEAD)
}

/// Checks all curves. `turns` says whether an arm has a joint and whether it turns;
/// `cut` is the error where the bytes end too early, and gets how many there should be.
pub(super) fn check<'t>(
    bytes: &'t [u8],
    turns: impl Fn(u8) -> bool,
    cut: impl Fn(usize) -> DecodeError,
) -> Result<Curves<'t>, DecodeError> {
    if !cfg!(feature = "curves") {
        return Ok(Curves::NONE);
    }
    let (mut rest, mut next, mut index) = (bytes, 0, 0);
    while !rest.is_empty() {
        let at = bytes.len() - rest.len();
        let Some([joint, exponent, gaps, reserved, ..]) = rest.first_chunk::<CURVE_HEAD>() else {
            return Err(cut(at + CURVE_HEAD));
        };
        if !EXPONENTS.contains(exponent) {
            return Err(flaw(index, "nodes", Flaw::Implausible));
        }
        if *gaps > 1 || *reserved != 0 {
            return Err(flaw(index, "reserved", Flaw::Unknown));
        }
        let Some((curve, behind)) = first_curve(rest) else {
            let nodes = 1 << *exponent;
            let gaps = if *gaps == 0 { 0 } else { gaps_len(nodes) };
            return Err(cut(at + curve_len(nodes) + gaps));
        };
        if *joint < next || !turns(*joint) {
            return Err(flaw(index, "joint", Flaw::Implausible));
        }
        real(index, "step", curve.step(), MOST / MOST_STEPS)?;
        real(index, "band", curve.band(), MOST)?;
        // Nodes that count for nothing: no writer has them.
        if curve.step() == 0.0 && curve.nodes().any(|node| node != 0) {
            return Err(flaw(index, "step", Flaw::Implausible));
        }
        if let Some(gaps) = curve.gaps() {
            real(index, "band in gaps", gaps.band(), MOST)?;
            // A map without a gap: no writer has it.
            if gaps.known().iter().all(|bits| *bits == 0xff) {
                return Err(flaw(index, "gaps", Flaw::Implausible));
            }
        }
        (rest, next, index) = (behind, joint.saturating_add(1), index.saturating_add(1));
    }
    Ok(Curves::of_checked(bytes))
}

fn real(index: u8, field: &'static str, value: f32, most: f32) -> Result<(), DecodeError> {
    // NaN is not within, either.
    if (0.0..=most).contains(&value) {
        return Ok(());
    }
    let kind = if value.is_finite() { Flaw::Implausible } else { Flaw::NotFinite };
    Err(flaw(index, field, kind))
}

/// Writes the curve of a joint (from 0) into the front of `out` and returns its length.
/// Nodes are in steps of `step` rad, the first at angle 0; `band` is one standard
/// deviation, rad. Curves one behind the other, joints ascending, are [`Curves::of`]
/// their bytes.
///
/// # Errors
/// Too little room, or what a reader would refuse: a number of nodes that is not 32,
/// 64, 128, 256 or 512; a step of more than 1.5e-6 rad, a band of more than 0.05 rad.
///
/// ```
/// use truearm::Curves;
/// use truearm::blob::{curve_len, encode_curve};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// let nodes: [i16; 32] = core::array::from_fn(|k| if k < 16 { 20_000 } else { -20_000 });
/// let mut bytes = [0; curve_len(32)];
/// let length = encode_curve(2, 1e-8, 2e-5, &nodes, &mut bytes)?;
/// let curves = Curves::of(bytes.get(..length).unwrap_or(&[]))?;
/// let third = curves.of_joint(2).ok_or("written above")?;
/// assert!((third.at(1.5_f32) - 2e-4).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
pub fn encode_curve(
    joint: u8,
    step: f32,
    band: f32,
    nodes: &[i16],
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    encode_curve_with(joint, step, band, nodes, None, out)
}

/// Like [`encode_curve`], with the stretches between nodes where the curve is not known.
///
/// # Errors
/// As for [`encode_curve`], and gaps of another number of stretches than there are nodes,
/// without any gap, or with a band of more than 0.05 rad in them.
///
/// ```
/// use truearm::Curves;
/// use truearm::blob::{curve_len, encode_curve_with, gaps_len};
/// use truearm::effects::Gaps;
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// // Known from 0 to 180 degrees.
/// let gaps = Gaps::new(3e-4, &[0xff, 0xff, 0, 0]);
/// let mut bytes = [0; curve_len(32) + gaps_len(32)];
/// encode_curve_with(2, 1e-8, 2e-5, &[100; 32], Some(gaps), &mut bytes)?;
/// let third = Curves::of(&bytes)?.of_joint(2).ok_or("written above")?;
/// assert!(third.knows(1.5_f32) && !third.knows(-1.5_f32));
/// assert_eq!((third.band_at(1.5_f32), third.band_at(-1.5_f32)), (2e-5, 3e-4));
/// # Ok(())
/// # }
/// ```
pub fn encode_curve_with(
    joint: u8,
    step: f32,
    band: f32,
    nodes: &[i16],
    gaps: Option<Gaps<'_>>,
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    let count = nodes.len();
    if gaps.is_some_and(|gaps| gaps.known().len() != count / 8) {
        return Err(flaw(0, "gaps", Flaw::Implausible).into());
    }
    let more = if gaps.is_some() { gaps_len(count) } else { 0 };
    let (needed, got) = (curve_len(count) + more, out.len());
    let exponent = EXPONENTS.clone().find(|e| 1 << *e == nodes.len());
    let exponent = exponent.ok_or(flaw(0, "nodes", Flaw::Implausible))?;
    let no_room = EncodeError::NoRoom { needed, got };
    let out = out.get_mut(..needed).ok_or(no_room)?;
    let [a, b, c, d] = step.to_le_bytes();
    let [e, f, g, h] = band.to_le_bytes();
    let (head, places) = out.split_first_chunk_mut::<CURVE_HEAD>().ok_or(no_room)?;
    *head = [joint, exponent, u8::from(gaps.is_some()), 0, a, b, c, d, e, f, g, h];
    let (places, rest) = places.split_at_mut_checked(2 * count).ok_or(no_room)?;
    for (place, node) in places.as_chunks_mut().0.iter_mut().zip(nodes) {
        *place = node.to_le_bytes();
    }
    if let Some(gaps) = gaps {
        let bytes = gaps.band().to_le_bytes();
        let bytes = bytes.iter().chain(gaps.known());
        rest.iter_mut().zip(bytes).for_each(|(place, byte)| *place = *byte);
    }
    check(out, |_| true, |_| DecodeError::NotABlob)?;
    Ok(needed)
}
