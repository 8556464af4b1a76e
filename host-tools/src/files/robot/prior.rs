//! `tolerance` and `expected` of a joint: corrections that arms of its type have.

use toml_edit::{DocumentMut, InlineTable, Item, Value};
use truearm::{JointKind, LinkParameter};

use super::check::Checker;
use super::keys::ParametersFile;
use crate::error::Result;
use crate::files::edit::{not_that_text, tables};
use crate::model::{Joint, LinkPrior, Robot};
use crate::units::link_unit;

/// Tolerances that make sense, mm or degrees.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-6..=100.0;
/// The largest correction that arms of a type may share, mm or degrees: beyond, the
/// drawing is of another arm.
const FARTHEST: f64 = 100.0;

/// Name of a parameter of a link as a key of the file.
fn parameter_key(kind: JointKind, parameter: LinkParameter) -> &'static str {
    match (parameter, kind) {
        (LinkParameter::Alpha, _) => "alpha_deg",
        (LinkParameter::A, _) => "a_mm",
        (LinkParameter::Theta, _) => "theta_offset_deg",
        (LinkParameter::D, JointKind::Revolute) => "d_mm",
        (LinkParameter::D, JointKind::Prismatic) => "d_offset_mm",
        (LinkParameter::Beta, _) => "beta_deg",
    }
}

/// The tables `tolerance` and `expected` of a joint as a file has them, what is not
/// known and what is zero left out; empty where nothing is left.
#[must_use]
pub fn prior_tables(joint: &Joint) -> [(&'static str, Vec<(&'static str, f64)>); 2] {
    let LinkPrior { expected, tolerance } = joint.prior;
    let keys = LinkParameter::ALL.map(|p| (parameter_key(joint.link.kind, p), link_unit(p).1));
    let table = |values: [Option<f64>; 5]| {
        let known = keys.iter().zip(values);
        known.filter_map(|((key, factor), value)| Some((*key, value? * factor))).collect()
    };
    let not_zero = expected.map(|value| (value != 0.0).then_some(value));
    [("tolerance", table(tolerance)), ("expected", table(not_zero))]
}

/// The text of a robot.toml with the priors of a robot in its joints; all else stays as
/// it was written.
///
/// # Errors
/// A text that is not that of the robot.
pub fn with_priors(text: &str, robot: &Robot) -> Result<String> {
    let other = || not_that_text(&robot.path);
    let mut document: DocumentMut = text.parse().map_err(|_| other())?;
    let mut joints = tables(&mut document, "joints");
    if joints.len() != robot.joints.len() {
        return Err(other());
    }
    for (table, joint) in joints.iter_mut().zip(&robot.joints) {
        for (key, values) in prior_tables(joint) {
            table.remove(key);
            // Four digits: more is known of no tolerance.
            let digits = |value: f64| format!("{value:.3e}").parse::<f64>().unwrap_or(value);
            let entries = values.into_iter().map(|(key, value)| (key, Value::from(digits(value))));
            let entries: InlineTable = entries.collect();
            if !entries.is_empty() {
                table.insert(key, Item::Value(entries.into()));
            }
        }
    }
    Ok(document.to_string())
}

impl Checker<'_> {
    /// What is known of a link's corrections, SI.
    pub fn prior(
        &self,
        kind: JointKind,
        tolerance: Option<&ParametersFile>,
        expected: Option<&ParametersFile>,
    ) -> Result<LinkPrior> {
        let positive = |value: f64| TOLERANCES.contains(&value);
        let help = "give one standard deviation of what arms of this type differ by, in mm or \
                    degrees, 1e-6 to 100; leave it out if it is unknown";
        let tolerance = self.parameters("tolerance", kind, tolerance, (&positive, help))?;
        let near = |value: f64| value.abs() <= FARTHEST;
        let help = "give the mean correction of arms of this type in mm or degrees, up to 100";
        let expected = self.parameters("expected", kind, expected, (&near, help))?;
        Ok(LinkPrior { expected: expected.map(Option::unwrap_or_default), tolerance })
    }

    fn parameters(
        &self,
        table: &str,
        kind: JointKind,
        file: Option<&ParametersFile>,
        (sound, help): (&dyn Fn(f64) -> bool, &str),
    ) -> Result<[Option<f64>; 5]> {
        let Some(file) = file else { return Ok([None; 5]) };
        let (d, other) = match kind {
            JointKind::Revolute => (&file.d_mm, &file.d_offset_mm),
            JointKind::Prismatic => (&file.d_offset_mm, &file.d_mm),
        };
        if let Some(other) = other {
            let message = format!("{table}: d_mm is of revolute joints, d_offset_mm of prismatic");
            return Err(self.source.at(other.span(), message, "name it as the joint does"));
        }
        let given = [&file.alpha_deg, &file.a_mm, &file.theta_offset_deg, d, &file.beta_deg];
        let mut values = [None; 5];
        for ((slot, given), parameter) in values.iter_mut().zip(given).zip(LinkParameter::ALL) {
            let Some(given) = given else { continue };
            let value = *given.get_ref();
            if !sound(value) {
                let message = format!("{table}.{} = {value}", parameter_key(kind, parameter));
                return Err(self.source.at(given.span(), message, help));
            }
            *slot = Some(value / link_unit(parameter).1);
        }
        Ok(values)
    }
}
