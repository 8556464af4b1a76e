//! A heading as words and a unit.

use super::unit::Unit;

/// A heading taken apart.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Heading {
    /// As it stands in the file; empty in a table without headings.
    pub text: String,
    /// Its words in lower case, numbers apart from letters, without the unit.
    pub words: Vec<String>,
    /// Its unit, if it says one.
    pub unit: Option<Unit>,
    /// What stands where a unit does and is none that is known: `counts`.
    pub strange: Option<String>,
}

/// Units of joints and points that are met and are none that can be converted
/// without knowing more.
const STRANGE: [&str; 24] = [
    "counts",
    "count",
    "cts",
    "ticks",
    "tick",
    "inc",
    "incs",
    "increments",
    "pulses",
    "pulse",
    "steps",
    "lsb",
    "arcmin",
    "arcsec",
    "urad",
    "µrad",
    "dm",
    "nm",
    "km",
    "yd",
    "mil",
    "mils",
    "thou",
    "px",
];
/// In square brackets stand units, but for these and numbers: `joint[1]`, `pos[x]`.
const NO_UNITS: [&str; 12] =
    ["x", "y", "z", "w", "act", "actual", "meas", "measured", "cmd", "nominal", "tcp", "tracker"];

/// Units of a letter are read as such behind a separator only: `x_m`.
const LETTERS: [&str; 7] = ["m", "s", "c", "k", "g", "f", "h"];

/// Under these `min` is a minute; elsewhere it is the least.
const CLOCKS: [&str; 6] = ["time", "zeit", "timestamp", "elapsed", "duration", "dauer"];

impl Heading {
    /// Takes `text` apart: `q1_deg`, `J1 [rad]`, `Pos X (mm)`, `actual_q_0`.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let (rest, bracketed) = bracketed(text);
        let mut strange = strange(&rest);
        let named = strange.as_ref().and_then(|unit| rest.rsplit_once(unit.as_str()));
        let named = named.map_or_else(|| rest.clone(), |(before, after)| [before, after].concat());
        let mut words = words(&named);
        let mut unit = bracketed;
        if unit.is_none() && words.len() > 1 {
            let last = words.last().map(String::as_str).unwrap_or_default();
            let found = Unit::of_word(last).filter(|u| *u != Unit::Plain);
            let letter = LETTERS.contains(&last);
            let number = words[words.len() - 2].chars().all(|c| c.is_ascii_digit());
            // `joint_1_s` is no time, and `wrist_1_c` no temperature.
            let told = found.filter(|unit| !long(*unit) || CLOCKS.contains(&words[0].as_str()));
            if let Some(found) = told.filter(|_| !letter || !number || last == "m") {
                unit = Some(found);
                words.pop();
            }
        }
        strange = strange.filter(|_| unit.is_none());
        Self { text: text.trim().to_owned(), words, unit, strange }
    }
}

/// Whether it is a unit of long times.
fn long(unit: Unit) -> bool {
    matches!(unit, Unit::Min | Unit::H)
}

/// The text without a unit in brackets, and the unit.
fn bracketed(text: &str) -> (String, Option<Unit>) {
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')] {
        let Some(begin) = text.find(open) else { continue };
        let Some(length) = text[begin..].find(close) else { continue };
        let inside = &text[begin + open.len_utf8()..begin + length];
        let Some(unit) = Unit::of_word(inside) else { continue };
        let rest = [&text[..begin], &text[begin + length + close.len_utf8()..]].concat();
        let clock = |word: &String| word == "t" || CLOCKS.contains(&word.as_str());
        if !long(unit) || words(&rest).first().is_some_and(clock) {
            return (rest, Some(unit));
        }
    }
    match text.rsplit_once('/').and_then(|(rest, unit)| Some((rest, Unit::of_word(unit)?))) {
        Some((rest, unit)) => (rest.to_owned(), Some(unit)),
        None => (text.to_owned(), None),
    }
}

/// What stands in brackets, or at the end, in place of a unit and is none.
fn strange(text: &str) -> Option<String> {
    let known = |inside: &str| STRANGE.contains(&inside.to_lowercase().as_str());
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some((_, rest)) = text.split_once(open) else { continue };
        let inside = rest.split(close).next().unwrap_or_default().trim();
        let word = !NO_UNITS.contains(&inside.to_lowercase().as_str());
        let unit = !inside.is_empty() && word && !inside.contains(|c: char| c.is_ascii_digit());
        if known(inside) || open == '[' && unit {
            return Some(inside.to_owned());
        }
    }
    text.rsplit_once('_').map(|(_, last)| last.trim()).filter(|last| known(last)).map(str::to_owned)
}

/// In lower case: cut at everything that is neither letter nor digit, between
/// letters and digits, and before a capital that follows a word.
fn words(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    // Letters of the last word: counted along, as a word may be a whole line.
    let mut length = 0;
    for c in text.chars() {
        let turns = before.is_numeric() != c.is_numeric();
        let camel = length > 1 && before.is_lowercase() && c.is_uppercase();
        if !c.is_alphanumeric() && c != '°' && c != 'µ' || length > 0 && (turns || camel) {
            words.push(String::new());
            length = 0;
        }
        if let Some(word) = words.last_mut().filter(|_| c.is_alphanumeric() || "°µ".contains(c)) {
            word.extend(c.to_lowercase());
            length += c.to_lowercase().count();
        }
        before = c;
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_that_are_none() {
        for (text, strange) in [
            ("J1 [counts]", Some("counts")),
            ("x (dm)", Some("dm")),
            ("q1_ticks", Some("ticks")),
            ("q2 [furlong]", Some("furlong")),
            ("x (ft)", None),
            ("q1 [gon]", None),
            ("joint[1]", None),
            ("pos[x]", None),
            ("X [measured]", None),
            ("X (measured)", None),
            ("q1 [rad]", None),
        ] {
            assert_eq!(Heading::new(text).strange.as_deref(), strange, "{text}");
        }
    }

    #[test]
    fn headings_are_taken_apart() {
        for (text, expected, unit) in [
            ("q1_deg", vec!["q", "1"], Some(Unit::Deg)),
            ("J1 [rad]", vec!["j", "1"], Some(Unit::Rad)),
            ("Pos X (mm)", vec!["pos", "x"], Some(Unit::Mm)),
            ("actual_q_0", vec!["actual", "q", "0"], None),
            ("JointAngle3", vec!["joint", "angle", "3"], None),
            ("x_m", vec!["x"], Some(Unit::M)),
            ("X", vec!["x"], None),
            ("m", vec!["m"], None),
            ("X/mm", vec!["x"], Some(Unit::Mm)),
            ("Temperatur [°C]", vec!["temperatur"], Some(Unit::C)),
            ("A1 (°)", vec!["a", "1"], Some(Unit::Deg)),
            ("time_s", vec!["time"], Some(Unit::S)),
            ("q3_m", vec!["q", "3"], Some(Unit::M)),
            ("wrist_1_c", vec!["wrist", "1", "c"], None),
            ("time [min]", vec!["time"], Some(Unit::Min)),
            ("Zeit [h]", vec!["zeit"], Some(Unit::H)),
            ("t (min)", vec!["t"], Some(Unit::Min)),
            ("time_min", vec!["time"], Some(Unit::Min)),
            ("X (min)", vec!["x", "min"], None),
            ("x_min", vec!["x", "min"], None),
        ] {
            let heading = Heading::new(text);
            assert_eq!(heading.words, expected, "{text}");
            assert_eq!(heading.unit, unit, "{text}");
        }
    }
}
