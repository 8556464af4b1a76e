use truearm_host::evaluate::Validation;

use super::{Errors, not_covered, numbered};

/// No arm, and no effect, is as far off, mm.
const SENSELESS_MM: f64 = 20.0;

/// A scored file.
pub fn validation(v: &Validation) -> String {
    let mut out = format!("{}: {} rows\n", v.file, v.rows);
    let mut table = Errors::new();
    table.rms("nominal, registered on this file", v.nominal_rms_mm);
    table.row("identified", v.stats.as_ref());
    if !v.left_out.is_empty() {
        table.row("identified, all rows", v.all_rows.as_ref());
    }
    out += &table.text();
    let alone = v.kinds.len() == 1;
    for k in v.kinds.iter().filter(|k| !alone || k.kind != "point") {
        let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4} {}", k.unit));
        let (before, after) = (number(k.nominal_rms), number(k.rms));
        out += &format!("{}: RMS {before} nominal, {after} identified\n", k.kind);
    }
    if !v.left_out.is_empty() {
        let rows = numbered("row", &v.left_out);
        out += &format!("{rows} left out: beyond 10 robust standard deviations\n");
    }
    if !v.standing_out.is_empty() {
        out += &format!(
            "off by more than 10 robust standard deviations as well, and counted: {}; look for wrong \
             ones among them\n",
            numbered("row", &v.standing_out)
        );
    }
    if v.reregistered != "none" {
        out += &format!("{} fitted on this file itself, as asked\n", v.reregistered);
    }
    if v.stats.is_some_and(|s| s.rms_mm > SENSELESS_MM) {
        out += "no arm is off by as much: `truearm check robot.toml` with this file finds units, orders \
                and senses that are wrong\n";
    }
    if let Some(base) =
        v.base_refitted_rms_mm.filter(|b| v.stats.is_some_and(|s| *b < 0.5 * s.rms_mm))
    {
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
