//! Numbers and times as they stand in tables.

use crate::headings::{Quantity, Unit};

/// A finite or infinite number with this decimal sign; separators of thousands
/// only where a fraction shows that they are such.
pub(super) fn number(text: &str, decimal: char) -> Option<f64> {
    let text = text.trim().replace('\u{2212}', "-");
    let plain = match decimal {
        ',' if text.contains('.') && !text.contains(',') => return None,
        ',' if text.contains('.') => without_thousands(&text, '.', ',')?.replace(',', "."),
        ',' => text.replacen(',', ".", 1),
        _ if text.contains(',') => without_thousands(&text, ',', '.')?,
        _ if text.contains('\'') => without_thousands(&text, '\'', '.')?,
        _ => text,
    };
    // Rust reads "infinity" and "nan" too: they are no measurement, but numbers.
    let d = plain.replace(['d', 'D'], "e");
    let fortran = d.bytes().any(|b| b.is_ascii_digit()) && !plain.contains(['e', 'E']);
    plain.parse().ok().or_else(|| if fortran { d.parse().ok() } else { None })
}

/// A number and the unit behind it; `None` of everything else.
pub(super) fn cut(cell: &str, decimal: char) -> Option<(String, Unit)> {
    let last = cell.rfind(|c: char| c.is_ascii_digit())?;
    let (bare, rest) = cell.split_at(last + 1);
    let unit = Unit::of_word(rest.trim()).filter(|_| !rest.trim().is_empty())?;
    let measures = [Quantity::Angle, Quantity::Length].contains(&unit.quantity());
    (measures && number(bare, decimal).is_some()).then(|| (bare.to_owned(), unit))
}

/// `1,234.5` as `1234.5`: groups of three, and a fraction behind them.
fn without_thousands(text: &str, group: char, decimal: char) -> Option<String> {
    let (whole, fraction) = text.split_once(decimal)?;
    let mut groups = whole.trim_start_matches(['-', '+']).split(group);
    let first = groups.next()?;
    let sound = (1..=3).contains(&first.len()) && groups.all(|g| g.len() == 3);
    (sound && !fraction.contains(group)).then(|| text.replace(group, ""))
}

/// Seconds of a date and a time of day, since the year 1970, or of a time of day
/// since midnight: `2021-03-05 12:03:55.2`, `05.03.2021 12:03:55`, `12:03:55`.
pub(super) fn seconds(text: &str) -> Option<f64> {
    let text = text.trim().trim_end_matches('Z');
    let (date, clock) = match text.split_once(['T', ' ']) {
        Some((date, clock)) => (Some(date), clock.trim()),
        None => (None, text),
    };
    let mut parts = clock.split(':');
    let mut part = |most: f64| {
        let value: f64 = parts.next()?.replace(',', ".").parse().ok()?;
        (0.0..most).contains(&value).then_some(value)
    };
    let (hours, minutes) = (part(24.0)?, part(60.0)?);
    let seconds = part(61.0).unwrap_or(0.0);
    let days = match date {
        Some(date) => days(date)? as f64,
        None => 0.0,
    };
    parts.next().is_none().then_some(((days * 24.0 + hours) * 60.0 + minutes) * 60.0 + seconds)
}

/// Days since 1970 of `2021-03-05`, `2021/03/05` or `05.03.2021`. Slashes with
/// the year behind are days first to some and months first to others: `None`.
fn days(date: &str) -> Option<i64> {
    let cut = |separator| {
        date.split(separator).map(|p| p.parse::<i64>().ok()).collect::<Option<Vec<_>>>()
    };
    let [year, month, day] = match (cut('-'), cut('/'), cut('.')) {
        (Some(p), _, _) | (_, Some(p), _) if p.len() == 3 && p[0] > 31 => [p[0], p[1], p[2]],
        (_, _, Some(p)) if p.len() == 3 => [p[2], p[1], p[0]],
        _ => return None,
    };
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1900..3000).contains(&year) {
        return None;
    }
    // Howard Hinnant, days_from_civil.
    let year = if month <= 2 { year - 1 } else { year };
    let of_era = year.rem_euclid(400);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(
        year.div_euclid(400) * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year
            - 719_468,
    )
}

/// With at most so many decimals, and no zeros behind the last one that counts.
pub(super) fn plain(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        for (text, decimal, value) in [
            ("1,5", ',', Some(1.5)),
            ("1.5", ',', None),
            ("1.234,5", ',', Some(1234.5)),
            ("1,234.5", '.', Some(1234.5)),
            ("1'234.5", '.', Some(1234.5)),
            ("12,34.5", '.', None),
            ("1,5", '.', None),
            ("-3e-4", '.', Some(-3e-4)),
            ("1.5D+02", '.', Some(150.0)),
            ("\u{2212}2", '.', Some(-2.0)),
            ("", '.', None),
            ("d", '.', None),
        ] {
            assert_eq!(number(text, decimal), value, "{text}");
        }
    }

    #[test]
    fn times() {
        for (text, value) in [
            ("12:03:55", Some(43_435.0)),
            ("1970-01-02 00:00:01", Some(86_401.0)),
            ("05.03.2021 12:03:55,5", Some(1_614_945_835.5)),
            ("2021-03-05T12:03:55.5Z", Some(1_614_945_835.5)),
            ("03/05/2021 12:03:55", None),
            ("25:00", None),
            ("12", None),
        ] {
            assert_eq!(seconds(text), value, "{text}");
        }
    }

    #[test]
    fn no_digits_too_many() {
        for (value, text) in
            [(-30.000000000000004, "-30"), (1e-9, "0"), (-1e-9, "0"), (100.0, "100")]
        {
            assert_eq!(plain(value, 7), text);
        }
        assert_eq!(plain(100.0, 0), "100");
    }

    #[test]
    fn numbers_with_units() {
        for (cell, decimal, expected) in [
            ("12.3°", '.', Some(("12.3", Unit::Deg))),
            ("5 mm", '.', Some(("5", Unit::Mm))),
            ("-0,25 rad", ',', Some(("-0,25", Unit::Rad))),
            ("12", '.', None),
            ("J1", '.', None),
            ("12°30'", '.', None),
            ("3 kg", '.', None),
            ("P7 mm", '.', None),
        ] {
            let expected = expected.map(|(bare, unit)| (bare.to_owned(), unit));
            assert_eq!(cut(cell, decimal), expected, "{cell}");
        }
    }
}
