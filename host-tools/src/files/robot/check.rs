use std::ops::Range;

use toml::Spanned;

use super::plausible::Plausible;
use crate::error::Result;
use crate::files::source::Source;
use crate::units::from_mm;

/// Checks of values, and what looks wrong but may be meant.
pub(super) struct Checker<'a> {
    pub source: Source<'a>,
    pub warnings: Vec<String>,
    /// What values may be.
    pub plausible: &'static Plausible,
}

impl Checker<'_> {
    pub fn warn(&mut self, message: String) {
        self.warnings.push(format!("{}: {message}", self.source.path.display()));
    }

    /// Whether truearm handles so many joints.
    pub fn count(&self, joints: usize) -> Result<()> {
        if joints == 0 {
            let help = match self.source.text.contains("[[joint]]") {
                true => "write [[joints]] where [[joint]] stands",
                false => {
                    "add one [[joints]] table a joint: alpha_deg, a_mm, d_mm, theta_offset_deg"
                }
            };
            return Err(self.source.whole("no [[joints]]", help));
        }
        if joints > truearm::MAX_JOINTS {
            let help = format!("truearm handles up to {}", truearm::MAX_JOINTS);
            return Err(self.source.whole(format!("{joints} joints"), help));
        }
        Ok(())
    }

    pub fn finite(&self, span: Range<usize>, key: &str, values: &[f64]) -> Result<()> {
        match values.iter().find(|v| !v.is_finite()) {
            Some(v) => Err(self.source.at(span, format!("{key} is {v}"), "give a finite number")),
            None => Ok(()),
        }
    }

    /// A length in mm, to m.
    pub fn length(&self, key: &str, value: &Spanned<f64>) -> Result<f64> {
        let (span, value) = (value.span(), *value.get_ref());
        self.finite(span.clone(), key, &[value])?;
        if value.abs() > 10_000.0 {
            let help = "lengths are mm, up to 10 m";
            return Err(self.source.at(span, format!("{key} = {value}"), help));
        }
        Ok(from_mm(value))
    }

    /// An angle in degrees, to rad.
    pub fn angle(&mut self, key: &str, value: &Spanned<f64>) -> Result<f64> {
        self.angle_of(key, value.span(), *value.get_ref())
    }

    /// The same of a number that stands in these bytes.
    pub fn angle_of(&mut self, key: &str, span: Range<usize>, value: f64) -> Result<f64> {
        self.finite(span.clone(), key, &[value])?;
        // As a blob holds them, which has room for a little more than a turn.
        if value.to_radians().abs() as f32 > 6.3 {
            let help = "angles are degrees, up to 360";
            return Err(self.source.at(span, format!("{key} = {value}"), help));
        }
        let half_turns = value.abs() / std::f64::consts::FRAC_PI_2;
        // What rounds to no turn at all is the rounding of some converter.
        if half_turns > 0.5 && (half_turns - half_turns.round()).abs() < 1e-3 && half_turns < 4.5 {
            let line = self.source.line(span.start);
            self.warn(format!(
                "line {line}: {key} = {value} looks like radians; degrees are expected"
            ));
        }
        Ok(value.to_radians())
    }
}

/// Longest name, in characters.
const LONGEST_NAME: usize = 200;

/// A name that can stand on a console and on a page.
pub(super) fn printable(source: &Source, key: &str, name: &str) -> Result<()> {
    let help = "give a name of one line";
    if name.chars().any(char::is_control) {
        return Err(source.whole(format!("{key} has control characters"), help));
    }
    match name.chars().count() {
        0..=LONGEST_NAME => Ok(()),
        count => Err(source.whole(format!("{key} of {count} characters"), help)),
    }
}
