use super::super::charts;
use super::super::document::{Figure, Section};
use super::{details, list, table};
use crate::identify::Figures;
use crate::identify::certainty::error_bars::ParameterBar;

/// Share of an interval that the noise of the rows accounts for, the tolerance for the rest.
const TOLD: f64 = 0.1;

/// What was corrected, with error bars.
pub fn corrections(f: &Figures) -> Section {
    let u = &f.uncertainty;
    let bars = &u.tool_point;
    let mut section = Section::new("corrections", "What was corrected").say(format!(
        "What the errors of the parameters leave of the tool's place: +-{:.4} mm a coordinate (95 %, \
         root mean square over the poses), +-{:.4} mm at worst; of the noise alone +-{:.4} and \
         +-{:.4} mm. How far off the arm is in all the error of poses held out says.",
        bars.rms_mm, bars.max_mm, bars.noise_rms_mm, bars.noise_max_mm
    ));
    let untold = match u.parameters.iter().filter(|p| !is_told(p)).count() {
        0 => String::new(),
        n => format!(
            " {n} more are not drawn: the rows tell nothing of them alone, and their intervals are \
             those of manufacturing."
        ),
    };
    let caption = format!(
        "Corrections to the drawing with 95 % intervals. An interval that holds zero says that the \
         drawing may be right there.{untold}"
    );
    let panels = charts::corrections(&u.parameters, is_told);
    section = section.figure(Figure::new("corrections", caption, panels));
    let row = |p: &ParameterBar| {
        let noise = if is_told(p) { number(p.noise_half_width) } else { "-".to_owned() };
        let mut cells = vec![p.name.clone(), number(p.correction), number(p.half_width), noise];
        cells.push(p.unit.to_owned());
        cells
    };
    let head = ["parameter", "correction", "+- 95 %", "from noise alone", "unit"];
    let all = table(&head, u.parameters.iter().map(row));
    let summary = format!("all {} corrections", u.parameters.len());
    section = section.node(details(&summary, all));
    if u.correlations.is_empty() { section } else { section.node(list(u.correlations.clone())) }
}

/// Whether the rows tell a parameter rather than its tolerance does.
fn is_told(p: &ParameterBar) -> bool {
    p.noise_half_width > TOLD * p.half_width
}

/// Four decimals without a minus zero.
fn number(x: f64) -> String {
    format!("{:.4}", (x * 1e4).round() / 1e4 + 0.0)
}
