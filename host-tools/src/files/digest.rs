//! A digest of what an identified arm is in numbers, so that a model.toml whose
//! terms were changed by hand does not claim the accuracy it had before.

use toml::{Table, Value};

/// What the digest covers.
const COVERED: [&str; 7] =
    ["joints", "corrections", "terms", "measurement_terms", "curves", "frame", "base"];
/// What may be edited in it: where the arm may go, what is known of its type, and how well it is known.
const FREE: [&str; 11] = [
    "limits_deg",
    "limits_mm",
    "gear_ratio",
    "tolerance",
    "expected",
    "sigma",
    "covered_deg",
    "covered_mm",
    "band_rad",
    "gap_band_rad",
    "gaps_deg",
];

/// Of a model.toml: the same for the same values, however they are laid out.
pub(super) fn digest(text: &str) -> String {
    let mut file: Table = text.parse().unwrap_or_default();
    file.retain(|key, _| COVERED.contains(&key));
    for value in file.iter_mut().filter_map(|(_, value)| value.as_array_mut()).flatten() {
        if let Value::Table(entry) = value {
            entry.retain(|key, _| !FREE.contains(&key));
        }
    }
    of_text(&file.to_string())
}

/// Of a text as it stands: FNV-1a, against accidents, not against forgers.
pub(super) fn of_text(text: &str) -> String {
    format!("{:016x}", digest_of_text(text))
}

/// The same as a number.
#[must_use]
pub fn digest_of_text(text: &str) -> u64 {
    digest_of_bytes(text.as_bytes())
}

/// The same of bytes.
#[must_use]
pub fn digest_of_bytes(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
