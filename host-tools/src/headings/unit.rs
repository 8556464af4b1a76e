//! Units as authors write them.

/// What a quantity is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// An angle, in degrees in files.
    Angle,
    /// A length, in mm in files.
    Length,
    /// A time, in s.
    Time,
    /// A temperature, in degrees Celsius.
    Temperature,
    /// A mass, in kg.
    Mass,
    /// A number, a label.
    Plain,
}

/// A unit that columns come in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Degrees.
    Deg,
    /// Radians.
    Rad,
    /// Milliradians.
    Mrad,
    /// Turns.
    Turn,
    /// Gons: 400 a turn.
    Gon,
    /// Millimetres.
    Mm,
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Micrometres.
    Um,
    /// Inches.
    Inch,
    /// Feet.
    Foot,
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
    /// Minutes.
    Min,
    /// Hours.
    H,
    /// Degrees Celsius.
    C,
    /// Kelvin.
    K,
    /// Degrees Fahrenheit.
    F,
    /// Kilograms.
    Kg,
    /// Grams.
    G,
    /// Pounds.
    Lb,
    /// None.
    Plain,
}

/// Unit, how truearm writes it, how others do, and how many of the file's unit
/// (degrees, mm, s, kg) one of it is.
const UNITS: [(Unit, Quantity, &[&str], f64); 24] = [
    (Unit::Deg, Quantity::Angle, &["deg", "degree", "degrees", "°", "grad", "º"], 1.0),
    (Unit::Rad, Quantity::Angle, &["rad", "radian", "radians", "rads"], crate::units::DEGREES),
    (Unit::Mrad, Quantity::Angle, &["mrad"], crate::units::DEGREES * 1e-3),
    (Unit::Turn, Quantity::Angle, &["turn", "turns", "rev"], 360.0),
    (Unit::Gon, Quantity::Angle, &["gon", "gons"], 0.9),
    (Unit::Mm, Quantity::Length, &["mm", "millimeter", "millimetre", "millimeters"], 1.0),
    (Unit::M, Quantity::Length, &["m", "meter", "metre", "meters", "metres"], 1e3),
    (Unit::Cm, Quantity::Length, &["cm"], 10.0),
    (Unit::Um, Quantity::Length, &["um", "µm", "μm"], 1e-3),
    (Unit::Inch, Quantity::Length, &["in", "inch", "inches", "zoll"], 25.4),
    (Unit::Foot, Quantity::Length, &["ft", "foot", "feet"], 304.8),
    (Unit::S, Quantity::Time, &["s", "sec", "secs", "second", "seconds", "sek", "sekunden"], 1.0),
    (Unit::Ms, Quantity::Time, &["ms", "msec"], 1e-3),
    (Unit::Us, Quantity::Time, &["us", "µs"], 1e-6),
    (Unit::Ns, Quantity::Time, &["ns", "nsec"], 1e-9),
    (Unit::Min, Quantity::Time, &["min", "mins", "minute", "minutes", "minuten"], 60.0),
    (Unit::H, Quantity::Time, &["h", "hr", "hrs", "hour", "hours", "stunden"], 3600.0),
    (Unit::C, Quantity::Temperature, &["c", "°c", "degc", "celsius"], 1.0),
    (Unit::K, Quantity::Temperature, &["k", "kelvin"], 1.0),
    (Unit::F, Quantity::Temperature, &["f", "°f", "degf", "fahrenheit"], 5.0 / 9.0),
    (Unit::Kg, Quantity::Mass, &["kg"], 1.0),
    (Unit::G, Quantity::Mass, &["g", "gram", "grams"], 1e-3),
    (Unit::Lb, Quantity::Mass, &["lb", "lbs", "pound", "pounds"], 0.453_592_37),
    (Unit::Plain, Quantity::Plain, &["-", "none", "n/a"], 1.0),
];

impl Unit {
    fn row(self) -> &'static (Self, Quantity, &'static [&'static str], f64) {
        UNITS.iter().find(|row| row.0 == self).unwrap_or(&UNITS[UNITS.len() - 1])
    }

    /// What it measures.
    #[must_use]
    pub fn quantity(self) -> Quantity {
        self.row().1
    }

    /// As truearm writes it.
    #[must_use]
    pub fn word(self) -> &'static str {
        self.row().2[0]
    }

    /// From a word, brackets around it or not: `[mm]`, `(rad)`, `°`.
    #[must_use]
    pub fn of_word(text: &str) -> Option<Self> {
        let word = text.trim().trim_matches(['[', ']', '(', ')', '{', '}', '/', '.']).trim();
        let word = word.to_lowercase();
        UNITS.iter().find(|row| row.2.contains(&word.as_str())).map(|row| row.0)
    }

    /// A value of this unit in that of the files: degrees, mm, s, Celsius, kg.
    #[must_use]
    pub fn to_file(self, value: f64) -> f64 {
        match self {
            Self::K => value - 273.15,
            Self::F => (value - 32.0) * self.row().3,
            _ => value * self.row().3,
        }
    }

    /// Its quantity's unit in the files of truearm.
    #[must_use]
    pub fn of_files(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Angle => Self::Deg,
            Quantity::Length => Self::Mm,
            Quantity::Time => Self::S,
            Quantity::Temperature => Self::C,
            Quantity::Mass => Self::Kg,
            Quantity::Plain => Self::Plain,
        }
    }
}
