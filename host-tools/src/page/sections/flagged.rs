use super::super::document::Section;
use super::super::numbers::file_name;
use super::{folded, table};
use crate::identify::{Figures, FlaggedRow};

/// Rows that were left out, and why.
pub fn flagged(f: &Figures) -> Section {
    let section = Section::new("flagged", "Rows left out");
    if f.outliers.is_empty() {
        return section.say(match &f.drawn {
            Some(drawn) if drawn.flagged > 0 => format!(
                "{} of {} rows do not fit the others, none of the {} that were drawn.",
                drawn.flagged, f.rows, drawn.rows
            ),
            _ => "None: no row contradicts the others.".to_owned(),
        });
    }
    let of = match &f.drawn {
        Some(drawn) => format!(
            "{} of {} rows do not fit the others; these are of the {} that were drawn, and numbered \
             among them.",
            drawn.flagged, f.rows, drawn.rows
        ),
        None => format!("{} of {} rows do not fit the others.", f.outliers.len(), f.rows),
    };
    let row = |o: &FlaggedRow| {
        let numbers: Vec<String> = o.residual_mm.iter().map(|r| format!("{r:.3}")).collect();
        vec![
            o.row.to_string(),
            file_name(&o.file),
            o.line.to_string(),
            o.coordinates.join(", "),
            numbers.join(", "),
        ]
    };
    let head = ["row", "file", "line", "wrong", "measured minus predicted by the other rows, mm"];
    section.say(of).node(table(&head, f.outliers.iter().map(row)))
}

/// Remarks about the files.
pub fn remarks(warnings: &[String]) -> Option<Section> {
    (!warnings.is_empty())
        .then(|| Section::new("remarks", "Remarks").node(folded(warnings, "remarks")))
}
