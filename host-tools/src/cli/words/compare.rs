use truearm_host::methods::{Comparison, Outcome};
use truearm_host::table::Table;

use super::{condition, list};

/// From this error on, mm, powers of ten are read best.
const POWERS: f64 = 1e4;

/// The methods side by side.
pub fn compare(c: &Comparison) -> String {
    let mut out = format!(
        "{}\n{}: {} rows fitted; classical methods: {} parameters, base and tool {}; rank of all {}, \
         condition number (Eq. 24) {}\n",
        c.robot,
        c.data,
        c.rows,
        c.parameters,
        c.frames,
        c.rank,
        condition(&c.condition_number_raw)
    );
    if !c.outlier_rows.is_empty() {
        let rows = list(&c.outlier_rows);
        out += &format!("left out for all as gross errors: rows {rows}\n");
    }
    out += &match &c.validation {
        Some(file) => format!("errors on {file}, registered anew: {}\n\n", c.reregistered),
        None => "errors on the fitted rows; --validate judges on others\n\n".to_owned(),
    };
    let mut table = Table::new([
        "method",
        "Max mm",
        "MAE mm",
        "SD mm",
        "MAE -%",
        "SD -%",
        "iter",
        "ms",
        "norm, tol",
        "lambda",
    ]);
    let solved = c.methods.iter().filter(|o| o.judged().is_some());
    solved.clone().for_each(|o| table.row(outcome(o)));
    out += &table.to_string();
    for o in &c.methods {
        if o.judged().is_none() {
            let why = o.failure.as_deref().unwrap_or("no result");
            out += &format!("{}: {why}\n", o.name);
        }
    }
    let restless: Vec<&str> = solved.filter(|o| !o.settled).map(|o| o.name).collect();
    if !restless.is_empty() {
        out += &format!("did not come to rest: {}\n", restless.join(", "));
    }
    if let Some((best, error)) = c.best().filter(|(best, _)| best.len() > 1) {
        let names: Vec<&str> = best.iter().map(|o| o.name).collect();
        out += &format!(
            "cannot be told apart, means within the standard error of one, {error:.4} mm: {}\n",
            names.join(", ")
        );
    }
    out + "norm: corrections of all links in manufacturing tolerances (1 mm, 1 mrad)\n"
}

fn outcome(o: &Outcome) -> Vec<String> {
    let Some(s) = o.judged() else { return Vec::new() };
    let percent = |p: Option<f64>| p.map_or("-".to_owned(), |p| format!("{p:.1}"));
    let mm = |x: f64| if x < POWERS { format!("{x:.4}") } else { format!("{x:.1e}") };
    vec![
        o.name.to_owned(),
        mm(s.max_mm),
        mm(s.mean_mm),
        mm(s.sd_mm),
        percent(o.mae_reduction_percent),
        percent(o.sd_reduction_percent),
        o.iterations.to_string(),
        format!("{:.2}", o.seconds * 1e3),
        o.correction_norm.map_or("-".to_owned(), |n| format!("{n:.3e}")),
        o.lambda.map_or("-".to_owned(), |l| format!("{l:.1e}")),
    ]
}
