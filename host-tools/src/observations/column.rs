//! Columns of a file and units of what is measured.

/// A column of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Its name; the unit is its end: `_mm` becomes m, `_deg` rad, others stay.
    pub name: &'static str,
    /// Every value is within, SI.
    pub within: [f64; 2],
    /// What to do where it is missing.
    pub missing: &'static str,
    /// What to do where a value is not.
    pub wrong: &'static str,
}

impl Column {
    /// One unit of the file in SI.
    #[must_use]
    pub fn unit(&self) -> f64 {
        match self.name.rsplit_once('_') {
            Some((_, "mm")) => 1e-3,
            Some((_, "deg")) => 1_f64.to_radians(),
            _ => 1.0,
        }
    }

    /// What is wrong with a value, in words.
    #[must_use]
    pub fn too_large(&self, value: f64) -> String {
        let unit = match self.name.rsplit_once('_') {
            Some((_, "mm")) => " m away",
            Some((_, "deg")) => " rad",
            _ => "",
        };
        format!("{value}{unit}")
    }
}

/// What a number of a residual is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// m; files say mm.
    Length,
    /// rad; files say degrees.
    Angle,
    /// px
    Pixel,
}

impl Measure {
    /// The unit in files.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Length => "mm",
            Self::Angle => "deg",
            Self::Pixel => "px",
        }
    }

    /// A value in that unit.
    #[must_use]
    pub fn to_file(self, value: f64) -> f64 {
        match self {
            Self::Length => value * 1e3,
            Self::Angle => value.to_degrees(),
            Self::Pixel => value,
        }
    }
}
