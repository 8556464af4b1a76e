//! Degrees or radians, millimetres or metres: by what was asked for, by the
//! headings, by the nominal arm, by the size of the numbers.

use nalgebra::Vector3;
use truearm::JointKind;

use super::clues::{Clues, Found, Place};
use crate::error::{Error, Result};
use crate::headings::{Quantity, Unit};
use crate::import::agreement;
use crate::import::join::RowRef;
use crate::model::Robot;
use crate::units::{from_mm, joint_from_file};

/// A unit and why.
type Told = (Unit, String);

/// A reading is the arm's if distances agree as well as this (median of the
/// logarithm: a third) and the other reading is off by twice as much at least.
const AGREES: f64 = 0.3;
/// A joint that was told in radians cannot go further than a turn and a bit.
const TURN: f64 = 6.4;
/// Two turns in radians: what is beyond are degrees.
const TWO_TURNS: f64 = 12.6;
/// Points of an arm span less than this in metres.
const MOST_METRES: f64 = 5.0;
/// And more than this in millimetres.
const LEAST_MM: f64 = 30.0;

const ANGLES_FLAG: &str = "say it: --angles rad or --angles deg; a robot.toml given with --robot may settle \
                           it by limits and lengths";
const LENGTHS_FLAG: &str = "say it: --lengths mm or --lengths m; a robot.toml given with --robot may settle \
                            it by the arm's reach";

/// The unit of every joint and of x, y, z.
///
/// # Errors
/// Numbers that may be either, with the flag that settles it.
pub(super) fn decide(
    clues: &Clues,
    found: &Found,
    rows: &[RowRef],
    warnings: &mut Vec<String>,
) -> Result<(Vec<Told>, Vec<Told>)> {
    let quantities: Vec<Quantity> =
        found.joints.iter().enumerate().map(|(j, p)| clues.joint_quantity(j, p)).collect();
    let of = |quantity| {
        let pairs = found.joints.iter().zip(&quantities);
        pairs.filter(|(_, q)| **q == quantity).map(|(p, _)| p).collect::<Vec<_>>()
    };
    let (turning, sliding) = (of(Quantity::Angle), of(Quantity::Length));
    let known_angles = known(clues, &turning, clues.options.angles, Quantity::Angle);
    let point: Vec<&Place> = found.point.iter().collect();
    let known_lengths = known(clues, &point, clues.options.lengths, Quantity::Length);
    let readings = Readings::of(clues, found, &quantities, rows);
    readings.warn(&known_angles, &known_lengths, warnings);
    let angles = match known_angles {
        Some(told) => told,
        None => match readings.joints().or_else(|| by_limits(clues, found, &quantities, rows)) {
            Some(told) => told,
            None => angles_by_size(most(clues, &turning))?,
        },
    };
    let lengths = match known_lengths {
        Some(told) => told,
        None => match readings.points().or_else(|| by_reach(clues, &point)) {
            Some(told) => told,
            None => lengths_by_size(span(clues, &point), "the points span")?,
        },
    };
    let slides = match known(clues, &sliding, clues.options.lengths, Quantity::Length) {
        Some(told) => told,
        None if sliding.is_empty() => lengths.clone(),
        None => lengths_by_size(span(clues, &sliding), "the sliding joint spans")?,
    };
    let joint = |quantity: &Quantity| match quantity {
        Quantity::Length => slides.clone(),
        _ => angles.clone(),
    };
    Ok((quantities.iter().map(joint).collect(), vec![lengths; 3]))
}

/// As asked, or as headings say.
fn known(
    clues: &Clues,
    places: &[&Place],
    asked: Option<Unit>,
    quantity: Quantity,
) -> Option<Told> {
    if let Some(unit) = asked {
        return Some((unit, "it was asked for".to_owned()));
    }
    let said = places.iter().find_map(|p| Some((clues.said(p)?, p)));
    let (unit, place) = said.filter(|(unit, _)| unit.quantity() == quantity)?;
    let table = &clues.tables[place.file];
    let heading = &table.headings[place.column].text;
    let where_ = match table.settled.unit_line {
        Some(line) => format!("line {line}"),
        None => format!("the heading \"{heading}\""),
    };
    Some((unit, format!("{where_} says {}", unit.word())))
}

fn most(clues: &Clues, places: &[&Place]) -> f64 {
    places.iter().fold(0.0, |most, p| clues.tables[p.file].most(p.column).max(most))
}

fn span(clues: &Clues, places: &[&Place]) -> f64 {
    places.iter().fold(0.0, |most, p| clues.tables[p.file].range(p.column).max(most))
}

fn angles_by_size(most: f64) -> Result<Told> {
    let upper = (most * 10.0 + 1e-9).ceil() / 10.0;
    if most > TWO_TURNS {
        return Ok((Unit::Deg, format!("|q| goes up to {upper}")));
    }
    if most <= TURN && most > 0.2 {
        return Ok((Unit::Rad, format!("|q| < {upper}: in degrees the arm would hardly move")));
    }
    Err(Error::usage(
        format!("are the joints degrees or radians? |q| <= {upper} may be either"),
        ANGLES_FLAG,
    ))
}

fn lengths_by_size(span: f64, what: &str) -> Result<Told> {
    if span > LEAST_MM {
        return Ok((Unit::Mm, format!("{what} {span:.0}: no arm reaches so many metres")));
    }
    if span < MOST_METRES && span > 0.0 {
        return Ok((
            Unit::M,
            format!("{what} {span:.3}: in millimetres the arm would hardly move"),
        ));
    }
    Err(Error::usage(format!("millimetres or metres? {what} {span:.3}"), LENGTHS_FLAG))
}

/// The only unit in which the joints are within the arm's limits.
fn by_limits(
    clues: &Clues,
    found: &Found,
    quantities: &[Quantity],
    rows: &[RowRef],
) -> Option<Told> {
    let robot = clues.robot?;
    let places: Vec<&Place> = found.joints.iter().collect();
    let values = clues.numbers(&places, rows);
    let inside = |unit: Unit| {
        let within = |q: &Vec<f64>| {
            let joints = robot.joints.iter().zip(q).zip(quantities);
            joints.filter(|(_, quantity)| **quantity == Quantity::Angle).all(
                |((joint, value), _)| {
                    let angle = unit.to_file(*value).to_radians();
                    joint
                        .limits
                        .is_none_or(|[low, high]| angle >= low - 0.02 && angle <= high + 0.02)
                },
            )
        };
        values.iter().filter(|q| within(q)).count() as f64 / values.len().max(1) as f64
    };
    // As degrees small numbers are always inside: only the other way decides.
    let (degrees, radians) = (inside(Unit::Deg), inside(Unit::Rad));
    let told = degrees > 0.95 && radians < 0.5;
    told.then(|| {
        let outside = 100.0 * (1.0 - radians);
        (
            Unit::Deg,
            format!("in radians {outside:.0} % of the rows are outside the limits of the joints"),
        )
    })
}

/// The only unit in which the points are within the arm's reach.
fn by_reach(clues: &Clues, point: &[&Place]) -> Option<Told> {
    let robot = clues.robot?;
    let reach = reach(robot);
    let span = span(clues, point);
    let fits = |metres: f64| metres <= 2.6 * reach && metres >= 5e-3 * reach;
    let (mm, m) = (fits(from_mm(span)), fits(span));
    let unit = if mm { Unit::Mm } else { Unit::M };
    (mm != m).then(|| (unit, format!("the points span {span:.3} and the arm reaches {reach:.2} m")))
}

/// All lengths of the arm, m.
fn reach(robot: &Robot) -> f64 {
    let links = robot.joints.iter().map(|j| {
        let p = &j.link.parameters;
        let slide = match (j.link.kind, j.limits) {
            (JointKind::Prismatic, Some([low, high])) => low.abs().max(high.abs()),
            _ => 0.0,
        };
        p.a.abs() + p.d.abs() + slide
    });
    links.sum::<f64>() + robot.tool.norm()
}

/// How far the nominal arm is from every reading: joint unit, point unit,
/// median logarithm of the ratio of distances.
struct Readings(Vec<(Unit, Unit, f64)>);

impl Readings {
    fn of(clues: &Clues, found: &Found, quantities: &[Quantity], rows: &[RowRef]) -> Self {
        let Some(robot) = clues.robot else { return Self(Vec::new()) };
        let places: Vec<&Place> = found.joints.iter().chain(&found.point).collect();
        let values = clues.numbers(&places, rows);
        let n = found.joints.len();
        let mut all = Vec::new();
        for angle in [Unit::Deg, Unit::Rad] {
            for length in [Unit::Mm, Unit::M] {
                let joint = |(j, v): (usize, &f64)| match quantities[j] {
                    Quantity::Length => joint_from_file(JointKind::Prismatic, length.to_file(*v)),
                    _ => angle.to_file(*v).to_radians(),
                };
                let q: Vec<Vec<f64>> =
                    values.iter().map(|v| v[..n].iter().enumerate().map(joint).collect()).collect();
                let point =
                    |v: &Vec<f64>| Vector3::from_fn(|i, _| from_mm(length.to_file(v[n + i])));
                let points: Vec<_> = values.iter().map(point).collect();
                if let Some(misfit) = agreement::distances(robot, &q, &points) {
                    all.push((angle, length, misfit));
                }
            }
        }
        Self(all)
    }

    /// The best reading, where it agrees, and the best that differs by `key`.
    fn best(&self, key: impl Fn(&(Unit, Unit, f64)) -> Unit) -> Option<(Unit, f64, f64)> {
        let best = self.0.iter().min_by(|a, b| a.2.total_cmp(&b.2)).filter(|b| b.2 < AGREES)?;
        let others = self.0.iter().filter(|r| key(r) != key(best));
        let other = others.map(|r| r.2).fold(f64::INFINITY, f64::min);
        (other > 2.0 * best.2 && other.is_finite()).then(|| (key(best), best.2, other))
    }

    fn told(best: Option<(Unit, f64, f64)>) -> Option<Told> {
        let (unit, misfit, other) = best?;
        let percent = |misfit: f64| 100.0 * misfit.exp_m1();
        let words = format!(
            "distances between the points are those of the nominal arm within {:.0} % (otherwise {:.0} %)",
            percent(misfit).ceil(),
            percent(other)
        );
        Some((unit, words))
    }

    fn joints(&self) -> Option<Told> {
        Self::told(self.best(|r| r.0))
    }

    fn points(&self) -> Option<Told> {
        Self::told(self.best(|r| r.1))
    }

    /// Where the arm contradicts what a heading says or a flag asks for.
    fn warn(&self, angles: &Option<Told>, lengths: &Option<Told>, warnings: &mut Vec<String>) {
        let pairs = [("joints", angles, self.joints()), ("points", lengths, self.points())];
        for (what, known, arm) in pairs {
            let (Some((unit, because)), Some((other, words))) = (known, arm) else { continue };
            let plain = [Unit::Deg, Unit::Rad, Unit::Mm, Unit::M].contains(unit);
            if plain && *unit != other {
                warnings.push(format!(
                    "{what} are taken in {}, because {because}; but in {} {words}",
                    unit.word(),
                    other.word()
                ));
            }
        }
    }
}
