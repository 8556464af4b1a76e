//! Joints and point of a table without headings, by where the numbers stand.

use nalgebra::Vector3;

use super::clues::{Clues, Found, Place};
use crate::error::{Error, Result};
use crate::headings::Unit;
use crate::import::agreement;
use crate::import::table::Table;
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
    Error::usage(
        format!("{message} ({})", lists.join("; ")),
        "say it with numbers of columns or headings, such as --columns q=1-6,xyz=7-9; a robot.toml given \
         with --robot may settle it",
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

/// The only arrangement, and units, in which the nominal arm agrees.
fn by_arm(clues: &Clues, table: &Table, columns: &[usize]) -> Option<(Arrangement, String)> {
    let robot = clues.robot?;
    let n = robot.joints.len();
    if columns.len() < n + 3 {
        return None;
    }
    let mut found: Vec<(Arrangement, f64)> = Vec::new();
    for joints in 0..=columns.len() - n {
        for point in (0..=columns.len() - 3).filter(|p| p + 3 <= joints || *p >= joints + n) {
            let arrangement = Arrangement { joints, point, count: n };
            let misfit = readings(clues, table, columns, arrangement);
            found.extend(misfit.map(|m| (arrangement, m)));
        }
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (best, misfit) = *found.first()?;
    let other = found.get(1).map_or(f64::INFINITY, |f| f.1);
    // A third, and twice as good as any other: see units.
    (misfit < 0.3 && other > 2.0 * misfit).then(|| {
        let percent = (100.0 * misfit.exp_m1()).ceil();
        (
            best,
            format!(
                "so distances between the points are those of the nominal arm within {percent} %"
            ),
        )
    })
}

/// The smallest misfit of an arrangement over the units.
fn readings(clues: &Clues, table: &Table, columns: &[usize], a: Arrangement) -> Option<f64> {
    let robot = clues.robot?;
    let rows: Vec<Vec<f64>> = (0..table.rows.len())
        .filter_map(|row| {
            columns.iter().map(|c| table.number(row, *c)).collect::<Option<Vec<f64>>>()
        })
        .collect();
    let mut best: Option<f64> = None;
    for angle in [Unit::Deg, Unit::Rad] {
        for length in [Unit::Mm, Unit::M] {
            let joint = |(v, j): (&f64, &crate::model::Joint)| match j.link.kind {
                truearm::JointKind::Prismatic => from_mm(length.to_file(*v)),
                truearm::JointKind::Revolute => angle.to_file(*v).to_radians(),
            };
            let q: Vec<Vec<f64>> = rows
                .iter()
                .map(|r| {
                    r[a.joints..a.joints + a.count].iter().zip(&robot.joints).map(joint).collect()
                })
                .collect();
            let points: Vec<Vector3<f64>> = rows
                .iter()
                .map(|r| Vector3::from_fn(|i, _| from_mm(length.to_file(r[a.point + i]))))
                .collect();
            if let Some(misfit) = agreement::distances(robot, &q, &points) {
                best = Some(best.map_or(misfit, |b: f64| b.min(misfit)));
            }
        }
    }
    best
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
