//! Numbers and names of files as the page says them.

/// The last part of a path: where a file stands is no business of a report's reader.
pub fn file_name(path: &str) -> String {
    let name = std::path::Path::new(path).file_name();
    name.map_or_else(|| path.to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Numbers with runs drawn together: 1 to 3, 5.
pub fn runs(numbers: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for n in numbers {
        match runs.last_mut() {
            Some((_, last)) if *n == *last + 1 => *last = *n,
            _ => runs.push((*n, *n)),
        }
    }
    let one = |(first, last): &(usize, usize)| match last - first {
        0 => format!("{first}"),
        1 => format!("{first}, {last}"),
        _ => format!("{first} to {last}"),
    };
    runs.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// A number of any size in three digits.
pub fn digits(value: f64) -> String {
    match value.abs() {
        a if a == 0.0 || (1e-2..1e4).contains(&a) => {
            let places = (2.0 - a.max(1e-9).log10().floor()).clamp(0.0, 4.0) as usize;
            let text = format!("{value:.places$}");
            let text =
                if places > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
            text.to_owned()
        }
        _ => format!("{value:.2e}"),
    }
}

/// Millimetres as the page says them.
pub fn mm(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0} mm"),
        v if v >= 1.0 => format!("{v:.2} mm"),
        v => format!("{v:.3} mm"),
    }
}

/// How often a wave comes back, in words.
pub fn cycles(order: f64) -> String {
    match order {
        1.0 => "once a turn".to_owned(),
        2.0 => "twice a turn".to_owned(),
        n => format!("{} cycles a turn", (n * 100.0).round() / 100.0),
    }
}

/// After how many degrees.
pub fn period(order: f64) -> String {
    format!("{} degrees", (360.0 / order * 1e4).round() / 1e4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_a_row_are_drawn_together() {
        assert_eq!(runs(&[1, 2, 3, 4, 6]), "1 to 4, 6");
        assert_eq!(runs(&[2, 3]), "2, 3");
        assert_eq!(runs(&[]), "");
    }
}
