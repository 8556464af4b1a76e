//! Numbers as they stand in tables.

use crate::headings::{Quantity, Unit};

/// A finite or infinite number with this decimal sign; separators of thousands
/// only where a fraction shows that they are such.
pub(super) fn number(text: &str, decimal: char) -> Option<f64> {
    let text = text.trim().replace('\u{2212}', "-").replace(['\u{a0}', '\u{202f}'], " ");
    let text = if text.contains(' ') { without_thousands(&text, ' ', decimal)? } else { text };
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
            ("2 041,9330", ',', Some(2041.933)),
            ("-1\u{a0}077.8", '.', Some(-1077.8)),
            ("1 2.5", '.', None),
            ("2 041", '.', None),
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
