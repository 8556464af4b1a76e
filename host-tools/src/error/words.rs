//! Messages that are short enough to be read, whatever the user's file holds.

/// Names that a message lists before it only counts.
const MOST_NAMES: usize = 40;

/// Names for a message, the first of them if there are many.
#[must_use]
pub fn listed<T: std::fmt::Display>(names: &[T]) -> String {
    let mut shown: Vec<String> = names.iter().take(MOST_NAMES).map(T::to_string).collect();
    if names.len() > MOST_NAMES {
        shown.push(format!("and {} others", names.len() - MOST_NAMES));
    }
    shown.join(", ")
}

/// `1 row`, `2 rows`.
#[must_use]
pub fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// More digits no number of a message needs.
const MOST_DIGITS: usize = 24;
/// Longer words, such as a whole line without a blank, are not read by anybody.
const LONGEST_WORD: usize = 400;
/// And no longer message, in characters.
const LONGEST_MESSAGE: usize = 4000;

/// A message whose numbers and words are short enough to be read: of longer ones
/// the beginning, and how long they are.
pub(super) fn shortened(text: String) -> String {
    let long = |word: &str| word.len() > MOST_DIGITS;
    if text.len() <= LONGEST_MESSAGE && !text.split(char::is_whitespace).any(long) {
        return text;
    }
    let mut out = String::with_capacity(text.len().min(1 << 12));
    for part in text.split_inclusive(char::is_whitespace) {
        let word = part.trim_end_matches(char::is_whitespace);
        let blank = &part[word.len()..];
        out += &match word.chars().count() {
            count if count > LONGEST_WORD => {
                let head: String = word.chars().take(60).collect();
                format!("{head}... ({count} characters)")
            }
            _ => few_digits(word),
        };
        out += blank;
    }
    match out.char_indices().nth(LONGEST_MESSAGE) {
        Some((end, _)) => format!("{}... ({} characters)", &out[..end], out.chars().count()),
        None => out,
    }
}

/// A word without numbers of hundreds of digits.
fn few_digits(word: &str) -> String {
    let mut out = String::with_capacity(word.len());
    let mut rest = word;
    while let Some(begin) = rest.find(|c: char| c.is_ascii_digit()) {
        let digits = &rest[begin..];
        let end = digits.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(digits.len());
        out += &rest[..begin];
        if end > MOST_DIGITS {
            out += &format!("{}... ({end} digits)", &digits[..12]);
        } else {
            out += &digits[..end];
        }
        rest = &digits[end..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_short() {
        let digits = format!("\"1{}\" is not a number", "0".repeat(299));
        assert_eq!(shortened(digits), "\"100000000000... (300 digits)\" is not a number");
        let word = format!("{} is\nno number", "x".repeat(1000));
        let said = shortened(word);
        assert!(said.ends_with("... (1000 characters) is\nno number"), "{said}");
        let said = shortened("x ".repeat(10_000));
        assert!(said.len() < 4100 && said.ends_with("... (20000 characters)"), "{said}");
        for plain in [
            "",
            "a\tb  c\n",
            "found 1.25, -3.1415926535897931 and 1e-300",
            "m.csv:2, column q1_deg",
        ] {
            assert_eq!(shortened(plain.to_owned()), plain);
        }
    }
}
