//! The terms of a model.toml: `[[terms]]` of the arm and `[[measurement_terms]]`
//! of the measurement. Coefficients are SI, their unit stands beside them.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use truearm::JointKind;
use truearm::effects::{ActsOn, Effect, Order, Term};

use crate::model::{Clock, Course, DRIFT, ModelTerm, XYZ, friction_unit};

/// Time constants that a blob can hold, s.
const LONGEST: RangeInclusive<f64> = 0.5..=61_439.0;
/// A drift with the order of rows says so.
const ROWS: &str = "rows";

/// A term of the arm.
#[derive(Serialize, Deserialize)]
pub(super) struct TermFile {
    effect: String,
    /// Counted from 1; a coupling names source and target.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    joints: Vec<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    order: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    component: Option<String>,
    /// Of a backlash whose side gravity may decide: N m, of a prismatic joint N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    friction_n_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    friction_n: Option<f64>,
    /// With which the arm follows its temperature, if it does so late.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    time_constant_s: Option<f64>,
    coefficient: f64,
    unit: String,
}

/// A term of the measurement.
#[derive(Serialize, Deserialize)]
pub(super) struct MeasurementTermFile {
    effect: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    series: Option<String>,
    /// Counted from 1.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    joints: Vec<usize>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    component: String,
    /// Hours in which a drift settles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    settling_h: Option<f64>,
    /// Rows in which one settles that goes with them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    settling_rows: Option<f64>,
    /// What a drift goes with if not with time: `rows`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    with: Option<String>,
    coefficient: f64,
    unit: String,
}

/// Both tables of a list of terms.
pub(super) fn to_file(
    terms: &[ModelTerm],
    kinds: &[JointKind],
) -> (Vec<TermFile>, Vec<MeasurementTermFile>) {
    let (mut arm, mut measurement) = (Vec::new(), Vec::new());
    for term in terms {
        let effect = term.effect_name().to_owned();
        let component = Some(term.part().to_owned()).filter(|part| !part.is_empty());
        let (coefficient, unit) = (term.coefficient(), term.unit(kinds).to_owned());
        let series = match term {
            ModelTerm::Arm(of_arm) => {
                let force = friction_unit(kinds, of_arm.joint) == "N";
                arm.push(TermFile {
                    effect,
                    joints: term.joints(),
                    order: term.order(),
                    component,
                    friction_n_m: term.friction().filter(|_| !force),
                    friction_n: term.friction().filter(|_| force),
                    time_constant_s: term.time_constant(),
                    coefficient,
                    unit,
                });
                continue;
            }
            ModelTerm::Drift { .. } | ModelTerm::Lag { .. } => None,
            ModelTerm::Remount { series, .. } => Some(series.clone()),
        };
        let component = component.unwrap_or_default();
        measurement.push(MeasurementTermFile {
            effect,
            series,
            joints: term.joints(),
            component,
            settling_h: settling(term, Clock::Time),
            settling_rows: settling(term, Clock::Rows).map(|thousands| thousands * 1e3),
            with: term.course().filter(|c| c.clock == Clock::Rows).map(|_| ROWS.to_owned()),
            coefficient,
            unit,
        });
    }
    (arm, measurement)
}

/// Reads a term of the arm; what is wrong with it, in words.
pub(super) fn arm_term(file: &TermFile, kinds: &[JointKind]) -> Result<ModelTerm, String> {
    let effect = Effect::from_name(&file.effect)
        .ok_or_else(|| format!("effect \"{}\" is not known", file.effect))?;
    let (joint, source) = places(effect, &file.joints, kinds.len())?;
    let component = match (effect.components(), file.component.as_deref()) {
        ([], None) => 0,
        ([], Some(_)) => return Err(format!("{} has no component", effect.name())),
        (names, part) => {
            let found = names.iter().position(|name| Some(*name) == part);
            found.ok_or_else(|| format!("component must be one of {names:?}"))? as u8
        }
    };
    if file.time_constant_s.is_some() && effect.order() != Order::TimeConstant {
        return Err(format!("{} has no time constant", effect.name()));
    }
    let cycles = effect.order().is_cycles();
    let order = match (effect.order(), file.order, file.friction_n_m.or(file.friction_n)) {
        (_, Some(order), None) if cycles && order > 0.0 && order.is_finite() => order,
        (_, _, None) if cycles => {
            return Err("order must be given, cycles a turn above 0".to_owned());
        }
        (Order::Friction, None, friction) => friction.unwrap_or(0.0),
        (Order::TimeConstant, None, None) => time_constant(file)?,
        (_, None, None) => 0.0,
        _ => return Err(format!("{} takes no such order or friction", effect.name())),
    };
    if !(order >= 0.0 && order.is_finite()) {
        return Err(format!("friction {order} is no torque or force"));
    }
    let coefficient = file.coefficient;
    let term = Term { effect, joint, source, component, order, coefficient };
    right_unit(&file.unit, term.unit(kinds), coefficient)?;
    Ok(ModelTerm::Arm(term))
}

/// The time constant of a term that goes with the temperature, s.
fn time_constant(file: &TermFile) -> Result<f64, String> {
    match file.time_constant_s {
        None => Ok(0.0),
        Some(tau) if LONGEST.contains(&tau) => Ok(tau),
        Some(tau) => Err(format!("time_constant_s = {tau} where 0.5 to 61439 is meant")),
    }
}

/// Joint and source, counted from 0, of joints counted from 1 of so many.
fn places(effect: Effect, joints: &[usize], count: usize) -> Result<(u8, u8), String> {
    let place = |joint: usize| match joint {
        joint if (1..=count).contains(&joint) => Ok((joint - 1) as u8),
        _ => Err(format!("joint {joint} where joints are 1 to {count}")),
    };
    match (effect.acts_on(), joints) {
        (ActsOn::Base, []) => Ok((0, 0)),
        (ActsOn::Lengths, []) => Ok((Term::<f64>::ALL, 0)),
        (ActsOn::Joint, [source, target]) if effect.is_coupled() && source != target => {
            Ok((place(*target)?, place(*source)?))
        }
        _ if effect.is_coupled() => {
            Err("joints must be [source, target], two different ones".to_owned())
        }
        (ActsOn::Joint | ActsOn::Axis | ActsOn::Lengths, [joint]) => Ok((place(*joint)?, 0)),
        _ => Err(format!("joints = {joints:?} do not suit {}", effect.name())),
    }
}

/// Reads a term of the measurement; what is wrong with it, in words.
pub(super) fn measurement_term(
    file: &MeasurementTermFile,
    kinds: &[JointKind],
) -> Result<ModelTerm, String> {
    let coefficient = file.coefficient;
    let find = |names: &[&str]| {
        let found = names.iter().position(|name| *name == file.component);
        found.ok_or_else(|| format!("component must be one of {names:?}"))
    };
    let term = match (&file.effect[..], &file.series) {
        ("measurement-drift", None) => {
            ModelTerm::Drift { component: find(&DRIFT)?, course: course(file)?, coefficient }
        }
        ("readout-lag", None) => {
            ModelTerm::Lag { joint: turning(&file.joints, kinds)?, coefficient }
        }
        ("tool-remount", Some(series)) => {
            ModelTerm::Remount { series: series.clone(), axis: find(&XYZ)?, coefficient }
        }
        ("measurement-drift" | "readout-lag", Some(_)) => {
            return Err(format!("a {} has no series", file.effect));
        }
        ("tool-remount", None) => return Err("a tool-remount needs its series".to_owned()),
        (effect, _) => return Err(format!("effect \"{effect}\" is not known")),
    };
    right_unit(&file.unit, term.unit(&[]), coefficient)?;
    Ok(term)
}

/// What a drift goes with.
fn course(file: &MeasurementTermFile) -> Result<Course, String> {
    let positive = |x: f64| x > 0.0 && x.is_finite();
    match (file.settling_h, file.settling_rows, file.with.as_deref()) {
        (None, None, None) => Ok(Clock::Time.goes_on()),
        (None, None, Some(ROWS)) => Ok(Clock::Rows.goes_on()),
        (Some(hours), None, None) if positive(hours) => Ok(Clock::Time.settles(hours)),
        (Some(_), None, None) => Err("settling_h must be hours above 0".to_owned()),
        (None, Some(rows), Some(ROWS)) if positive(rows) => Ok(Clock::Rows.settles(rows / 1e3)),
        (None, Some(_), Some(ROWS)) => Err("settling_rows must be rows above 0".to_owned()),
        _ => {
            Err("a drift has settling_h, or with = \"rows\" and perhaps settling_rows, or none of \
                  these"
                .to_owned())
        }
    }
}

/// How fast a drift settles by a clock, in its unit.
fn settling(term: &ModelTerm, clock: Clock) -> Option<f64> {
    term.course().filter(|course| course.clock == clock)?.settling
}

/// The one revolute joint of a list counted from 1, counted from 0.
fn turning(joints: &[usize], kinds: &[JointKind]) -> Result<usize, String> {
    match joints {
        [joint] if kinds.get(joint.wrapping_sub(1)) == Some(&JointKind::Revolute) => Ok(joint - 1),
        _ => Err(format!("joints = {joints:?} must be one revolute joint")),
    }
}

fn right_unit(unit: &str, expected: &str, coefficient: f64) -> Result<(), String> {
    if unit != expected {
        Err(format!("unit \"{unit}\" where \"{expected}\" is read"))
    } else if !coefficient.is_finite() {
        Err("coefficient is not finite".to_owned())
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [JointKind; 3] = [JointKind::Revolute, JointKind::Prismatic, JointKind::Revolute];

    /// A term of every effect on a joint of either kind, and of the measurement.
    fn terms() -> Vec<ModelTerm> {
        let mut terms = Vec::new();
        for effect in Effect::ALL.iter().copied() {
            for joint in 0..2 {
                let all = effect.acts_on() == ActsOn::Lengths && joint == 1;
                let base = effect.acts_on() == ActsOn::Base;
                terms.push(ModelTerm::Arm(Term {
                    effect,
                    joint: if all { Term::<f64>::ALL } else { joint * u8::from(!base) },
                    source: if effect.is_coupled() { 2 } else { 0 },
                    component: joint * u8::from(!effect.components().is_empty()),
                    order: match effect.order() {
                        Order::Friction => 3.7 * f64::from(joint),
                        Order::Harmonic | Order::Cycles => 2.013,
                        Order::None => 0.0,
                        Order::TimeConstant => 1500.0 * f64::from(joint),
                    },
                    coefficient: 1.25e-5,
                }));
            }
        }
        for component in 0..6 {
            for course in [
                Clock::Time.goes_on(),
                Clock::Time.settles(0.25),
                Clock::Rows.goes_on(),
                Clock::Rows.settles(0.125),
            ] {
                terms.push(ModelTerm::Drift { component, course, coefficient: 1e-4 });
            }
        }
        terms.push(ModelTerm::Lag { joint: 2, coefficient: 3e-4 });
        for axis in 0..3 {
            terms.push(ModelTerm::Remount { series: "b".into(), axis, coefficient: -3e-4 });
        }
        terms
    }

    #[derive(Serialize, Deserialize)]
    struct File {
        terms: Vec<TermFile>,
        measurement_terms: Vec<MeasurementTermFile>,
    }

    #[test]
    fn what_is_written_is_read() {
        let (arm, measurement) = to_file(&terms(), &KINDS);
        let text = toml::to_string(&File { terms: arm, measurement_terms: measurement }).unwrap();
        let file: File = toml::from_str(&text).unwrap();
        let mut read: Vec<_> = file.terms.iter().map(|t| arm_term(t, &KINDS).unwrap()).collect();
        read.extend(file.measurement_terms.iter().map(|t| measurement_term(t, &KINDS).unwrap()));
        assert_eq!(read, terms());
        for words in ["unit = \"m/N\"", "unit = \"m/rad\"", "friction_n = 3.7", "unit = \"rad/h\""]
        {
            assert!(text.contains(words), "{words} in {text}");
        }
    }

    #[test]
    fn nonsense_is_named() {
        let refused = |text: &str| arm_term(&toml::from_str(text).unwrap(), &KINDS).unwrap_err();
        for (text, words) in [
            ("effect = \"ghost\"\nunit = \"rad\"", "effect \"ghost\" is not known"),
            ("effect = \"joint-gain\"\nunit = \"rad/rad\"\njoints = [4]", "joint 4"),
            ("effect = \"joint-gain\"\nunit = \"rad/rad\"\njoints = [0]", "joint 0"),
            ("effect = \"joint-gain\"\nunit = \"rad/rad\"", "joints = [] do not suit"),
            (
                "effect = \"joint-gain\"\nunit = \"mm\"\njoints = [1]",
                "unit \"mm\" where \"rad/rad\"",
            ),
            ("effect = \"joint-gain\"\nunit = \"rad\"\njoints = [1]\norder = 2", "no such order"),
            ("effect = \"joint-coupling\"\nunit = \"rad\"\njoints = [1, 1]", "two different"),
            ("effect = \"base-compliance\"\nunit = \"rad/Nm\"", "component must be one of"),
            (
                "effect = \"joint-periodic-error\"\nunit = \"rad\"\njoints = [1]\ncomponent = \"sin\"",
                "order must be given",
            ),
            (
                "effect = \"joint-gain\"\nunit = \"rad/rad\"\njoints = [1]\ntime_constant_s = 60",
                "joint-gain has no time constant",
            ),
            (
                "effect = \"thermal-expansion\"\nunit = \"1/K\"\ntime_constant_s = -60",
                "time_constant_s = -60 where 0.5 to 61439 is meant",
            ),
        ] {
            let message = refused(&format!("coefficient = 1e-5\n{text}"));
            assert!(message.contains(words), "{words} in {message}");
        }
    }
}
