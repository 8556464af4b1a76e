//! Tables and numbers of the report, in Markdown.

use std::fmt::Write;

use super::study::spread;

/// A Markdown table.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut out = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    for row in rows {
        let _ = writeln!(out, "| {} |", row.join(" | "));
    }
    out.push('\n');
    out
}

/// Three decimals, powers of ten where they do not serve.
pub fn number(x: f64) -> String {
    match x.abs() {
        _ if !x.is_finite() => "-".to_owned(),
        a if a == 0.0 || (1e-3..1e4).contains(&a) => format!("{x:.3}"),
        _ => format!("{x:.1e}"),
    }
}

/// Median, and tenth to ninetieth percentile.
pub fn middle(values: &[f64]) -> String {
    let [median, low, high, _] = spread(values);
    if median.is_nan() {
        return "-".to_owned();
    }
    format!("{} ({} - {})", number(median), number(low), number(high))
}
