use super::super::charts;
use super::super::document::{Figure, Section};
use super::{details, list, table};
use crate::identify::Figures;
use crate::identify::certainty::error_bars::ParameterBar;

/// What was corrected, with error bars.
pub fn corrections(f: &Figures) -> Section {
    let u = &f.uncertainty;
    let bars = &u.tool_point;
    let mut section = Section::new("corrections", "What was corrected").say(format!(
        "The corrected arm predicts where the tool is to +-{:.4} mm a coordinate (95 %, root mean \
         square over the poses), +-{:.4} mm at worst; from the noise alone +-{:.4} and +-{:.4} mm.",
        bars.rms_mm, bars.max_mm, bars.noise_rms_mm, bars.noise_max_mm
    ));
    let caption = "Corrections to the drawing with 95 % intervals. An interval that holds zero says \
                   that the drawing may be right there.";
    let panels = charts::corrections(&u.parameters);
    section = section.figure(Figure::new("corrections", caption, panels));
    let row = |p: &ParameterBar| {
        let numbers = [p.correction, p.half_width, p.noise_half_width];
        let mut cells = vec![p.name.clone()];
        cells.extend(numbers.map(|x| format!("{x:+.4}").trim_start_matches('+').to_owned()));
        cells.push(p.unit.to_owned());
        cells
    };
    let head = ["parameter", "correction", "+- 95 %", "from noise alone", "unit"];
    let all = table(&head, u.parameters.iter().map(row));
    let summary = format!("all {} corrections", u.parameters.len());
    section = section.node(details(&summary, all));
    if u.correlations.is_empty() { section } else { section.node(list(u.correlations.clone())) }
}
