//! Fixed columns: cells by where they stand in the line.

use super::layout::Layout;
use super::sniff::{Line, commonest};

/// Cuts the lines from the headings on where all of them are blank, if blanks
/// alone do not give every line the same number of cells; `None` if they do, or
/// if nothing is gained.
pub(super) fn cut(text: &str, lines: &[Line], layout: Layout) -> Option<Vec<Line>> {
    let from = layout.header.unwrap_or(layout.data);
    let table: Vec<&Line> = lines.iter().filter(|l| l.number >= from).collect();
    let width = commonest(table.iter().map(|l| l.cells.len()));
    if table.iter().all(|l| l.cells.len() == width) {
        return None;
    }
    let raw: Vec<&str> = text.lines().collect();
    let line = |l: &&Line| raw.get(l.number - 1).map(|t| t.chars().collect::<Vec<char>>());
    let chars: Vec<Vec<char>> = table.iter().filter_map(line).collect();
    let longest = chars.iter().map(Vec::len).max()?;
    let filled = |at: usize| chars.iter().any(|l| l.get(at).is_some_and(|c| !c.is_whitespace()));
    let mut spans: Vec<(usize, usize)> = Vec::new();
    for at in (0..longest).filter(|at| filled(*at)) {
        match spans.last_mut() {
            Some((_, end)) if *end == at => *end = at + 1,
            _ => spans.push((at, at + 1)),
        }
    }
    if spans.len() < width {
        return None;
    }
    let cell = |l: &[char], (begin, end): (usize, usize)| {
        let part: String = l.iter().take(end).skip(begin).collect();
        part.trim().to_owned()
    };
    let cut = table.iter().zip(&chars).map(|(line, l)| Line {
        number: line.number,
        cells: spans.iter().map(|span| cell(l, *span)).collect(),
    });
    let before = lines.iter().filter(|l| l.number < from).cloned();
    Some(before.chain(cut).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::sniff::Dialect;

    #[test]
    fn empty_cells_and_headings_of_two_words() {
        let text = "J 1     J 2    X mm  note\n 1.0     2.0    3.0\n 10.0           30.0  good\n";
        let dialect = Dialect { delimiter: ' ', decimal: '.' };
        let lines = dialect.cut(std::path::Path::new("t"), text).unwrap();
        let layout = Layout { header: Some(1), units: None, data: 2 };
        let cut = cut(text, &lines, layout).unwrap();
        let cells: Vec<Vec<String>> = cut.into_iter().map(|l| l.cells).collect();
        assert_eq!(cells[0], ["J 1", "J 2", "X mm", "note"]);
        assert_eq!(cells[1], ["1.0", "2.0", "3.0", ""]);
        assert_eq!(cells[2], ["10.0", "", "30.0", "good"]);
    }
}
