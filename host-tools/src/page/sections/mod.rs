//! Sections of pages, a file each.

mod corrections;
mod effects;
mod flagged;
mod gap;
mod lambda;
mod left;
pub mod next;
mod unknown;
mod workspace;

pub use corrections::corrections;
pub use effects::{effects, short};
pub use flagged::{flagged, remarks};
pub use gap::gap;
pub use lambda::lambda;
pub use left::left;
pub use unknown::unknown;
pub use workspace::workspace;

use crate::markup::{Element, Node, element};

/// A table under a head.
pub fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Element {
    let line = |kind: &'static str, cells: Vec<String>| {
        element("tr").children(cells.into_iter().map(|cell| element(kind).text(cell)))
    };
    let head = element("thead").child(line("th", head.iter().map(|h| (*h).to_owned()).collect()));
    let body = element("tbody").children(rows.into_iter().map(|cells| line("td", cells)));
    element("div").with("class", "table").child(element("table").child(head).child(body))
}

/// Lines one below the other.
pub fn list(lines: impl IntoIterator<Item = String>) -> Element {
    element("ul").children(lines.into_iter().map(|line| element("li").text(line)))
}

/// Lines that are folded away where there are more than a few.
pub fn folded(lines: &[String], what: &str) -> Node {
    const FEW: usize = 6;
    let all = list(lines.iter().cloned());
    if lines.len() <= FEW {
        return all.into();
    }
    let summary = element("summary").text(format!("{} {what}", lines.len()));
    element("details").child(summary).child(all).into()
}

/// Something to type.
pub fn typed(lines: &[String]) -> Element {
    element("pre").child(element("code").text(lines.join("\n")))
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

/// Millimetres as the page says them.
pub fn mm(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0} mm"),
        v if v >= 1.0 => format!("{v:.2} mm"),
        v => format!("{v:.3} mm"),
    }
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
