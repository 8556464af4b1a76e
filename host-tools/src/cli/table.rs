//! The short tables on the terminal.

use truearm_host::report::{Condition, Report, Stats, Validation};

fn row(out: &mut String, name: &str, stats: &Option<Stats>) {
    if let Some(s) = stats {
        *out += &format!(
            "{name:32} {:>8.4} {:>8.4} {:>8.4} {:>8.4}\n",
            s.mean_mm, s.rms_mm, s.max_mm, s.sd_mm
        );
    }
}

fn head(out: &mut String) {
    *out += &format!(
        "{:32} {:>8} {:>8} {:>8} {:>8}\n",
        "position error, mm", "mean", "RMS", "max", "SD"
    );
}

/// A report of `identify`.
pub fn report(r: &Report) -> String {
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let mut out = format!(
        "{}\n{}: {} of {}, {}, {}\n",
        r.robot,
        r.data,
        count(r.rows, "row"),
        count(r.poses, "pose"),
        count(r.stations.len(), "station"),
        count(r.markers.len(), "marker"),
    );
    let raw = match r.condition_number_raw {
        Condition::Number(c) => format!("{c:.3e}"),
        Condition::Beyond(text) => text.to_owned(),
    };
    out += &format!(
        "{} parameters, rank {}, condition number {:.3e} (Eq. 24 with redundancy: {raw})\n",
        r.parameters, r.rank, r.condition_number
    );
    out += &format!("lambda {:.3e} by {} ({} scaling)", r.lambda, r.lambda_rule, r.lambda_scaling);
    if let Some(choice) = &r.lambda_choice {
        let corner = choice.l_curve.map_or("none".to_owned(), |c| format!("{c:.3e}"));
        out += &format!("; L-curve corner {corner}, two-step {:.3e}", choice.two_step);
    }
    out += &format!(
        "\ncorrections {:.2} tolerances in norm; residuals {:.1} times the stated sigma\n\n",
        r.correction_norm, r.residual_over_sigma
    );
    head(&mut out);
    row(&mut out, "nominal, base and tool fitted", &r.nominal);
    row(&mut out, "identified", &r.identified);
    row(&mut out, "cross-validated", &r.cross_validated);
    row(&mut out, "cross-validated, blocks in time", &r.cross_validated_blocked);
    if !r.outliers.is_empty() {
        row(&mut out, "cross-validated, all rows", &r.all_rows.cross_validated);
    }
    if let Some(v) = &r.validation {
        row(&mut out, "validation", &Some(v.stats));
    }
    out += &format!("cross-validation: {}\n", r.cross_validation);
    if r.rows_not_cross_validated > 0 {
        out += &format!(
            "{} not cross-validated: too few others at their station or marker\n",
            count(r.rows_not_cross_validated, "row")
        );
    }
    if r.outliers.is_empty() {
        out += "no row flagged\n";
    } else {
        out +=
            &format!("{} flagged as gross errors and left out:\n", count(r.outliers.len(), "row"));
        for o in &r.outliers {
            let [x, y, z] = o.residual_mm;
            out += &format!(
                "  row {}: {} wrong (measured minus predicted {x:.3}, {y:.3}, {z:.3} mm)\n",
                o.row,
                o.coordinates.join(", ")
            );
        }
    }
    if !r.unidentifiable.is_empty() {
        out += &format!(
            "{} that the data cannot determine:\n",
            count(r.unidentifiable.len(), "combination")
        );
        for line in &r.unidentifiable {
            out += &format!("  {line}\n");
        }
    }
    if !r.weakly_determined.is_empty() {
        out += "known worse than their tolerance, so left near nominal:\n";
        for line in &r.weakly_determined {
            out += &format!("  {line}\n");
        }
    }
    if r.residual_over_sigma > 3.0 {
        out += "the residuals are well above the stated noise: this model lacks something\n";
    }
    if let Some(v) = &r.validation {
        out += &format!("\n{}", validation(v));
    }
    out
}

/// A scored file.
pub fn validation(v: &Validation) -> String {
    let mut out = format!("{}: {} rows\n", v.file, v.rows);
    head(&mut out);
    out +=
        &format!("{:32} {:>8} {:>8.4}\n", "nominal, registered on this file", "", v.nominal_rms_mm);
    row(&mut out, "identified", &Some(v.stats));
    if !v.left_out.is_empty() {
        row(&mut out, "identified, all rows", &Some(v.all_rows));
        let rows: Vec<String> = v.left_out.iter().map(usize::to_string).collect();
        out +=
            &format!("rows {} left out: beyond 10 robust standard deviations\n", rows.join(", "));
    }
    if v.reregistered != "none" {
        out += &format!("{} fitted on this file itself, as asked\n", v.reregistered);
    }
    if let Some(base) = v.base_refitted_rms_mm.filter(|b| *b < 0.5 * v.stats.rms_mm) {
        out += &format!(
            "most of this error is the frame: with a base fitted on this file it is {base:.4} mm \
             (has the tracker moved? --reregister base)\n"
        );
    }
    if let Some(line) = not_covered(&v.joints_not_covered) {
        out += &format!("{line}\n");
    }
    out
}

/// A remark about extrapolation, if there is any.
pub fn not_covered(joints: &[usize]) -> Option<String> {
    let list: Vec<String> = joints.iter().map(usize::to_string).collect();
    (!joints.is_empty()).then(|| {
        format!(
            "joint ranges not covered by the identification: joints {}; there the model extrapolates",
            list.join(", ")
        )
    })
}
