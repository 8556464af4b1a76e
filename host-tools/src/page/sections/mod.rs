//! Sections of pages, a file each.

mod corrections;
mod effects;
mod flagged;
mod gap;
mod lambda;
mod measured;
pub mod next;
mod unexplained;
mod unknown;
mod workspace;

pub use corrections::corrections;
pub use effects::{effects, short};
pub use flagged::{flagged, remarks};
pub use gap::gap;
pub use lambda::lambda;
pub use measured::measured;
pub use unexplained::unexplained;
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

/// Something that is folded away until it is asked for.
pub fn details(summary: &str, what: Element) -> Element {
    element("details").child(element("summary").text(summary)).child(what)
}

/// Lines that are folded away where there are more than a few.
pub fn folded(lines: &[String], what: &str) -> Node {
    const FEW: usize = 6;
    let all = list(lines.iter().cloned());
    if lines.len() <= FEW {
        return all.into();
    }
    details(&format!("{} {what}", lines.len()), all).into()
}

/// Something to type.
pub fn typed(lines: &[String]) -> Element {
    element("pre").child(element("code").text(lines.join("\n")))
}
