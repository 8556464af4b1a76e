//! Where the numbers of a blob stand, once: what a reader checks, decodes and
//! what a writer encodes is what these rows say.

use super::check::Reader;
use super::error::{DecodeError, FieldName, Flaw, Record};
use super::layout::{HAS_COVERED, HAS_LIMITS};
use crate::kinematics::LinkParameter;

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
    /// Most numbers of a field.
    pub const MOST: usize = 5;

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

    /// Its numbers in the header or a joint's record; those it has not are 0.
    // Never inlined: a blob is read once.
    #[inline(never)]
    pub fn read(&self, bytes: &[u8]) -> [f32; Self::MOST] {
        let mut values = [0.0; Self::MOST];
        let mut reader = Reader(bytes.get(usize::from(self.offset)..).unwrap_or(&[]));
        for value in values.iter_mut().take(self.count()) {
            *value = reader.f32();
        }
        values
    }

    /// Writes them; more than it has do not count.
    #[inline(never)]
    pub fn write(&self, bytes: &mut [u8], values: [f32; Self::MOST]) {
        let places = bytes.get_mut(usize::from(self.offset)..).unwrap_or(&mut []);
        let places = places.as_chunks_mut().0.iter_mut().take(self.count());
        for (place, value) in places.zip(values) {
            *place = value.to_le_bytes();
        }
    }

    fn check(&self, record: Record, bytes: &[u8], present: bool) -> Result<(), DecodeError> {
        let flaw = |index, flaw| {
            let name = FieldName { record, group: self.name, member: self.member(index) };
            Err(DecodeError::Field(name, flaw))
        };
        let values = self.read(bytes);
        for (index, value) in values.into_iter().enumerate().take(self.count()) {
            let (low, high) = if present { self.bounds(index) } else { (0.0, 0.0) };
            if !value.is_finite() {
                return flaw(index, Flaw::NotFinite);
            }
            if value < low || value > high {
                return flaw(index, Flaw::Implausible);
            }
        }
        match (self.members, values) {
            (Ends, [low, high, ..]) if low > high => flaw(0, Flaw::Inverted),
            _ => Ok(()),
        }
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
