//! What moved, as lines of words and as changes of a report.

use nalgebra::Vector3;

use super::motion::Motion;
use super::{Change, Difference, Told};

/// Lines `name before -> after by`, only of what moved.
#[derive(Default)]
pub(super) struct Moved {
    pub text: String,
    pub changes: Vec<Change>,
    /// Moved, but less than the last decimal printed.
    pub little: usize,
}

/// Half of the last decimal printed.
pub(super) const VISIBLE: f64 = 0.5e-6;

impl Moved {
    pub fn difference(self, same: bool, motions: Vec<Motion>) -> Difference {
        let Self { text: words, changes, little } = self;
        Difference { same, changes, little, motions, words }
    }

    pub fn change(&mut self, what: &str, unit: &'static str, [before, after]: [Option<Told>; 2]) {
        self.changes.push(Change { what: what.to_owned(), unit, before, after });
    }

    /// Words that are another before and after, for the report alone.
    pub fn told(&mut self, what: &str, texts: [String; 2]) {
        self.change(what, "", texts.map(|text| Some(Told::Text(text))));
    }

    pub fn number(&mut self, name: &str, unit: &'static str, factor: f64, [a, b]: [f64; 2]) {
        let (a, b) = (a * factor, b * factor);
        if a != b && (b - a).abs() < VISIBLE {
            self.little += 1;
        } else if a != b {
            self.text += &format!("{name:30} {a:>13.6} -> {b:>13.6}  {:>+12.6} {unit}\n", b - a);
            self.change(name, unit, [a, b].map(|x| Some(Told::Number(x))));
        }
    }

    pub fn vector(
        &mut self,
        name: &str,
        unit: &'static str,
        factor: f64,
        [a, b]: [&Vector3<f64>; 2],
    ) {
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            self.number(&format!("{name} {axis}"), unit, factor, [a[k], b[k]]);
        }
    }

    pub fn text(&mut self, name: &str, [a, b]: [&str; 2]) {
        if a != b {
            self.text += &format!("{name:30} {a} -> {b}\n");
            self.told(name, [a, b].map(str::to_owned));
        }
    }
}
