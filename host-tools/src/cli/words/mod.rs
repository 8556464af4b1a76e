//! What the verbs say on the terminal: one file a verb.

mod check;
mod compare;
mod compensate;
mod diagnose;
mod evaluate;
mod fleet;
mod gram;
mod identify;
mod import;
mod plan;
mod verify;

pub use check::checked;
pub use compare::compare;
pub use compensate::{compensation, not_reached};
pub use diagnose::diagnosis;
pub use evaluate::validation;
pub use fleet::fleet;
pub use gram::gram;
pub use identify::identification;
pub use import::import;
pub use plan::{planned, separated};
pub use verify::verification;

use truearm_host::identify::Condition;
use truearm_host::statistics::Stats;
use truearm_host::table::Table;

/// Errors of points, a line a model.
struct Errors(Option<Table>);

impl Errors {
    fn new() -> Self {
        Self(None)
    }

    /// With its head from the first line on.
    fn table(&mut self) -> &mut Table {
        let head = ["position error, mm", "mean", "RMS", "max", "SD"];
        self.0.get_or_insert_with(|| Table::new(head))
    }

    /// Its text; none where no row says how far off something is.
    fn text(&self) -> String {
        self.0.as_ref().map_or(String::new(), Table::to_string)
    }

    /// A line, if there is what it is about.
    fn row(&mut self, name: &str, stats: Option<&Stats>) {
        if let Some(s) = stats {
            self.table().numbers(name, [s.mean_mm, s.rms_mm, s.max_mm, s.sd_mm]);
        }
    }

    /// A line of which only the root mean square is known.
    fn rms(&mut self, name: &str, rms_mm: Option<f64>) {
        if let Some(rms) = rms_mm {
            self.table().row([name.to_owned(), String::new(), format!("{rms:.4}")]);
        }
    }
}

/// A condition number in words.
fn condition(condition: &Condition) -> String {
    match condition {
        Condition::Number(c) => format!("{c:.3e}"),
        Condition::Beyond(text) => (*text).to_owned(),
    }
}

/// Numbers of rows, joints and the like.
fn list<T: ToString>(numbers: &[T]) -> String {
    numbers.iter().map(T::to_string).collect::<Vec<_>>().join(", ")
}

/// Lines of a list, a few of a long one: the rest is in the report.
fn folded(lines: &[String]) -> String {
    const FEW: usize = 5;
    // One line more is no longer than the remark that it is missing.
    let shown = if lines.len() <= FEW + 1 { lines.len() } else { FEW };
    let mut out: String = lines[..shown].iter().map(|line| format!("  {line}\n")).collect();
    if shown < lines.len() {
        out += &format!("  and {} more, all of them in report.json\n", lines.len() - shown);
    }
    out
}

/// A thing and its number, or things and theirs.
pub fn numbered(thing: &str, numbers: &[usize]) -> String {
    format!("{thing}{} {}", if numbers.len() == 1 { "" } else { "s" }, list(numbers))
}

/// A remark about extrapolation, if there is any.
pub fn not_covered(joints: &[usize]) -> Option<String> {
    (!joints.is_empty()).then(|| {
        format!(
            "joint ranges not covered by the identification: {}; there the model extrapolates",
            numbered("joint", joints)
        )
    })
}
