use truearm_host::error::count;
use truearm_host::report::GramReport;

/// What a step found, and what to do next.
pub fn gram(report: &GramReport) -> String {
    let (files, rows) = (count(report.files as usize, "file"), count(report.rows as usize, "row"));
    let mut out = format!("round {}: {files}, {rows}", report.stage);
    if report.flagged > 0 {
        out += &format!(", {} of which do not count", report.flagged);
    }
    out += &format!("\nresiduals are {:.2} times the stated sigma\n", report.noise_scale);
    if let Some(rms) = report.rms_mm {
        out += &format!("RMS of the distances {rms:.4} mm");
        if let Some(held_out) = report.cross_validated_rms_mm {
            out += &format!(", of poses held out {held_out:.4} mm");
        }
        let step = report.largest_step_tolerances;
        out += &format!("\nlambda {:.2e}, largest step {step:.1e} tolerances\n", report.lambda);
    }
    out += match report.settled {
        true => "settled: this is the identified arm\n",
        false => "not settled: add all parts at the new state\n",
    };
    out
}
