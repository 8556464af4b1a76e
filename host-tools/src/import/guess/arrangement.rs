//! Joints and point of a table without headings, by where the numbers stand.

use nalgebra::Vector3;
use truearm::JointKind;

use super::clues::{Clues, Found, Place};
use crate::error::{Error, Result};
use crate::headings::Unit;
use crate::import::agreement::{self, Distances};
use crate::import::table::Table;
use crate::model::{Joint, Robot};
use crate::units::from_mm;

/// Where joints and point begin, among the columns of numbers.
#[derive(Clone, Copy)]
struct Arrangement {
    joints: usize,
    point: usize,
    count: usize,
}

/// Finds them.
///
/// # Errors
/// What cannot be told, with the flag that settles it.
pub(super) fn find(clues: &Clues) -> Result<Found> {
    let table = &clues.tables[0];
    if clues.tables.len() > 1 {
        return two_files(clues);
    }
    if table.named() && clues.robot.is_none() {
        return Err(unknown(clues, "no joints and no point found among the headings"));
    }
    let columns = numeric(table);
    let found = match clues.robot {
        Some(_) => by_arm(clues, table, &columns),
        None => by_size(table, &columns),
    };
    let (arrangement, because) =
        found.ok_or_else(|| unknown(clues, "which columns are joints and which the point?"))?;
    let places = |from: usize, count: usize| {
        let columns = columns[from..from + count].iter();
        columns.map(|c| Place { file: 0, column: *c, because: because.clone() }).collect()
    };
    Ok(Found {
        joints: places(arrangement.joints, arrangement.count),
        point: places(arrangement.point, 3),
    })
}

fn unknown(clues: &Clues, message: &str) -> Error {
    let lists: Vec<String> = clues.tables.iter().map(Table::list).collect();
    let arm = match clues.robot {
        Some(_) => "the arm of --robot does not settle it",
        None => "a robot.toml given with --robot may settle it",
    };
    Error::usage(
        format!("{message} ({})", lists.join("; ")),
        format!(
            "say it with numbers of columns or headings, such as --columns q=1-6,xyz=7-9; {arm}"
        ),
    )
}

/// Columns of numbers, without a count of the rows and without constants.
fn numeric(table: &Table) -> Vec<usize> {
    let counts = |column: &usize| {
        let all = table.numbers(*column);
        all.len() > 2
            && all.windows(2).all(|w| w[1] - w[0] == 1.0)
            && (all[0] == 0.0 || all[0] == 1.0)
    };
    let columns = 0..table.headings.len();
    columns.filter(|c| table.numeric(*c) && !(*c == 0 && counts(c))).collect()
}

/// Columns of numbers beyond which nobody looks for an arm among them.
const MOST_COLUMNS: usize = 2000;
/// So well an arrangement must agree. Units are settled behind it, more strictly:
/// of a wrong arrangement nothing agrees by half.
const AGREES: f64 = 0.3;

/// The only arrangement, and units, in which the nominal arm agrees.
fn by_arm(clues: &Clues, table: &Table, columns: &[usize]) -> Option<(Arrangement, String)> {
    let robot = clues.robot?;
    let n = robot.joints.len();
    if columns.len() < n + 3 || columns.len() > MOST_COLUMNS {
        return None;
    }
    let alike = |far| by_distances(robot, table, columns, far);
    alike(false).or_else(|| alike(true))
}

/// The same by all distances, or by those that are far.
fn by_distances(
    robot: &Robot,
    table: &Table,
    columns: &[usize],
    far: bool,
) -> Option<(Arrangement, String)> {
    let n = robot.joints.len();
    let readings = Readings::of(robot, table, columns, far);
    let mut found: Vec<(Arrangement, f64)> = Vec::new();
    for joints in 0..=columns.len() - n {
        for point in (0..=columns.len() - 3).filter(|p| p + 3 <= joints || *p >= joints + n) {
            let arrangement = Arrangement { joints, point, count: n };
            found.extend(readings.misfit(arrangement).map(|m| (arrangement, m)));
        }
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (best, misfit) = *found.first()?;
    let other = found.get(1).map_or(f64::INFINITY, |f| f.1);
    // Twice as good as any other.
    (misfit < AGREES && other > 2.0 * misfit).then(|| {
        let percent = (100.0 * misfit.exp_m1()).ceil();
        (
            best,
            format!(
                "so distances between the points are those of the nominal arm within {percent} %"
            ),
        )
    })
}

/// Distances between rows as each run of columns would have them: worked out once a
/// run, so that runs can be compared two by two.
struct Readings {
    /// Of the nominal arm whose joints begin at a column: angles in degrees, in
    /// radians; beside each the unit of lengths, which joints that slide share.
    joints: Vec<Vec<(Unit, Distances)>>,
    /// Of the point whose x is at a column, by the unit of lengths.
    points: Vec<Vec<(Unit, Distances)>>,
}

impl Readings {
    fn of(robot: &Robot, table: &Table, columns: &[usize], far: bool) -> Self {
        let complete =
            |row| columns.iter().map(|c| table.number(row, *c)).collect::<Option<Vec<f64>>>();
        let rows: Vec<Vec<f64>> = (0..table.rows.len()).filter_map(complete).collect();
        let n = robot.joints.len();
        let target = robot.nominal_target();
        let arm = |from: usize, angle: Unit, length: Unit| {
            let joint = |(v, j): (&f64, &Joint)| match j.link.kind {
                JointKind::Prismatic => from_mm(length.to_file(*v)),
                JointKind::Revolute => angle.to_file(*v).to_radians(),
            };
            let q = |r: &Vec<f64>| -> Vec<f64> {
                r[from..from + n].iter().zip(&robot.joints).map(joint).collect()
            };
            let points: Vec<_> = rows.iter().map(|r| target(&q(r)).translation).collect();
            let moved = if far { agreement::moved(&points) } else { agreement::MOVED };
            (length, Distances::of(&points, moved))
        };
        let point = |from: usize, length: Unit| {
            let point =
                |r: &Vec<f64>| Vector3::from_fn(|i, _| from_mm(length.to_file(r[from + i])));
            (length, Distances::of(&rows.iter().map(point).collect::<Vec<_>>(), 0.0))
        };
        let units = [Unit::Mm, Unit::M];
        let arms = |from| {
            let angles = [Unit::Deg, Unit::Rad].into_iter();
            angles.flat_map(|a| units.map(|l| arm(from, a, l))).collect()
        };
        Self {
            joints: (0..=columns.len() - n).map(arms).collect(),
            points: (0..=columns.len() - 3).map(|c| units.map(|l| point(c, l)).to_vec()).collect(),
        }
    }

    /// The smallest misfit of an arrangement over the units, where it may matter:
    /// no worse than twice what is good enough.
    fn misfit(&self, a: Arrangement) -> Option<f64> {
        let joints = self.joints[a.joints].iter();
        let pairs = joints.flat_map(|q| self.points[a.point].iter().map(move |p| (q, p)));
        let alike = pairs.filter(|((of_joints, _), (of_point, _))| of_joints == of_point);
        let misfits = alike.filter_map(|((_, q), (_, p))| p.misfit(q, 2.0 * AGREES));
        misfits.min_by(f64::total_cmp)
    }
}

/// Columns without four at the end that are a quaternion.
fn without_quaternion<'a>(table: &Table, columns: &'a [usize]) -> &'a [usize] {
    let Some((rest, last)) = columns.split_last_chunk::<4>() else { return columns };
    let unit = |row: usize| {
        let q: Option<Vec<f64>> = last.iter().map(|c| table.number(row, *c)).collect();
        q.is_some_and(|q| (q.iter().map(|v| v * v).sum::<f64>().sqrt() - 1.0).abs() < 1e-2)
    };
    if (0..table.rows.len()).all(unit) { rest } else { columns }
}

/// Three columns that differ in size from all others, at one end.
fn by_size(table: &Table, columns: &[usize]) -> Option<(Arrangement, String)> {
    let columns = without_quaternion(table, columns);
    let count = columns.len().checked_sub(3).filter(|n| (3..=8).contains(n))?;
    let most = |columns: &[usize]| columns.iter().fold(0.0, |m: f64, c| table.most(*c).max(m));
    // Radians and mm; degrees and mm; degrees and m.
    let fits = |a: Arrangement| {
        let q = most(&columns[a.joints..a.joints + count]);
        let p = most(&columns[a.point..a.point + 3]);
        let least = columns[a.joints..a.joints + count].iter().map(|c| table.most(*c));
        let least = least.fold(f64::INFINITY, f64::min);
        let words = match (q, p) {
            (..=6.4, 50.0..) => "radians beside millimetres",
            (12.6..=400.0, 400.0..) => "degrees beside millimetres",
            (12.6..=400.0, ..=5.0) if least > 5.0 => "degrees beside metres",
            _ => return None,
        };
        Some((a, format!("the numbers look like {words}")))
    };
    let first = fits(Arrangement { joints: 0, point: count, count });
    let last = fits(Arrangement { joints: 3, point: 0, count });
    first.xor(last)
}

/// Joints in one file without headings, points in the other.
fn two_files(clues: &Clues) -> Result<Found> {
    let all: Vec<Vec<usize>> = clues.tables.iter().map(numeric).collect();
    let n = clues.robot.map(|r| r.joints.len());
    let joints = |c: &Vec<usize>| n.map_or((4..=8).contains(&c.len()), |n| c.len() == n);
    let find = |of: &dyn Fn(&Vec<usize>) -> bool| {
        let mut files = (0..all.len()).filter(|f| of(&all[*f]));
        files.next().filter(|_| files.next().is_none())
    };
    let (Some(q), Some(p)) = (find(&joints), find(&|c: &Vec<usize>| c.len() == 3)) else {
        return Err(unknown(clues, "which columns are joints and which the point?"));
    };
    if q == p {
        return Err(unknown(clues, "which file holds the joints and which the points?"));
    }
    let places = |file: usize| {
        let because = format!(
            "{} has {} columns of numbers",
            clues.tables[file].path.display(),
            all[file].len()
        );
        all[file].iter().map(|c| Place { file, column: *c, because: because.clone() }).collect()
    };
    Ok(Found { joints: places(q), point: places(p) })
}
