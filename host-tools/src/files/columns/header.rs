use std::collections::HashSet;

use crate::error::{Error, Result, listed};
use crate::files::source::{Source, resembling};
use crate::headings::suggestion;
use truearm::JointKind;

use crate::model::{Joint, Robot};
use crate::units::joint_column;

/// The names of the columns; those that were asked for are known.
pub(in crate::files) struct Header<'a> {
    source: Source<'a>,
    names: &'a [String],
    known: Vec<bool>,
}

impl<'a> Header<'a> {
    pub fn new(source: Source<'a>, names: &'a [String]) -> Result<Self> {
        let header = Self { source, names, known: vec![false; names.len()] };
        if names.iter().all(|n| n.is_empty()) {
            return Err(source.whole("the file is empty", "it needs a header line and rows"));
        }
        if names.len() == 1 && names[0].contains(';') {
            let help = "separate them by commas, with decimal points; `truearm import` does it";
            return Err(header.fail("cells are separated by `;`", help));
        }
        if names.iter().all(|name| name.parse::<f64>().is_ok()) {
            let help = format!(
                "write the names of the columns above them, or `truearm import {} --out \
                 measurements.csv`",
                source.path.display()
            );
            return Err(header.fail("no header: the first line is numbers", help));
        }
        let mut seen = HashSet::with_capacity(names.len());
        match (0..names.len()).find(|i| !seen.insert(names[*i].as_str())) {
            Some(i) => {
                let message = format!("column {} stands there twice", names[i]);
                Err(header.fail_in(i, message, "rename or delete one"))
            }
            None => Ok(header),
        }
    }

    pub fn fail(&self, message: impl Into<String>, help: impl Into<String>) -> Error {
        let (line, start) = self.source.begin(1, 0);
        self.source.in_line(line, start, message, help)
    }

    /// A column that is needed is not there: what is, what may be meant, and who
    /// makes it.
    pub fn missing(&self, name: &str, help: &str) -> Error {
        let stem = |name: &str| name.split('_').next().unwrap_or_default().to_owned();
        let meant = self.names.iter().find(|found| {
            *found != name && suggestion(found).is_some_and(|s| stem(&s) == stem(name))
        });
        // The column of another joint is none for this one.
        let number = |name: &str| name.chars().filter(char::is_ascii_digit).collect::<String>();
        let names = self.names.iter().map(String::as_str);
        let names = names.filter(|found| number(found) == number(name));
        let meant = meant.map(String::as_str).or_else(|| resembling(name, names));
        let meant = meant.map_or(String::new(), |found| format!("; {name} may be \"{found}\""));
        let found: Vec<String> = self.names.iter().map(|n| format!("\"{n}\"")).collect();
        let help = format!(
            "{help}; found {}{meant}; `truearm import {} --out measurements.csv` makes the columns of \
             any table",
            listed(&found),
            self.source.path.display()
        );
        self.fail(format!("missing column {name}"), help)
    }

    fn fail_in(&self, column: usize, message: String, help: &str) -> Error {
        self.fail(message, help).showing(self.source.text, self.source.cell(0, column))
    }

    /// Where a column stands, if it is there; nobody asked for it yet.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// A column by name, if it is there.
    pub fn take(&mut self, name: &str) -> Option<usize> {
        let found = self.names.iter().position(|n| n == name)?;
        self.known[found] = true;
        Some(found)
    }

    /// Those that nobody asked for.
    pub fn unknown(&self) -> Vec<usize> {
        (0..self.names.len()).filter(|i| !self.known[*i]).collect()
    }

    /// A column a joint.
    pub fn joints(&mut self, robot: &Robot, prefix: Option<&str>) -> Result<Vec<usize>> {
        let n = robot.joints.len();
        let mut q = Vec::new();
        for (j, joint) in robot.joints.iter().enumerate() {
            let Some(prefix) = prefix else { break };
            let kind = joint.link.kind;
            let name = joint_column(prefix, j, kind);
            let missing = |header: &Self| {
                let (joint, file) = (j + 1, robot.path.display());
                let word = match kind {
                    JointKind::Revolute => "revolute",
                    JointKind::Prismatic => "prismatic",
                };
                let help =
                    format!("joint {joint} of {file} is {word} and the robot has {n} joints");
                header.missing(&name, &help)
            };
            q.push(self.take(&name).ok_or_else(|| missing(self))?);
        }
        let prefix = prefix.unwrap_or("q");
        let extra = [format!("{prefix}{}_deg", n + 1), format!("{prefix}{}_mm", n + 1)];
        match self.names.iter().position(|name| extra.contains(name)) {
            Some(i) => {
                let (name, file) = (&self.names[i], robot.path.display());
                let help = "use the robot file of this arm, or delete the column";
                Err(self.fail_in(i, format!("column {name}, but {file} has {n} joints"), help))
            }
            None => Ok(q),
        }
    }

    /// What the joints hold, a column each or none.
    pub fn torques(&mut self, robot: &Robot) -> Result<Option<Vec<usize>>> {
        let name = |(j, joint): (usize, &Joint)| match joint.link.kind {
            JointKind::Revolute => format!("torque{}_nm", j + 1),
            JointKind::Prismatic => format!("force{}_n", j + 1),
        };
        let names: Vec<String> = robot.joints.iter().enumerate().map(name).collect();
        let found: Vec<Option<usize>> = names.iter().map(|name| self.take(name)).collect();
        match found.iter().position(Option::is_none) {
            None => Ok(found.into_iter().collect()),
            Some(_) if found.iter().all(Option::is_none) => Ok(None),
            Some(missing) => Err(self.fail(
                format!("column {} is missing beside the others of its kind", names[missing]),
                "add it, or delete the others: a joint's torque is taken from all or from none",
            )),
        }
    }

    pub fn orientation(&mut self) -> Result<Option<[usize; 4]>> {
        match ["qx", "qy", "qz", "qw"].map(|name| self.take(name)) {
            [Some(x), Some(y), Some(z), Some(w)] => Ok(Some([x, y, z, w])),
            [None, None, None, None] => Ok(None),
            _ => Err(self.fail(
                "orientation needs all of qx, qy, qz, qw",
                "add the missing ones or delete the others",
            )),
        }
    }
}
