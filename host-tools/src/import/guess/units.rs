//! Degrees or radians, millimetres or metres, column by column: by what was asked
//! for, by the headings, by the nominal arm, by the size of the numbers.

use super::clues::{Clues, Found, Place};
use super::contradiction::contradictions;
use super::readings::{Readings, Told, within_reach};
use crate::error::{Error, Result};
use crate::headings::{Quantity, Unit};
use crate::import::join::RowRef;

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
/// Numbers that may be either, headings of unknown units, and files one below the
/// other in different ones, with the flag that settles it.
pub(super) fn decide(
    clues: &Clues,
    found: &Found,
    rows: &[RowRef],
    warnings: &mut Vec<String>,
) -> Result<(Vec<Told>, Vec<Told>)> {
    let told = of_rows(clues, found, rows, warnings)?;
    if rows.iter().any(|row| row.stacked.is_some()) {
        alike(clues, found, rows)?;
    }
    Ok(told)
}

/// One below the other, files are of one unit: each by itself says the same.
fn alike(clues: &Clues, found: &Found, rows: &[RowRef]) -> Result<()> {
    let mut before: Option<(usize, Vec<Unit>)> = None;
    for file in 0..clues.tables.len() {
        let here = |places: &[Place]| -> Vec<Place> {
            places.iter().map(|p| Place { file, ..p.clone() }).collect()
        };
        let part = Found { joints: here(&found.joints), point: here(&found.point) };
        let own: Vec<RowRef> = rows.iter().filter(|r| r.stacked == Some(file)).cloned().collect();
        // A file that says nothing by itself is as the others are.
        let Ok(told) = of_rows(clues, &part, &own, &mut Vec::new()) else { continue };
        let units: Vec<Unit> = told.0.iter().chain(&told.1).map(|told| told.0).collect();
        let (other, others) = before.get_or_insert_with(|| (file, units.clone()));
        let pairs = units.iter().zip(others.iter());
        if let Some((now, then)) = pairs.into_iter().find(|(now, then)| now != then) {
            let [a, b] = [*other, file].map(|file| clues.tables[file].path.display().to_string());
            return Err(Error::usage(
                format!("{a} is in {} and {b} in {}", then.word(), now.word()),
                "files one below the other have the same units: import them one by one, each with \
                 its own --angles and --lengths, and put the results together",
            ));
        }
    }
    Ok(())
}

fn of_rows(
    clues: &Clues,
    found: &Found,
    rows: &[RowRef],
    warnings: &mut Vec<String>,
) -> Result<(Vec<Told>, Vec<Told>)> {
    let before = warnings.len();
    let quantities: Vec<Quantity> =
        found.joints.iter().enumerate().map(|(j, p)| clues.joint_quantity(j, p)).collect();
    let of_joint = |(place, quantity): (&Place, &Quantity)| known(clues, place, *quantity);
    let joints: Vec<Option<Told>> =
        found.joints.iter().zip(&quantities).map(of_joint).collect::<Result<_>>()?;
    let of_point = |place: &Place| known(clues, place, Quantity::Length);
    let point: Vec<Option<Told>> = found.point.iter().map(of_point).collect::<Result<_>>()?;
    let said: Vec<Option<Unit>> =
        joints.iter().chain(&point).map(|told| told.as_ref().map(|(unit, _)| *unit)).collect();
    let readings = Readings::of(clues, found, &quantities, rows, &said);
    warnings.extend(contradictions(clues, found, &quantities, rows, [&joints, &point]));
    let of = |quantity: Quantity| Group::of(&found.joints, &joints, &quantities, quantity);
    let (turning, sliding) = (of(Quantity::Angle), of(Quantity::Length));
    let axes = Group::of(&found.point, &point, &[Quantity::Length; 3], Quantity::Length);
    let open = turning.open() || axes.open();
    let angle = turning.settled(|open| {
        let arm = readings.joints().or_else(|| by_limits(clues, found, &quantities, rows, &said));
        arm.map_or_else(|| angles_by_size(most(clues, open)), Ok)
    })?;
    let length = axes.settled(|open| points_in(clues, open, &readings))?;
    // Slides and points may differ: of a slide its size tells more than the arm.
    let slide = sliding.settled(|open| {
        let told = lengths_by_size(span(clues, open), "the sliding joint spans");
        told.or_else(|error| readings.points().ok_or(error))
    })?;
    if let Some(percent) = readings.none_agrees().filter(|_| open && warnings.len() == before) {
        warnings.push(format!(
            "in no unit are the distances between the points those of the nominal arm (at best \
             within {percent:.0} %): units were taken as asked, or by the size of the numbers; see `truearm check`"
        ));
    }
    let all = |told: Vec<Option<Told>>, of: &dyn Fn(usize) -> Option<Told>| -> Vec<Told> {
        let one = |(i, told): (usize, Option<Told>)| told.or_else(|| of(i));
        told.into_iter().enumerate().filter_map(one).collect()
    };
    let of_joint = |j: usize| {
        if quantities[j] == Quantity::Length { slide.clone() } else { angle.clone() }
    };
    Ok((all(joints, &of_joint), all(point, &|_| length.clone())))
}

/// Columns of one quantity, and what they say.
struct Group<'a> {
    open: Vec<&'a Place>,
    said: Option<&'a Told>,
}

impl<'a> Group<'a> {
    fn of(
        places: &'a [Place],
        told: &'a [Option<Told>],
        quantities: &[Quantity],
        of: Quantity,
    ) -> Self {
        let theirs: Vec<usize> = (0..places.len()).filter(|i| quantities[*i] == of).collect();
        let open = theirs.iter().filter(|i| told[**i].is_none()).map(|i| &places[*i]).collect();
        Self { open, said: theirs.iter().find_map(|i| told[*i].as_ref()) }
    }

    fn open(&self) -> bool {
        !self.open.is_empty()
    }

    /// The unit of those that say none: as found, or where numbers do not tell as
    /// their neighbours say; `None` where all say theirs.
    fn settled(&self, find: impl Fn(&[&Place]) -> Result<Told>) -> Result<Option<Told>> {
        if !self.open() {
            return Ok(None);
        }
        match (find(&self.open), self.said) {
            (Err(_), Some((unit, because))) => {
                Ok(Some((*unit, format!("{because}, and it says nothing else"))))
            }
            (found, _) => found.map(Some),
        }
    }
}

/// As asked, or as the column's heading says; `None` where it says nothing.
///
/// # Errors
/// A unit that is not known, and one of another quantity.
fn known(clues: &Clues, place: &Place, quantity: Quantity) -> Result<Option<Told>> {
    let (asked, flag) = match quantity {
        Quantity::Length => (clues.options.lengths, "--lengths mm or --lengths m"),
        _ => (clues.options.angles, "--angles deg or --angles rad"),
    };
    if let Some(unit) = asked {
        return Ok(Some((unit, "it was asked for".to_owned())));
    }
    let table = &clues.tables[place.file];
    let heading = &table.headings[place.column];
    let called = || format!("{}: {}", table.path.display(), table.called(place.column));
    if let Some(strange) = &heading.strange {
        return Err(Error::usage(
            format!("{}: \"{strange}\" is no unit that is known", called()),
            format!("convert the column, or say what its numbers are: {flag}"),
        ));
    }
    let Some(unit) = heading.unit else {
        let mut remarks = table.remarked.iter().filter(|(unit, _)| unit.quantity() == quantity);
        let told =
            |(unit, line): &(Unit, usize)| (*unit, format!("line {line} says {}", unit.word()));
        return Ok(remarks.next_back().map(told));
    };
    let measures = [Quantity::Angle, Quantity::Length];
    if unit.quantity() != quantity && measures.contains(&unit.quantity()) {
        let wanted = if quantity == Quantity::Length { "a length" } else { "an angle" };
        return Err(Error::usage(
            format!("{} is in {}, but {wanted} belongs there", called(), unit.word()),
            format!("name the right column with --columns, or say what its numbers are: {flag}"),
        ));
    }
    let where_ = match table.settled.unit_line {
        Some(line) => format!("line {line}"),
        None => format!("the heading \"{}\"", heading.text),
    };
    let told = (unit, format!("{where_} says {}", unit.word()));
    Ok(Some(told).filter(|(unit, _)| unit.quantity() == quantity))
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

/// The unit of points: the arm's, or by their span; what the arm cannot reach is
/// taken in the only other unit in which it can.
fn points_in(clues: &Clues, open: &[&Place], readings: &Readings) -> Result<Told> {
    if let Some(told) = readings.points() {
        return Ok(told);
    }
    let span = span(clues, open);
    let Some(robot) = clues.robot else { return lengths_by_size(span, "the points span") };
    let within = within_reach(robot, span);
    let because = format!("the points span {span:.3} and the arm reaches {:.2} m", robot.reach());
    let usual: Vec<Unit> =
        [Unit::Mm, Unit::M].into_iter().filter(|unit| within.contains(unit)).collect();
    match (usual.as_slice(), within.as_slice()) {
        ([unit], _) | ([], [unit]) => Ok((*unit, because)),
        ([], _) => Err(Error::usage(
            format!("in which unit are the points? {because}"),
            "say it: --lengths mm, m, cm, um, inch or foot; or give the robot.toml of this arm",
        )),
        _ => lengths_by_size(span, "the points span"),
    }
}

/// The only unit in which the joints are within the arm's limits.
fn by_limits(
    clues: &Clues,
    found: &Found,
    quantities: &[Quantity],
    rows: &[RowRef],
    said: &[Option<Unit>],
) -> Option<Told> {
    let robot = clues.robot?;
    let places: Vec<&Place> = found.joints.iter().collect();
    let values = clues.numbers(&places, rows);
    let inside = |unit: Unit| {
        let within = |q: &Vec<f64>| {
            let joints = robot.joints.iter().zip(q).zip(quantities.iter().zip(said));
            let open = |said: &Option<Unit>| said.is_none();
            joints.filter(|(_, (quantity, said))| **quantity == Quantity::Angle && open(said)).all(
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
