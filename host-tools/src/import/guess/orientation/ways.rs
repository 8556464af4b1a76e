//! All ways to read an orientation: by what its columns are called or by what stands in them.

use std::collections::BTreeMap;

use crate::headings::{Role, Unit};
use crate::import::config::Pick;
use crate::import::guess::clues::{Clues, Place};
use crate::import::guess::named::groups;
use crate::import::turn::Form;

/// One way to read it: the form, its columns in the form's order, its unit.
pub(super) struct Reading {
    pub form: Form,
    pub places: Vec<Place>,
    pub unit: Option<Unit>,
    /// The word that asks for it.
    pub flag: &'static str,
    pub because: String,
}

/// All ways to read what is there.
pub(super) fn readings(
    clues: &Clues,
    given: &BTreeMap<String, Place>,
    columns: &BTreeMap<String, Pick>,
) -> Vec<Reading> {
    let mut all = Vec::new();
    for form in Form::ALL {
        let places: Option<Vec<Place>> =
            form.columns().iter().map(|name| given.get(*name).cloned()).collect();
        if let Some(places) = places {
            return vec![Reading {
                form,
                places,
                unit: None,
                flag: "",
                because: "it was asked for".to_owned(),
            }];
        }
    }
    let mut push =
        |of: &dyn Fn(Role) -> Option<usize>, count: usize, form: Form, flag: &'static str| {
            let group = groups(clues, of)
                .into_iter()
                .filter(|g| g.columns.len() == count && g.preference > -8);
            if let Some(group) = group.max_by_key(|g| g.preference) {
                let places = group.places(clues);
                let because = "of what its columns are called".to_owned();
                all.push(Reading { form, places, unit: None, flag, because });
            }
        };
    push(&|r| if let Role::Quaternion(c) = r { Some(c) } else { None }, 4, Form::Quaternion, "");
    push(&|r| if let Role::Rpy(c) = r { Some(c) } else { None }, 3, Form::Rpy, "");
    push(&|r| if let Role::Turn(c) = r { Some(c) } else { None }, 3, Form::Rpy, "rpy");
    push(&|r| if let Role::Turn(c) = r { Some(c) } else { None }, 3, Form::Vector, "vector");
    push(&|r| if let Role::Matrix(i, j) = r { Some(3 * i + j) } else { None }, 9, Form::Matrix, "");
    all.extend(euler_parameters(clues, columns));
    match anonymous(clues, columns) {
        four if four.is_empty() => all.extend(kuka(clues)),
        four => all.extend(four),
    }
    if all.is_empty() {
        all = nameless(clues, columns);
    }
    all
}

/// `q0, q1, q2, q3` that are no joints: the scalar stands first.
fn euler_parameters(clues: &Clues, columns: &BTreeMap<String, Pick>) -> Option<Reading> {
    let joint = |role| if let Role::Joint(n) = role { Some(n) } else { None };
    let free = |place: &Place| {
        !columns.values().any(|pick| (pick.file, pick.column) == (place.file, place.column))
    };
    let all = groups(clues, joint).into_iter().filter(|g| g.columns.keys().copied().eq(0..4));
    let places = all.map(|g| g.places(clues)).find(|places| places.iter().all(free))?;
    let [w, x, y, z] = <[Place; 4]>::try_from(places).ok()?;
    let because = "q0 to q3 are no joints: the scalar stands first".to_owned();
    Some(Reading {
        form: Form::Quaternion,
        places: vec![x, y, z, w],
        unit: None,
        flag: "",
        because,
    })
}

/// KUKA's A, B, C: yaw, pitch, roll in degrees.
fn kuka(clues: &Clues) -> Option<Reading> {
    for (file, table) in clues.tables.iter().enumerate() {
        let at = |name: &str| {
            let place = table.headings.iter().position(|h| h.words == [name]);
            place.filter(|column| table.numeric(*column))
        };
        if let (Some(a), Some(b), Some(c)) = (at("a"), at("b"), at("c")) {
            let because = "A, B, C turn about z, y, x on a KUKA".to_owned();
            let places = [c, b, a].map(|column| Place { file, column, because: because.clone() });
            let unit = Some(Unit::Deg);
            return Some(Reading {
                form: Form::Rpy,
                places: places.to_vec(),
                unit,
                flag: "",
                because,
            });
        }
    }
    None
}

/// Columns a, b, c, d of length one are a quaternion, no angles A, B, C: either order.
fn anonymous(clues: &Clues, columns: &BTreeMap<String, Pick>) -> Vec<Reading> {
    for (file, table) in clues.tables.iter().enumerate() {
        let at = |name: &&str| table.headings.iter().position(|h| h.words == [*name]);
        let four: Option<Vec<usize>> = ["a", "b", "c", "d"].iter().map(at).collect();
        if let Some(four) = four {
            return of_length_one(clues, file, &four, columns);
        }
    }
    Vec::new()
}

/// Four columns of length one behind the point, in a table without headings:
/// either order.
fn nameless(clues: &Clues, columns: &BTreeMap<String, Pick>) -> Vec<Reading> {
    let Some(z) = columns.get("z") else { return Vec::new() };
    if clues.tables[z.file].named() {
        return Vec::new();
    }
    of_length_one(clues, z.file, &(z.column + 1..z.column + 5).collect::<Vec<_>>(), columns)
}

/// Both readings of four columns, if they are a quaternion in every row.
fn of_length_one(
    clues: &Clues,
    file: usize,
    four: &[usize],
    columns: &BTreeMap<String, Pick>,
) -> Vec<Reading> {
    let table = &clues.tables[file];
    let taken = columns.values().any(|p| p.file == file && four.contains(&p.column));
    let unit = |row: usize| {
        let q: Option<Vec<f64>> = four.iter().map(|c| table.number(row, *c)).collect();
        q.is_some_and(|q| (q.iter().map(|v| v * v).sum::<f64>().sqrt() - 1.0).abs() < 1e-2)
    };
    if taken || !(0..table.rows.len()).all(unit) {
        return Vec::new();
    }
    let reading = |order: [usize; 4], flag: &'static str| {
        let because = format!("four columns have together the length 1, in the order {flag}");
        let place = |i: usize| Place { file, column: four[i], because: because.clone() };
        let places = order.map(place).to_vec();
        Reading { form: Form::Quaternion, places, unit: None, flag, because: because.clone() }
    };
    vec![reading([0, 1, 2, 3], "xyzw"), reading([1, 2, 3, 0], "wxyz")]
}
