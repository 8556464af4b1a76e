//! Where the numbers of a blob stand, once: what a reader checks, decodes and
//! what a writer encodes is what these rows say.

use super::error::{DecodeError, FieldName, Flaw, Record};
use super::layout::{HAS_COVERED, HAS_LIMITS};
use crate::kinematics::LinkParameter;
use crate::scalar::Scalar;

/// One or more binary32 numbers in a row.
pub(super) struct Field {
    name: &'static str,
    members: Members,
    /// Bytes from the start of the header or of the joint's record.
    offset: u8,
    range: Range,
    presence: Presence,
}

/// What the numbers are.
#[derive(Clone, Copy)]
enum Members {
    One,
    Xyz,
    /// The five parameters of a link.
    Link,
    /// Ends of a range, the low one first.
    Ends,
}
use Members::{Ends, Link, One, Xyz};

/// What a number may be; zero where the field is absent.
#[derive(Clone, Copy)]
enum Range {
    Within(f32),
    Between(f32, f32),
    /// Lengths and angles, each within.
    Each(f32, f32),
}
use Range::{Between, Each, Within};

/// When it is there.
#[derive(Clone, Copy)]
enum Presence {
    Always,
    /// With the masses.
    Masses,
    /// With this bit of the record's presence.
    Bit(u8),
}
use Presence::{Always, Bit, Masses};

/// Every field under its name, and all of them in the order of the byte map.
macro_rules! fields {
    ($all:ident, $($name:ident = $text:literal, $at:literal, $members:ident, $range:expr, $presence:expr;)*) => {
        $(pub(super) const $name: Field = Field {
            name: $text,
            members: $members,
            offset: $at,
            range: $range,
            presence: $presence,
        };)*
        static $all: [Field; [$($at),*].len()] = [$($name),*];
    };
}

fields! { IN_HEADER,
    BASE_TRANSLATION      = "base translation",      32, Xyz,  Within(1.0),             Always;
    BASE_ROTATION         = "base rotation",         44, Xyz,  Within(1.0),             Always;
    TOOL                  = "tool",                  56, Xyz,  Within(10.0),            Always;
    RMS_BEFORE            = "rms before",            68, One,  Between(0.0, 10.0),      Always;
    RMS_AFTER             = "rms after",             72, One,  Between(0.0, 10.0),      Always;
    REFERENCE_TEMPERATURE = "reference temperature", 76, One,  Between(-100.0, 200.0),  Always;
    GRAVITY               = "gravity",               80, Xyz,  Within(20.0),            Masses;
    PAYLOAD_POINT         = "payload point",         92, Xyz,  Within(10.0),            Masses;
}

fields! { IN_RECORD,
    NOMINAL               = "nominal",                4, Link, Each(10.0, 6.3),         Always;
    CORRECTION            = "correction",            24, Link, Each(0.2, 0.2),          Always;
    LIMITS                = "limits",                44, Ends, Within(100.0),           Bit(HAS_LIMITS);
    COVERED               = "covered range",         52, Ends, Within(100.0),           Bit(HAS_COVERED);
    MASS                  = "mass",                  60, One,  Between(0.0, 10_000.0),  Masses;
    CENTRE_OF_MASS        = "centre of mass",        64, Xyz,  Within(10.0),            Masses;
}

impl Field {
    fn count(&self) -> usize {
        match self.members {
            One => 1,
            Ends => 2,
            Xyz => 3,
            Link => 5,
        }
    }

    fn member(&self, index: usize) -> &'static str {
        let names: &[&str] = match self.members {
            One => &[""],
            Ends => &["low", "high"],
            Xyz => &["x", "y", "z"],
            Link => return LinkParameter::ALL.get(index).map_or("", |p| p.name()),
        };
        names.get(index).copied().unwrap_or("")
    }

    fn bounds(&self, index: usize) -> (f32, f32) {
        match self.range {
            Between(low, high) => (low, high),
            Within(most) => (-most, most),
            Each(length, angle) => {
                let is_length = LinkParameter::ALL.get(index).is_some_and(|p| p.is_length());
                let most = if is_length { length } else { angle };
                (-most, most)
            }
        }
    }

    fn places<'a>(&self, bytes: &'a [u8]) -> &'a [[u8; 4]] {
        bytes.get(usize::from(self.offset)..).unwrap_or(&[]).as_chunks().0
    }

    /// Its first numbers in the header or a joint's record.
    #[inline]
    pub fn read<const K: usize>(&self, bytes: &[u8]) -> [f32; K] {
        let mut places = self.places(bytes).iter();
        // A checked blob has them all.
        [(); K].map(|()| places.next().map_or(f32::NAN, |place| f32::from_le_bytes(*place)))
    }

    /// Writes these numbers there.
    #[inline(never)]
    pub fn write<T: Scalar>(&self, bytes: &mut [u8], values: &[T]) {
        let places = bytes.get_mut(usize::from(self.offset)..).unwrap_or(&mut []);
        for (place, value) in places.as_chunks_mut().0.iter_mut().zip(values) {
            *place = (value.to_f64() as f32).to_le_bytes();
        }
    }

    fn check(&self, record: Record, bytes: &[u8], present: bool) -> Result<(), DecodeError> {
        let mut before = f32::NEG_INFINITY;
        for (index, place) in self.places(bytes).iter().enumerate().take(self.count()) {
            let value = f32::from_le_bytes(*place);
            let (low, high) = self.bounds(index);
            // NaN fails as well; where nothing is, -0 does, which is not the byte 0.
            let fits = if present { low <= value && value <= high } else { *place == [0; 4] };
            if !fits {
                let finite = value.is_finite();
                let flaw = if finite { Flaw::Implausible } else { Flaw::NotFinite };
                return self.refuse(record, index, flaw);
            }
            if value < before && matches!(self.members, Ends) {
                return self.refuse(record, 0, Flaw::Inverted);
            }
            before = value;
        }
        Ok(())
    }

    #[cold]
    #[inline(never)]
    fn refuse(&self, record: Record, index: usize, flaw: Flaw) -> Result<(), DecodeError> {
        let name = FieldName { record, group: self.name, member: self.member(index) };
        Err(DecodeError::Field(name, flaw))
    }
}

/// All numbers of the header, or of a joint's record with these presence bits.
pub(super) fn check(
    record: Record,
    bytes: &[u8],
    masses: bool,
    presence: u8,
) -> Result<(), DecodeError> {
    let fields: &[Field] = if record == Record::Header { &IN_HEADER } else { &IN_RECORD };
    fields.iter().try_for_each(|field| {
        let present = match field.presence {
            Always => true,
            Masses => masses,
            Bit(bit) => presence & bit != 0,
        };
        field.check(record, bytes, present)
    })
}
