//! Which values make plausible: in a robot.toml, and in a model.toml.

use std::ops::RangeInclusive;

use super::keys::RobotFile;

/// What values of a file may be.
pub(super) struct Plausible {
    /// Size of gravity, m/s^2.
    pub gravity: RangeInclusive<f64>,
    /// Degrees Celsius.
    pub temperature: RangeInclusive<f64>,
    /// Of a link, kg.
    pub mass: RangeInclusive<f64>,
    /// Whether limits are asked whether they are radians.
    pub limits: bool,
}

impl Plausible {
    /// What a person who describes an arm can mean: gravity anywhere on Earth is
    /// 9.76 to 9.84 m/s^2, nobody measures in an oven, and links weigh something.
    const PERSON: Self = Self {
        gravity: 9.7..=9.9,
        temperature: -60.0..=120.0,
        mass: f64::MIN_POSITIVE..=5_000.0,
        limits: true,
    };
    /// What a blob may hold (FORMAT.md), and so a model.toml that was unpacked.
    const BLOB: Self = Self {
        gravity: 0.0..=35.0,
        temperature: -100.0..=200.0,
        mass: 0.0..=10_000.0,
        limits: false,
    };

    /// By whether the file is a model.
    pub fn of(file: &RobotFile) -> &'static Self {
        if file.schema.is_some() { &Self::BLOB } else { &Self::PERSON }
    }
}
