//! Joints and point by the names of the columns.

use std::collections::BTreeMap;

use super::clues::{Clues, Found, Place};
use crate::error::{Error, Result};
use crate::headings::{Named, Role};
use crate::import::native::has_point;
use crate::import::table::Table;

/// Columns that share a family of names.
pub(super) struct Group {
    pub file: usize,
    family: String,
    pub preference: i32,
    /// By the number in the role.
    pub columns: BTreeMap<usize, usize>,
    /// Two columns of one number: nobody can tell which is meant.
    twins: Option<[usize; 2]>,
}

/// Groups of numeric columns whose role has a number by `of`.
pub(super) fn groups(clues: &Clues, of: impl Fn(Role) -> Option<usize>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (file, table) in clues.tables.iter().enumerate() {
        for (column, heading) in table.headings.iter().enumerate() {
            let Some(named) = Named::of(heading) else { continue };
            let Some(number) = of(named.role).filter(|_| table.numeric(column)) else { continue };
            let unit = heading.unit.map_or("", |u| u.word());
            let family = format!("{} {unit}", named.family);
            let known = groups.iter_mut().find(|g| g.file == file && g.family == family);
            match known {
                Some(group) => {
                    let first = *group.columns.entry(number).or_insert(column);
                    if first != column {
                        group.twins.get_or_insert([first, column]);
                    }
                }
                None => groups.push(Group {
                    file,
                    family,
                    preference: named.preference,
                    columns: BTreeMap::from([(number, column)]),
                    twins: None,
                }),
            }
        }
    }
    // Joints that slide have another unit than those that turn.
    merged(groups)
}

/// Groups that differ in their unit only and share no number are one.
fn merged(groups: Vec<Group>) -> Vec<Group> {
    let mut out: Vec<Group> = Vec::new();
    for group in groups {
        let stem =
            |g: &Group| g.family.rsplit_once(' ').map_or(String::new(), |(s, _)| s.to_owned());
        let like = |o: &&mut Group| {
            o.file == group.file
                && stem(o) == stem(&group)
                && o.columns.keys().all(|k| !group.columns.contains_key(k))
        };
        match out.iter_mut().find(like) {
            Some(known) => {
                known.columns.extend(group.columns);
                known.twins = known.twins.or(group.twins);
            }
            None => out.push(group),
        }
    }
    out
}

impl Group {
    /// Its numbers follow each other from 0 or 1.
    fn contiguous(&self) -> bool {
        let first = self.columns.keys().next().copied().unwrap_or(9);
        first <= 1 && self.columns.keys().enumerate().all(|(i, k)| *k == first + i)
    }

    /// `q0..q3` beside other joints are a quaternion.
    fn euler_parameters(&self) -> bool {
        self.family.trim() == "q" && self.columns.keys().copied().eq(0..4)
    }

    pub fn places(&self, clues: &Clues) -> Vec<Place> {
        let table = &clues.tables[self.file];
        let place = |column: &usize| Place {
            file: self.file,
            column: *column,
            because: format!("it is called \"{}\"", table.headings[*column].text),
        };
        self.columns.values().map(place).collect()
    }

    fn list(&self, clues: &Clues) -> String {
        let table = &clues.tables[self.file];
        let names: Vec<&str> =
            self.columns.values().map(|c| table.headings[*c].text.as_str()).collect();
        names.join(", ")
    }
}

fn joint(role: Role) -> Option<usize> {
    if let Role::Joint(number) = role { Some(number) } else { None }
}

fn axis(role: Role) -> Option<usize> {
    if let Role::Axis(axis) = role { Some(axis) } else { None }
}

/// Groups that can be the arm's joints.
fn joint_groups(clues: &Clues) -> Vec<Group> {
    let mut all: Vec<Group> = groups(clues, joint).into_iter().filter(Group::contiguous).collect();
    let n = clues.robot.map(|r| r.joints.len());
    all.retain(|g| n.map_or(g.columns.len() >= 2, |n| g.columns.len() == n));
    if all.iter().any(|g| !g.euler_parameters()) {
        all.retain(|g| !g.euler_parameters());
    }
    all
}

fn point_groups(clues: &Clues) -> Vec<Group> {
    groups(clues, axis).into_iter().filter(|g| g.columns.len() == 3).collect()
}

/// Whether the rows of all files that say what they measured say that it is something else
/// than points, and some do: another may have the joints.
fn without_points(clues: &Clues) -> bool {
    let kind = |table: &Table| table.headings.iter().position(|heading| heading.text == "kind");
    let pointless = |(table, k): (&Table, usize)| {
        (0..table.rows.len()).all(|row| !has_point(table.text(row, k)))
    };
    let mut told = clues.tables.iter().filter_map(|table| Some((table, kind(table)?))).peekable();
    told.peek().is_some() && told.all(pointless)
}

/// What stands under a heading of such a role and is no number.
fn no_number(clues: &Clues, of: impl Fn(Role) -> Option<usize>) -> Option<Error> {
    clues.tables.iter().find_map(|table| {
        let wanted = |column: &usize| {
            let named = Named::of(&table.headings[*column]);
            named.is_some_and(|n| n.preference > -8 && of(n.role).is_some())
        };
        let mut columns = (0..table.headings.len()).filter(wanted);
        columns.find_map(|column| {
            let odd = |row: &usize| {
                !table.text(*row, column).is_empty() && table.number(*row, column).is_none()
            };
            let row = (0..table.rows.len()).find(odd).filter(|_| !table.numeric(column))?;
            let message = format!("\"{}\" is not a number", table.text(row, column));
            let sign = if table.decimal == ',' { "comma" } else { "point" };
            let help = format!(
                "numbers are read with a decimal {sign} (--decimal says another); separators of \
                 thousands only where a fraction follows: take them out of the column"
            );
            Some(table.fail(row, column, message, &help))
        })
    })
}

/// Whether every file has joints and a point by name.
pub(super) fn all_complete(clues: &Clues) -> bool {
    let files = |groups: &[Group]| {
        (0..clues.tables.len())
            .all(|file| groups.iter().any(|g| g.file == file && g.preference >= -1))
    };
    files(&joint_groups(clues)) && (files(&point_groups(clues)) || without_points(clues))
}

/// The one most likely what was measured; `None` without any.
fn best<'a>(
    clues: &Clues,
    groups: &'a [Group],
    what: &str,
    flag: &str,
) -> Result<Option<&'a Group>> {
    let most = groups.iter().map(|g| g.preference).max().unwrap_or(0);
    let mut likely = groups.iter().filter(|g| g.preference == most);
    let Some(first) = likely.next() else { return Ok(None) };
    // The same in another unit, or in another file of the same kind.
    let stem = |g: &Group| g.family.rsplit_once(' ').map(|(s, _)| s.to_owned());
    let other = likely.find(|g| stem(g) != stem(first));
    if let Some(other) = other.filter(|o| o.file == first.file || clues.tables.len() == 1) {
        return Err(Error::usage(
            format!("which columns are {what}: {}; or {}?", first.list(clues), other.list(clues)),
            format!("say it with {flag}"),
        ));
    }
    if first.preference <= -8 {
        return Err(Error::usage(
            format!(
                "{} are not what was measured, and nothing else looks like {what}",
                first.list(clues)
            ),
            format!("name the measured columns with {flag}, these if they are meant"),
        ));
    }
    if let Some([a, b]) = first.twins {
        let table = &clues.tables[first.file];
        return Err(Error::usage(
            format!(
                "{}: {} and {} may both be {what}",
                table.path.display(),
                table.called(a),
                table.called(b)
            ),
            format!("say by their numbers which are meant, with {flag}"),
        ));
    }
    Ok(Some(first))
}

/// Flags that name the joints and the point.
const JOINTS_FLAG: &str = "--columns q1=HEADING,q2=HEADING,... (or numbers of columns, q=1-6)";
const POINT_FLAG: &str = "--columns x=HEADING,y=HEADING,z=HEADING (or numbers of columns, xyz=7-9)";

/// By name, or as given; `None` where the arrangement must tell.
///
/// # Errors
/// Names that fit twice, and names that do not suffice in a table that has some.
pub(super) fn joints_and_point(
    clues: &Clues,
    given: &BTreeMap<String, Place>,
) -> Result<Option<Found>> {
    let asked: Vec<Place> = (1..).map_while(|j| given.get(&format!("q{j}")).cloned()).collect();
    let asked_point: Vec<Place> =
        ["x", "y", "z"].iter().filter_map(|a| given.get(*a).cloned()).collect();
    let (all_joints, all_points) = (joint_groups(clues), point_groups(clues));
    let joints = match asked.is_empty() {
        false => Some(asked),
        true => best(clues, &all_joints, "the joints", JOINTS_FLAG)?.map(|g| g.places(clues)),
    };
    let point = match asked_point.len() {
        3 => Some(asked_point),
        _ => best(clues, &all_points, "the measured point", POINT_FLAG)?.map(|g| g.places(clues)),
    };
    if let (Some(robot), Some(joints)) = (clues.robot, &joints) {
        let (n, found) = (robot.joints.len(), joints.len());
        if n != found {
            let message = format!("{found} joints, but {} has {n}", robot.path.display());
            return Err(Error::usage(message, format!("name them all: {JOINTS_FLAG}")));
        }
    }
    match (joints, point) {
        (Some(joints), Some(point)) => Ok(Some(Found { joints, point })),
        (Some(joints), None) if without_points(clues) => {
            Ok(Some(Found { joints, point: Vec::new() }))
        }
        (None, None) => Ok(None),
        (joints, _) => Err(not_found(clues, joints.is_some())),
    }
}

/// What to say where there are `joints` and no point, or no joints.
fn not_found(clues: &Clues, joints: bool) -> Error {
    let (what, flag) =
        if joints { ("measured point", POINT_FLAG) } else { ("joints", JOINTS_FLAG) };
    let odd = if joints { no_number(clues, axis) } else { no_number(clues, joint) };
    if let Some(error) = odd {
        return error;
    }
    let numbers = groups(clues, joint).iter().map(|g| g.columns.len()).max();
    let lists: Vec<String> = clues.tables.iter().map(Table::list).collect();
    let more = match (numbers, clues.robot, what) {
        (Some(count), Some(robot), "joints") => {
            format!(
                " ({count} columns look like joints, {} has {})",
                robot.path.display(),
                robot.joints.len()
            )
        }
        _ => String::new(),
    };
    let other = match joints {
        true => "; rows that measured something else have a column kind that says what",
        false => "",
    };
    Error::usage(
        format!("no {what} found among {}{more}", lists.join("; ")),
        format!("name them: {flag}{other}"),
    )
}
