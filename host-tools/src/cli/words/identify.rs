use truearm_host::error::count;
use truearm_host::identify::certainty::error_bars::Uncertainty;
use truearm_host::identify::{Figures, KindFigures};
use truearm_host::report::IdentifyReport;
use truearm_host::table::Table;

use super::{Errors, condition, folded, validation};

/// A report of `identify`.
pub fn identification(report: &IdentifyReport) -> String {
    let r = &report.figures;
    let mut out = head(r) + &drawn(r) + &lambda(r) + "\n" + &errors(report);
    out += &format!("cross-validation: {}\n", r.cross_validation);
    if r.rows_not_cross_validated > 0 {
        out += &format!(
            "{} not cross-validated: too few others at their station or marker\n",
            count(r.rows_not_cross_validated, "row")
        );
    }
    out += &kinds(&r.kinds);
    out += &flagged(r);
    out += &error_bars(&r.uncertainty);
    out += &undetermined(r);
    if r.residual_over_sigma > 3.0 {
        out += "the residuals are well above the stated noise: this model lacks something\n";
    }
    if let Some(v) = &report.validation {
        out += &format!("\n{}", validation(v));
    }
    out
}

fn head(r: &Figures) -> String {
    format!(
        "{}\n{}: {} of {}, {}, {}\n\
         {} parameters, rank {}, condition number {:.3e} (Eq. 24 with redundancy: {})\n",
        r.robot,
        r.data,
        count(r.rows, "row"),
        count(r.poses, "pose"),
        count(r.stations.len(), "station"),
        count(r.markers.len(), "marker"),
        r.parameters,
        r.rank,
        r.condition_number,
        condition(&r.condition_number_raw)
    )
}

/// What all rows say where the table is of some.
fn drawn(r: &Figures) -> String {
    let Some(drawn) = &r.drawn else { return String::new() };
    let mut out = format!("read in pieces, {}: parameters are of all rows", times(drawn.rounds));
    if drawn.twice > 0 {
        out += &format!(", {} of which stand there before and count once", drawn.twice);
    }
    out += &format!(
        "; {} gross errors, which do not count\nRMS of the distances of all others, weighed by \
         1/sigma^2, {:.4} mm",
        drawn.flagged, drawn.rms_mm
    );
    if let Some(rms) = drawn.cross_validated_rms_mm {
        out += &format!(", of poses held out {rms:.4} mm");
    }
    out + &match r.rows - drawn.twice == drawn.rows {
        true => "\n".to_owned(),
        false => format!(
            "\nthe table, single rows and pictures are of {} drawn by chance\n",
            count(drawn.rows, "row")
        ),
    }
}

fn times(rounds: u32) -> String {
    count(rounds as usize, "time")
}

fn lambda(r: &Figures) -> String {
    let mut out =
        format!("lambda {:.3e} by {} ({} scaling)", r.lambda, r.lambda_rule, r.lambda_scaling);
    if let Some(choice) = &r.lambda_choice {
        let or_none = |l: Option<f64>| l.map_or("none".to_owned(), |l| format!("{l:.3e}"));
        out += &format!(
            "; L-curve corner {}, two-step {:.3e}\n\
             other rules: GCV {}, discrepancy {}, k-fold {:.3e}, marginal likelihood {}",
            or_none(choice.l_curve),
            choice.two_step,
            or_none(choice.gcv),
            or_none(choice.discrepancy),
            choice.k_fold,
            or_none(choice.maximum_likelihood)
        );
    }
    out + &format!(
        "\ncorrections {:.2} tolerances in norm; residuals {:.1} times the stated sigma\n",
        r.correction_norm, r.residual_over_sigma
    )
}

fn errors(report: &IdentifyReport) -> String {
    let r = &report.figures;
    let mut table = Errors::new();
    table.row("nominal, base and tool fitted", r.nominal.as_ref());
    table.row("identified", r.identified.as_ref());
    table.row("cross-validated", r.cross_validated.as_ref());
    table.row("cross-validated, blocks in time", r.cross_validated_blocked.as_ref());
    if !r.outliers.is_empty() {
        let all = match r.drawn {
            Some(_) => "cross-validated, flagged ones too",
            None => "cross-validated, all rows",
        };
        table.row(all, r.all_rows.cross_validated.as_ref());
    }
    table.row("validation", report.validation.as_ref().and_then(|v| v.stats.as_ref()));
    table.text()
}

/// Each kind in its own unit, where there is more than points.
fn kinds(kinds: &[KindFigures]) -> String {
    if kinds.iter().all(|k| k.kind == "point") {
        return String::new();
    }
    let mut table = Table::new([
        "RMS of each kind",
        "rows",
        "unit",
        "nominal",
        "identified",
        "cross-validated",
        "noise / stated",
    ]);
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.4}"));
    for k in kinds {
        let all = [k.nominal_rms, k.identified_rms, k.cross_validated_rms].map(number);
        let first = [k.kind.to_owned(), k.rows.to_string(), k.unit.to_owned()];
        let scale = format!("{:.2}", k.noise_scale);
        table.row(first.into_iter().chain(all).chain([scale]));
    }
    table.to_string()
}

fn flagged(r: &Figures) -> String {
    if r.outliers.is_empty() {
        return "no row flagged\n".to_owned();
    }
    let rows = count(r.outliers.len(), "row");
    let drawn = if r.drawn.is_some() { " of those drawn" } else { "" };
    let mut out = format!("{rows}{drawn} flagged as gross errors and left out:\n");
    // `data` names all files.
    let several = r.outliers.iter().any(|o| o.file != r.data);
    for o in &r.outliers {
        let place = match (several, &r.drawn) {
            (true, None) => format!("row {} ({}, line {})", o.row, o.file, o.line),
            (false, None) => format!("row {}", o.row),
            (true, Some(_)) => format!("line {} of {}", o.line, o.file),
            (false, Some(_)) => format!("line {}", o.line),
        };
        let residual: Vec<String> = o.residual_mm.iter().map(|r| format!("{r:.3}")).collect();
        out += &format!(
            "  {place}: {} wrong (measured minus predicted {} mm)\n",
            o.coordinates.join(", "),
            residual.join(", ")
        );
    }
    out
}

/// Corrections with their intervals, five parameters a joint, and the tool point.
fn error_bars(u: &Uncertainty) -> String {
    let bars = &u.tool_point;
    let mut out = format!(
        "predicted tool point, 95 %: +-{:.4} mm a coordinate (RMS over the poses), +-{:.4} mm at \
         worst; from noise alone +-{:.4}, +-{:.4}\n",
        bars.rms_mm, bars.max_mm, bars.noise_rms_mm, bars.noise_max_mm
    );
    let head = ["corrections, 95 %", "alpha, deg", "a, mm", "theta, deg", "d, mm", "beta, deg"];
    let mut table = Table::new(head);
    for (i, joint) in u.parameters.chunks(5).enumerate() {
        // What is nothing has no sign.
        let shown = |value: f64| if value.abs() < 5e-5 { 0.0 } else { value };
        let cells =
            joint.iter().map(|p| format!("{:+.4} +-{:<6.4}", shown(p.correction), p.half_width));
        table.row(std::iter::once(format!("  joint {}", i + 1)).chain(cells));
    }
    out += &table.to_string();
    u.correlations.iter().for_each(|line| out += &format!("  {line}\n"));
    out
}

fn undetermined(r: &Figures) -> String {
    let mut out = String::new();
    r.left_open.iter().for_each(|line| out += &format!("{line}\n"));
    if r.orientation_identified {
        out += "how the last frame is turned is identified\n";
    }
    if !r.unidentifiable.is_empty() {
        let combinations = count(r.unidentifiable.len(), "combination");
        out += &format!("{combinations} that the data cannot determine:\n");
        out += &folded(&r.unidentifiable);
    }
    if !r.weakly_determined.is_empty() {
        out += "known worse than their tolerance, so left near nominal:\n";
        out += &folded(&r.weakly_determined);
    }
    out
}
