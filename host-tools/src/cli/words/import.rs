use truearm_host::error::{count, listed};
use truearm_host::report::ImportReport;

/// What was read, what the columns were taken for, what was written.
pub fn import(report: &ImportReport) -> String {
    let made = &report.made;
    let mut text = String::new();
    for file in &made.files {
        let why = file.because.join("; ");
        text += &format!("{}: {}; {why}\n", file.written.file, count(file.rows, "row"));
    }
    if let Some(join) = &made.join {
        text += &format!("joined {join}\n");
    }
    let several = made.files.len() > 1;
    for c in &made.columns {
        let file = if several { format!("file {}, ", c.file) } else { String::new() };
        let name = if c.name.is_empty() { String::new() } else { format!(" \"{}\"", c.name) };
        let unit = c.unit.as_ref().map_or(String::new(), |unit| format!(", {unit}"));
        text +=
            &format!("{}: {file}column {}{name}{unit}, because {}\n", c.to, c.column, c.because);
    }
    if !made.left_out.is_empty() {
        text += &format!("left out: {}\n", listed(&made.left_out));
    }
    let repeats = made.rows - made.poses;
    text += &format!("{} of {}", count(made.rows, "row"), count(made.poses, "pose"));
    if repeats > 0 {
        text += &format!(", {} repeated", count(repeats, "row"));
    }
    text + &format!("\nwrote {}; {} says how it was read\n", report.out, report.config)
}
