use super::list;
use crate::page::charts::free_curve;
use crate::page::document::{Figure, Section};
use crate::page::numbers::mm;
use crate::page::picture::Unexplained;

/// What is left that goes with something recorded, and what was said of it.
pub fn unexplained(curves: &[Unexplained], words: &[String], of: &str) -> Option<Section> {
    if curves.is_empty() && words.is_empty() {
        return None;
    }
    let section = Section::new("left", "What has no name").say(match curves {
        [] => format!(
            "What {of} leaves is not the same everywhere, but against nothing that was recorded \
             does it draw a curve of one joint."
        ),
        _ => format!(
            "What {of} leaves is not the same everywhere: below are the curves of joints that \
             explain most of it, without asking for a name, each of what those before it leave."
        ),
    });
    let section =
        if words.is_empty() { section } else { section.node(list(words.iter().cloned())) };
    let figure = |(k, left): (usize, &Unexplained)| {
        let caption = format!(
            "It explains {} RMS of the {} that are left of {} rows. {} bins, mean of each with its 95 % interval; {:.0} standard \
             deviations above what chance leaves.",
            mm(left.explains_mm),
            mm(left.of_mm),
            left.rows,
            left.means.len(),
            left.deviations
        );
        Figure::new(format!("left-{}", k + 1), caption, vec![free_curve(left)])
    };
    Some(section.figures(curves.iter().enumerate().map(figure)))
}
