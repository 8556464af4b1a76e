use super::super::charts::l_curve;
use super::super::document::{Figure, Section};
use super::super::numbers::digits;
use super::table;
use crate::identify::Figures;

/// How much the corrections were held back, and what other rules say.
pub fn lambda(f: &Figures) -> Section {
    let corner = f.lambda_choice.as_ref().and_then(|c| c.l_curve);
    let mut section = Section::new("lambda", "How far the data are believed").say(format!(
        "Corrections are held near the drawing by lambda = {}, chosen by {} ({} scaling). A \
         smaller lambda fits the rows more closely and asks for larger corrections.",
        digits(f.lambda),
        f.lambda_rule,
        f.lambda_scaling
    ));
    if let Some(panel) = l_curve(&f.l_curve, f.lambda_scaling, f.lambda_rule, corner) {
        let caption = "Residual against corrections for every lambda; from lower right (large \
                       lambda, hardly corrected) to upper left (small lambda). The chosen lambda is \
                       marked.";
        section = section.figure(Figure::new("l-curve", caption, vec![panel]));
    }
    let Some(c) = &f.lambda_choice else { return section };
    let row = |name: &str, lambda: Option<f64>| {
        vec![name.to_owned(), lambda.map_or("none".to_owned(), digits)]
    };
    let rows = [
        row("corner of the L-curve", c.l_curve),
        row("two-step", Some(c.two_step)),
        row("generalised cross-validation", c.gcv),
        row("discrepancy principle", c.discrepancy),
        row("least error of folds", Some(c.k_fold)),
        row("marginal likelihood", c.maximum_likelihood),
    ];
    section.node(table(&["rule", "lambda"], rows))
}
