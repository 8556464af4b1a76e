use std::path::Path;

use truearm::{JointKind, Link, MdhParameters, Pose};

use super::units::{Quantity, Units, column, in_turns, value};
use crate::convert::frames::{about_y, screw, twist};
use crate::convert::verified;
use crate::error::{Error, Place, Result};
use crate::files::{self, RobotDraft};
use crate::model::{Joint, LinkPrior, Placement};

/// Which of the two conventions a table is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// `Rz(theta) Tz(d) Tx(a) Rx(alpha)`: a and alpha lead to the next axis.
    Standard,
    /// `Rx(alpha) Tx(a) Rz(theta) Tz(d) Ry(beta)`, Craig's: a and alpha lead here.
    Modified,
}

/// A table of Denavit-Hartenberg parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// How its rows are meant.
    pub convention: Convention,
    /// A row a joint, SI.
    pub rows: Vec<Joint>,
}

impl Table {
    /// Reads a table of comma, semicolon or tab separated cells under titles
    /// with units (`a_mm`, `alpha_deg`), or with these units.
    ///
    /// # Errors
    /// Names line and column.
    pub fn read(path: &Path, convention: Convention, units: &Units) -> Result<Self> {
        Self::parse(path, &files::read(path)?, convention, units)
    }

    /// Like [`Table::read`] from a text.
    ///
    /// # Errors
    /// As for [`Table::read`].
    pub fn parse(path: &Path, text: &str, convention: Convention, units: &Units) -> Result<Self> {
        let titles = text.lines().find(|l| !l.trim().is_empty() && !l.starts_with('#'));
        let titles = titles.unwrap_or("");
        let delimiter = [b'\t', b';', b','].into_iter().find(|d| titles.contains(char::from(*d)));
        let delimiter = delimiter.unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let help = "save the table as CSV: a line of titles, then a line a joint";
        let fail = |e: csv::Error| {
            let line = e.position().map_or(Place::default(), |p| Place::line(p.line() as usize));
            Error::file(path, line, e.to_string(), help)
        };
        let header = reader.headers().map_err(fail)?.clone();
        let line = header.position().map_or(1, |p| p.line() as usize);
        let columns = Columns::new((path, line), &header, units, convention)?;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(fail)?;
            let line = record.position().map_or(0, |p| p.line() as usize);
            rows.push(columns.joint(&record, line, delimiter != b',')?);
        }
        if rows.is_empty() {
            return Err(Error::file(path, Place::default(), "no joints in the table", help));
        }
        Ok(Self { convention, rows })
    }

    /// The last frame at joint values `q`, as the convention has it.
    #[must_use]
    pub fn pose(&self, q: &[f64]) -> Pose<f64> {
        let step = |(joint, q): (&Joint, &f64)| {
            let MdhParameters { alpha, a, mut theta, mut d, beta } = joint.link.parameters;
            match joint.link.kind {
                JointKind::Revolute => theta += q,
                JointKind::Prismatic => d += q,
            }
            match self.convention {
                Convention::Standard => screw(theta, d).compose(&twist(alpha, a)),
                Convention::Modified => {
                    twist(alpha, a).compose(&screw(theta, d)).compose(&about_y(beta))
                }
            }
        };
        let steps = self.rows.iter().zip(q).map(step);
        steps.fold(Pose::identity(), |at, step| at.compose(&step))
    }

    /// The same as links of the modified convention, and what is left behind
    /// the last: a and alpha of its row, in the standard one.
    fn modified(&self) -> (Vec<Joint>, Pose<f64>) {
        if self.convention == Convention::Modified {
            return (self.rows.clone(), Pose::identity());
        }
        let (mut alpha, mut a) = (0.0, 0.0);
        let joints = self.rows.iter().map(|joint| {
            let p = joint.link.parameters;
            let parameters = MdhParameters { alpha, a, ..p };
            (alpha, a) = (p.alpha, p.a);
            Joint { link: Link { kind: joint.link.kind, parameters }, ..*joint }
        });
        (joints.collect(), twist(alpha, a))
    }
}

/// The robot.toml of a table; its coordinates are those of the frame before the
/// first row. It is read again and compared with the table's own product.
///
/// # Errors
/// What [`Table::read`] and the reader of a robot.toml refuse.
pub fn robot_of_table(path: &Path, convention: Convention, units: &Units) -> Result<String> {
    let table = Table::read(path, convention, units)?;
    let (joints, tool) = table.modified();
    let file = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let stem = path.file_stem().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let which = match convention {
        Convention::Standard => "standard",
        Convention::Modified => "modified",
    };
    let draft = RobotDraft {
        origin: vec![format!("Of {file}, {which} Denavit-Hartenberg. Lengths mm, angles degrees.")],
        name: stem,
        tool: Placement::of(&tool),
        joints: joints.into_iter().map(|joint| (String::new(), joint)).collect(),
        ..RobotDraft::default()
    };
    let text = draft.to_toml();
    let limits: Vec<_> = table.rows.iter().map(|joint| joint.limits).collect();
    verified(&text, &limits, |q| table.pose(q))?;
    Ok(text)
}

/// What the columns hold.
struct Columns<'a> {
    path: &'a Path,
    titles: Vec<String>,
    /// What each holds and how many metres or radians one of it is.
    known: Vec<(Quantity, f64)>,
}

impl<'a> Columns<'a> {
    fn new(
        (path, line): (&'a Path, usize),
        header: &csv::StringRecord,
        units: &Units,
        convention: Convention,
    ) -> Result<Self> {
        let fail =
            |message: String, help: &str| Err(Error::file(path, Place::line(line), message, help));
        let titles: Vec<String> = header.iter().map(str::to_owned).collect();
        let mut known: Vec<(Quantity, f64)> = Vec::new();
        for title in &titles {
            let Some((quantity, unit)) = column(title) else {
                let help = "titles are alpha_deg, a_mm, theta_offset_deg, d_mm (also _rad, _m), and \
                            if you have them beta_deg, kind, lower_deg, upper_deg";
                return fail(format!("column \"{title}\" is not known"), help);
            };
            if known.iter().any(|(other, _)| *other == quantity) {
                return fail(format!("two columns for {}", quantity.name()), "delete one");
            }
            let (stated, name) = match quantity.is_length() {
                true => (units.length, "a_mm or a_m"),
                false => (units.angle, "alpha_deg or alpha_rad"),
            };
            let Some(unit) = unit.or(stated).or(quantity.is_text().then_some(1.0)) else {
                let option =
                    if quantity.is_length() { "--lengths mm|m" } else { "--angles deg|rad" };
                let help = format!("write it into the title, as in {name}, or give {option}");
                return fail(format!("column \"{title}\" does not say its unit"), &help);
            };
            known.push((quantity, unit));
        }
        let has = |quantity| known.iter().any(|(q, _)| *q == quantity);
        let needed = [Quantity::Alpha, Quantity::A, Quantity::Theta, Quantity::D];
        if let Some(missing) = needed.into_iter().find(|q| !has(*q)) {
            let found = titles.join(", ");
            let help = "a table has alpha, a, theta_offset and d, with zeros where nothing is";
            return fail(format!("no column for {} among {found}", missing.name()), help);
        }
        if has(Quantity::Beta) && convention == Convention::Standard {
            let help =
                "beta belongs to the modified convention; give --dh modified if that is meant";
            return fail("a column for beta in a standard table".to_owned(), help);
        }
        Ok(Self { path, titles, known })
    }

    /// A cell, in the unit of its column.
    fn number(
        &self,
        cell: &str,
        (quantity, unit): (Quantity, f64),
        (line, title): (usize, &str),
        commas: bool,
    ) -> Result<f64> {
        let fail = |message: String, help: &str| {
            Err(Error::file(self.path, Place::field(line, title), message, help))
        };
        let point = if commas { cell.replace(',', ".") } else { cell.to_owned() };
        let Some(value) = value(&point) else {
            let help = "give a number, or pi/2 and the like in radians; of a joint's \
                        variable only its constant offset, 0 if there is none";
            return fail(format!("\"{cell}\" is not a number"), help);
        };
        if in_turns(&point) && (quantity.is_length() || unit != 1.0) {
            let help = "pi is an angle in radians: write the number in the unit of \
                        the column, or the column in radians";
            return fail(format!("\"{cell}\" where the column is not in radians"), help);
        }
        Ok(value)
    }

    /// A row; cells may have decimal commas where these do not separate.
    fn joint(&self, record: &csv::StringRecord, line: usize, commas: bool) -> Result<Joint> {
        let mut numbers: Vec<(Quantity, f64)> = Vec::new();
        let mut kind = JointKind::Revolute;
        for (((quantity, unit), title), cell) in self.known.iter().zip(&self.titles).zip(record) {
            let fail = |message: String, help: &str| {
                Err(Error::file(self.path, Place::field(line, title), message, help))
            };
            match quantity {
                Quantity::Number => {}
                Quantity::Kind => {
                    kind = match cell.to_lowercase().as_str() {
                        "" | "r" | "revolute" => JointKind::Revolute,
                        "p" | "prismatic" => JointKind::Prismatic,
                        _ => return fail(format!("\"{cell}\""), "use revolute or prismatic"),
                    }
                }
                Quantity::Lower | Quantity::Upper if cell.is_empty() => {}
                _ => {
                    let value = self.number(cell, (*quantity, *unit), (line, title), commas)?;
                    numbers.push((*quantity, value * unit));
                }
            }
        }
        let of = |quantity| numbers.iter().find(|(q, _)| *q == quantity).map(|(_, value)| *value);
        let or_zero = |quantity| of(quantity).unwrap_or(0.0);
        let parameters = MdhParameters {
            alpha: or_zero(Quantity::Alpha),
            a: or_zero(Quantity::A),
            theta: or_zero(Quantity::Theta),
            d: or_zero(Quantity::D),
            beta: or_zero(Quantity::Beta),
        };
        let limits = of(Quantity::Lower).zip(of(Quantity::Upper)).map(|(low, high)| [low, high]);
        if let Some([low, high]) = limits.filter(|[low, high]| low > high) {
            let message = format!("limits from {low} to {high} rad or m");
            return Err(Error::file(
                self.path,
                Place::line(line),
                message,
                "give the lower limit first",
            ));
        }
        Ok(Joint {
            link: Link { kind, parameters },
            limits,
            gear_ratio: None,
            prior: LinkPrior::default(),
        })
    }
}
