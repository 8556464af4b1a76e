//! The columns of measurements.csv.

use crate::headings::Quantity;
use crate::import::config::{Config, Pick};
use crate::import::native::{Own, own};
use crate::import::turn::Form;

/// One column of measurements.csv.
pub struct Output<'a> {
    pub name: String,
    pub pick: &'a Pick,
    pub kind: Kind,
}

/// What a cell of it holds.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// A number that must be there.
    Needed,
    /// The same in rows that measured a point.
    Point,
    /// A number, or nothing.
    Optional,
    Label,
    Time,
}

/// The columns in their order, orientation apart.
pub fn outputs(config: &Config) -> Vec<Output<'_>> {
    let output = |(to, pick): (&String, &'_ Pick)| {
        let (name, kind) = match to.as_str() {
            "x" | "y" | "z" => (format!("{to}_mm"), Kind::Point),
            "station" | "marker" | "series" => (to.clone(), Kind::Label),
            "order" => (to.clone(), Kind::Optional),
            "time" => ("time_s".to_owned(), Kind::Time),
            "temperature" => ("temperature_c".to_owned(), Kind::Optional),
            "payload" => ("payload_kg".to_owned(), Kind::Optional),
            "sigma" => ("sigma_mm".to_owned(), Kind::Optional),
            _ if to.starts_with("dir") => (to.clone(), Kind::Optional),
            _ if own(to) == Some(Own::Label) => (to.clone(), Kind::Label),
            _ if own(to) == Some(Own::Number) => (to.clone(), Kind::Optional),
            _ => {
                let length = pick.unit.quantity() == Quantity::Length;
                (format!("{to}_{}", if length { "mm" } else { "deg" }), Kind::Needed)
            }
        };
        (name, kind)
    };
    let orientation = |to: &str| Form::ALL.iter().any(|form| form.columns().contains(&to));
    // A date is a part of the time.
    let columns = config.ordered().into_iter().filter(|(to, _)| !orientation(to) && *to != "date");
    columns
        .map(|(to, pick)| {
            let (name, kind) = output((to, pick));
            Output { name, pick, kind }
        })
        .collect()
}
