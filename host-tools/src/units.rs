//! The units of files and texts: millimetres and degrees. Everything inside is
//! SI; numbers change their unit on their way in or out. What files hold is read and written by
//! these functions; a figure of a report or a sentence may be scaled where it is made.

use nalgebra::Vector3;
use truearm::{JointKind, LinkParameter};

/// A time in seconds in words: `40 s`, `25 min`, `2.5 h`.
#[must_use]
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A joint value in degrees, of a prismatic joint in mm.
#[must_use]
pub fn joint_to_file(kind: JointKind, value: f64) -> f64 {
    match kind {
        JointKind::Revolute => value.to_degrees(),
        JointKind::Prismatic => value * 1e3,
    }
}

/// A joint value from degrees, of a prismatic joint from mm.
#[must_use]
pub fn joint_from_file(kind: JointKind, value: f64) -> f64 {
    match kind {
        JointKind::Revolute => value.to_radians(),
        JointKind::Prismatic => value * 1e-3,
    }
}

/// The same as it is read again: the number of a file that [`joint_from_file`] makes
/// this value of. Where rounding leaves none, the nearest that is read as more, or as less.
#[must_use]
pub fn joint_to_file_at(kind: JointKind, value: f64, end: End) -> f64 {
    let read = |number: f64| joint_from_file(kind, number);
    let plain = joint_to_file(kind, value);
    if read(plain) == value || !value.is_finite() {
        return plain;
    }
    let [out, back]: [fn(f64) -> f64; 2] = match end {
        End::Up => [f64::next_up, f64::next_down],
        End::Down => [f64::next_down, f64::next_up],
    };
    let holds = |number: f64| match end {
        End::Up => read(number) >= value,
        End::Down => read(number) <= value,
    };
    let mut number = plain;
    while !holds(number) {
        number = out(number);
    }
    while holds(back(number)) {
        number = back(number);
    }
    // As what was read is written again.
    let again = joint_to_file(kind, read(number));
    if read(again) == read(number) { again } else { number }
}

/// To which side a number is rounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// To what is read as no less.
    Up,
    /// To what is read as no more.
    Down,
}

/// The unit of a joint value in a text.
#[must_use]
pub const fn joint_unit(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "degrees",
        JointKind::Prismatic => "mm",
    }
}

/// Name of the column of a joint's values, the joint counted from 0: `q1_deg`,
/// `q3_mm`.
#[must_use]
pub fn joint_column(prefix: &str, joint: usize, kind: JointKind) -> String {
    let unit = match kind {
        JointKind::Revolute => "deg",
        JointKind::Prismatic => "mm",
    };
    format!("{prefix}{}_{unit}", joint + 1)
}

/// Unit of a millionth of a joint's SI unit.
#[must_use]
pub fn joint_micro(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "urad",
        JointKind::Prismatic => "um",
    }
}

/// Degrees in a radian.
pub const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Millimetres in a metre; also milliradians in a radian.
pub const MILLI: f64 = 1e3;
/// Micrometres in a metre.
pub const MICRO: f64 = 1e6;

/// A length in mm.
#[must_use]
pub fn to_mm(metres: f64) -> f64 {
    metres * 1e3
}

/// A length from mm.
#[must_use]
pub fn from_mm(mm: f64) -> f64 {
    mm * 1e-3
}

/// A point in mm.
#[must_use]
pub fn point_to_mm(point: &Vector3<f64>) -> [f64; 3] {
    [point.x, point.y, point.z].map(to_mm)
}

/// A point from mm.
#[must_use]
pub fn point_from_mm(mm: [f64; 3]) -> Vector3<f64> {
    Vector3::from(mm) * 1e-3
}

/// The unit of a link parameter, and how many of it one of SI is.
#[must_use]
pub fn link_unit(parameter: LinkParameter) -> (&'static str, f64) {
    if parameter.is_length() { ("mm", MILLI) } else { ("deg", DEGREES) }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    /// Numbers of files come back to the bit, any value no farther than a rounding and
    /// on its side, and what was read is written again as it stood.
    #[test]
    fn numbers_are_read_again_on_their_side() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for kind in [JointKind::Revolute, JointKind::Prismatic] {
            for _ in 0..100_000 {
                let any: f64 = rng.random_range(-400.0..400.0);
                let three = (any * 1e3).round() / 1e3;
                for value in [joint_from_file(kind, three), any / 57.0, any / 57e3] {
                    let [low, high] = [End::Down, End::Up].map(|end| {
                        let number = joint_to_file_at(kind, value, end);
                        let read = joint_from_file(kind, number);
                        assert_eq!(joint_to_file_at(kind, read, end), number, "{value:?}");
                        read
                    });
                    assert!(low <= value && value <= high, "{low:?} {value:?} {high:?}");
                    assert!(high - low <= 4.0 * f64::EPSILON * value.abs(), "{value:?}");
                }
                let value = joint_from_file(kind, three);
                let number = joint_to_file_at(kind, value, End::Up);
                assert_eq!(joint_from_file(kind, number), value, "{three}");
            }
        }
    }
}
