//! The short tables on the terminal.

use truearm_host::diagnose::{Effect, Outcome, Verdict};
use truearm_host::evaluate::Validation;
use truearm_host::identify::Condition;
use truearm_host::identify::error_bars::Uncertainty;
use truearm_host::report::IdentifyReport;
use truearm_host::statistics::Stats;

pub fn row(out: &mut String, name: &str, stats: &Option<Stats>) {
    if let Some(s) = stats {
        *out += &format!(
            "{name:32} {:>8.4} {:>8.4} {:>8.4} {:>8.4}\n",
            s.mean_mm, s.rms_mm, s.max_mm, s.sd_mm
        );
    }
}

pub fn head(out: &mut String) {
    *out += &format!(
        "{:32} {:>8} {:>8} {:>8} {:>8}\n",
        "position error, mm", "mean", "RMS", "max", "SD"
    );
}

/// A condition number in words.
pub fn condition(condition: &Condition) -> String {
    match condition {
        Condition::Number(c) => format!("{c:.3e}"),
        Condition::Beyond(text) => (*text).to_owned(),
    }
}

/// A report of `identify`.
pub fn report(report: &IdentifyReport) -> String {
    let r = &report.figures;
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
    let raw = condition(&r.condition_number_raw);
    out += &format!(
        "{} parameters, rank {}, condition number {:.3e} (Eq. 24 with redundancy: {raw})\n",
        r.parameters, r.rank, r.condition_number
    );
    out += &format!("lambda {:.3e} by {} ({} scaling)", r.lambda, r.lambda_rule, r.lambda_scaling);
    if let Some(choice) = &r.lambda_choice {
        let or_none = |l: Option<f64>| l.map_or("none".to_owned(), |l| format!("{l:.3e}"));
        let corner = or_none(choice.l_curve);
        out += &format!("; L-curve corner {corner}, two-step {:.3e}", choice.two_step);
        out += &format!(
            "\nother rules: GCV {}, discrepancy {}, k-fold {:.3e}, marginal likelihood {}",
            or_none(choice.gcv),
            or_none(choice.discrepancy),
            choice.k_fold,
            or_none(choice.maximum_likelihood)
        );
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
    if let Some(v) = &report.validation {
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
            let residual: Vec<String> = o.residual_mm.iter().map(|r| format!("{r:.3}")).collect();
            out += &format!(
                "  row {}: {} wrong (measured minus predicted {} mm)\n",
                o.row,
                o.coordinates.join(", "),
                residual.join(", ")
            );
        }
    }
    out += &error_bars(&r.uncertainty);
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
    if let Some(v) = &report.validation {
        out += &format!("\n{}", validation(v));
    }
    out
}

/// Corrections with their intervals, five parameters a joint, and the tool point.
fn error_bars(u: &Uncertainty) -> String {
    let bars = &u.tool_point;
    let mut out = format!(
        "predicted tool point, 95 %: +-{:.4} mm a coordinate (RMS over the poses), +-{:.4} mm at \
         worst; from noise alone +-{:.4}, +-{:.4}\n\
         corrections, 95 %:{:>12}{:>20}{:>20}{:>20}{:>20}\n",
        bars.rms_mm,
        bars.max_mm,
        bars.noise_rms_mm,
        bars.noise_max_mm,
        "alpha, deg",
        "a, mm",
        "theta, deg",
        "d, mm",
        "beta, deg"
    );
    for (i, joint) in u.parameters.chunks(5).enumerate() {
        out += &format!("  joint {:<3}", i + 1);
        for p in joint {
            out += &format!("{:>+11.4} +-{:<6.4}", p.correction, p.half_width);
        }
        out += "\n";
    }
    for line in &u.correlations {
        out += &format!("  {line}\n");
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

/// The summary of `diagnose`.
pub fn diagnosis(r: &Outcome) -> String {
    let b = &r.figures;
    let mut out = format!("{}\n{}: {} rows of {} poses\n", b.robot, b.data, b.rows, b.poses);
    out += match r.verdict {
        Verdict::Clean => "verdict: clean, geometry alone reaches the noise floor\n",
        Verdict::Explained => "verdict: explained\n",
        Verdict::Unexplained if r.effects.is_empty() => {
            "verdict: unexplained, structure is left that no listed effect explains\n"
        }
        Verdict::Unexplained => {
            "verdict: unexplained, the effects below carry most of it but not all\n"
        }
    };
    let mut told: Vec<&str> = Vec::new();
    for e in &r.effects {
        let same: Vec<&Effect> = r.effects.iter().filter(|o| o.name == e.name).collect();
        if same.len() <= 3 {
            out += &format!("  {}\n", effect(e));
        } else if !told.contains(&e.name) {
            told.push(e.name);
            out += &spectrum(&same);
        }
    }
    out += "\nRMS error, mm                    fitted  cross-val   hold-out\n";
    for row in &r.gap {
        let cell = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4}"));
        out += &format!(
            "{:30} {:>8.4} {:>10} {:>10}\n",
            row.model,
            row.train_rms_mm,
            cell(row.cross_validated_rms_mm),
            cell(row.holdout_rms_mm)
        );
    }
    out += &format!("{:30} {:>8.4}\n", "noise floor", r.noise_floor_mm);
    out += &format!("held out: {}\n", b.cross_validation);
    if !b.outliers.is_empty() {
        let rows: Vec<String> = b.outlier_rows.iter().map(usize::to_string).collect();
        let what = match r.effects.iter().any(|e| e.name == "outliers") {
            true => "flagged as gross errors and left out",
            false => "that do not fit, left out",
        };
        out += &format!("rows {what}: {}\n", rows.join(", "));
    }
    if !r.whereabouts.is_empty() {
        out += "where geometry alone disagrees:\n";
        for line in r.whereabouts.iter().take(6) {
            out += &format!("  {line}\n");
        }
    }
    for a in &r.alternatives {
        let names: Vec<String> =
            a.effects.iter().map(|(name, joints)| place(name, joints)).collect();
        out += &format!(
            "alternative within reach (worse by {:.1} in chi-square): {}\n  measure these poses to tell them apart:\n",
            a.worse_by,
            names.join(" and ")
        );
        for pose in &a.separating_poses {
            let joints: Vec<String> = pose.joints.iter().map(|q| format!("{q:.2}")).collect();
            out += &format!("    {}  ({:.3} mm apart)\n", joints.join(", "), pose.difference_mm);
        }
    }
    for line in &r.not_testable {
        out += &format!("not testable: {line}\n");
    }
    out
}

fn place(name: &str, joints: &[usize]) -> String {
    let list: Vec<String> = joints.iter().map(usize::to_string).collect();
    match (name, joints.len()) {
        (_, 0) => name.to_owned(),
        ("joint-coupling", _) => format!("{name} from joint {} to {}", list[0], list[1]),
        (_, 1) => format!("{name} of joint {}", list[0]),
        _ => format!("{name} of joints {}", list.join(", ")),
    }
}

fn effect(e: &Effect) -> String {
    let mut out = place(e.name, &e.joints);
    if let Some(order) = e.order {
        out += &format!(", {order} cycles a turn");
    }
    let values: Vec<String> = e
        .coefficients
        .iter()
        .map(|c| {
            let part = if c.part.is_empty() { String::new() } else { format!("{} ", c.part) };
            format!("{part}{:.3e} +- {:.0e} {}", c.value, c.sigma, c.unit)
        })
        .collect();
    if !values.is_empty() {
        out += &format!(": {}", values.join(", "));
    }
    if e.holdout_gain != 0.0 {
        out += &format!("; held-out error falls by {:.0} %", e.holdout_gain * 100.0);
    }
    out
}

/// Many orders of one periodic effect: a line a joint, amplitudes in mrad.
fn spectrum(effects: &[&Effect]) -> String {
    let mut joints: Vec<usize> = effects.iter().flat_map(|e| e.joints.clone()).collect();
    joints.sort_unstable();
    joints.dedup();
    let gain = effects.first().map_or(0.0, |e| e.holdout_gain);
    let name = effects.first().map_or("", |e| e.name);
    let mut out = format!("  {name}; held-out error falls by {:.0} %\n", gain * 100.0);
    for joint in joints {
        let mut lines: Vec<(f64, f64)> = Vec::new();
        for e in effects {
            let mine = e.coefficients.iter().filter(|c| c.joint == Some(joint));
            let square: f64 = mine.map(|c| c.value * c.value).sum();
            if square > 0.0 {
                lines.push((square.sqrt() * 1e3, e.order.unwrap_or(0.0)));
            }
        }
        lines.sort_by(|a, b| b.0.total_cmp(&a.0));
        let list: Vec<String> =
            lines.iter().map(|(mrad, order)| format!("{order:.1} ({mrad:.2})")).collect();
        out += &format!("    joint {joint}, cycles a turn (mrad): {}\n", list.join(", "));
    }
    out
}
