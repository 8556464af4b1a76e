use super::list;
use crate::diagnose::Described;
use crate::page::charts::{described, free_curve};
use crate::page::document::{Figure, Section};
use crate::page::numbers::mm;
use crate::page::picture::Unexplained;

/// What is left that goes with something recorded, and what was said of it.
pub fn unexplained(
    curves: &[Unexplained],
    (words, described): (&[String], &[Described]),
    of: &str,
) -> Option<Section> {
    if curves.is_empty() && words.is_empty() {
        return None;
    }
    let section = Section::new("left", "What has no name").say(match curves {
        [] => format!(
            "What {of} leaves is not the same everywhere, and no error of one joint's angle \
             describes it; what it goes with:"
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
    let told = described.iter().filter(|d| !d.curves.is_empty()).enumerate().map(told);
    Some(section.figures(told).figures(curves.iter().enumerate().map(figure)))
}

/// What errs, as the thing goes that it errs with.
fn told((k, what): (usize, &Described)) -> Figure {
    let of = |name: &str, joint: Option<usize>| match joint {
        Some(joint) if name == "joint" => format!("joint {joint}"),
        _ => name.to_owned(),
    };
    let (part, with) = (of(what.part, what.joint), of(what.with, what.with_joint));
    let [one, other] = what.half_gain.map(|gain| 100.0 * gain);
    let caption = format!(
        "{}. Fitted to one half of the poses it lowers the error of the other by {one:.0} and \
         {other:.0} %. It is in no model: what it is, and whether a controller may know of it, is \
         for you to say.",
        what.words
    );
    let panels = what.curves.iter().map(|course| described(course, (&part, &with)));
    Figure::new(format!("described-{}", k + 1), caption, panels.collect())
}
